//! Recordings over time: what was measured, what each method's motor does, and the difference.

use maud::{Markup, html};

use super::super::plot::{Look, MEASURED, key, plot};
use super::{COLOURS, VARIABLES};
use crate::figure::{Colour, Drawn, Line, Panel, Scale};
use crate::motor::series::{Series, Signals};

/// What is shown: its name, its unit, its symbol, and where it is found.
type Quantity = (&'static str, &'static str, fn(&Signals) -> &[f64]);
const QUANTITIES: [Quantity; 3] = [
    ("Speed", "rad/s", |s| &s.omega),
    ("Current", "A", |s| &s.current),
    ("Torque of the motor, K i", "N.m", |s| &s.torque),
];

pub fn section(all: &[Series; 2]) -> Markup {
    let methods: Vec<&str> = all[0].calculated.iter().map(|(name, _)| *name).collect();
    let mut names = vec![("measured", MEASURED)];
    names.extend(methods.iter().copied().zip(VARIABLES));
    html! {
        h3 { "Over time" }
        p.legend {
            "The measured torque is the measured current times the true K. Errors are measured less "
            "calculated. Of a stretch narrower than a point of the screen the least and the largest "
            "value are drawn."
        }
        (key(&names))
        @for one in all.iter().rev() {
            details open[one.recording == "verification"] {
                summary { "The recording for " (one.recording) }
                div.grid.two { (plots(one)) }
            }
        }
    }
}

fn plots(s: &Series) -> Markup {
    // Both recordings have a scale of their own.
    let half = Look { group: Some(s.recording), ..Look::default() };
    let voltage = panel("Voltage", "V", vec![line(s, "voltage", Colour::Measured, &s.voltage)]);
    html! {
        (plot(&voltage, Look { whole: true, ..half }))
        @for (title, unit, of) in QUANTITIES {
            (plot(&panel(title, unit, values(s, of)), half))
            (plot(&panel(&format!("{title}: error"), unit, errors(s, of)), half))
        }
    }
}

fn values(s: &Series, of: fn(&Signals) -> &[f64]) -> Vec<Line> {
    let measured = line(s, "measured", Colour::Measured, of(&s.measured));
    let calculated = s.calculated.iter().zip(COLOURS);
    let calculated = calculated.map(|((method, c), colour)| line(s, method, colour, of(c)));
    std::iter::once(measured).chain(calculated).collect()
}

/// Measured less calculated.
fn errors(s: &Series, of: fn(&Signals) -> &[f64]) -> Vec<Line> {
    let error = |c: &Signals| -> Vec<f64> {
        of(&s.measured).iter().zip(of(c)).map(|(measured, c)| measured - c).collect()
    };
    let calculated = s.calculated.iter().zip(COLOURS);
    calculated.map(|((method, c), colour)| line(s, method, colour, &error(c))).collect()
}

fn line(s: &Series, name: &str, colour: Colour, y: &[f64]) -> Line {
    let points = s.time.iter().copied().zip(y.iter().copied()).collect();
    Line { label: name.into(), colour, drawn: Drawn::Joined, points, band: Vec::new() }
}

fn panel(title: &str, unit: &'static str, lines: Vec<Line>) -> Panel {
    Panel {
        title: title.into(),
        across: ("time / s", Scale::Linear),
        up: (unit, Scale::Linear),
        lines,
        ..Panel::default()
    }
}
