//! Recordings over time: what was measured, what each method's motor does, and the difference.

use maud::{Markup, html};

use super::super::plot::{Curve, Drawn, MEASURED, Plot, key, thinned};
use super::COLOURS;
use crate::motor::series::{Series, Signals};

/// Places along a plot where the least and the largest value are kept.
const PLACES: usize = 600;

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
    names.extend(methods.iter().copied().zip(COLOURS));
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
    let voltage = vec![line(s, "voltage", MEASURED, &s.voltage)];
    html! {
        (plot("Voltage", "V", true, voltage))
        @for (title, unit, of) in QUANTITIES {
            (plot(title, unit, false, values(s, of)))
            (plot(&format!("{title}: error"), unit, false, errors(s, of)))
        }
    }
}

fn values(s: &Series, of: fn(&Signals) -> &[f64]) -> Vec<Curve<'_>> {
    let measured = line(s, "measured", MEASURED, of(&s.measured));
    let calculated = s.calculated.iter().zip(COLOURS);
    let calculated = calculated.map(|((method, c), colour)| line(s, method, colour, of(c)));
    std::iter::once(measured).chain(calculated).collect()
}

/// Measured less calculated.
fn errors(s: &Series, of: fn(&Signals) -> &[f64]) -> Vec<Curve<'_>> {
    let error = |c: &Signals| -> Vec<f64> {
        of(&s.measured).iter().zip(of(c)).map(|(measured, c)| measured - c).collect()
    };
    let calculated = s.calculated.iter().zip(COLOURS);
    calculated.map(|((method, c), colour)| line(s, method, colour, &error(c))).collect()
}

fn line<'a>(s: &Series, name: &'a str, colour: &'static str, y: &[f64]) -> Curve<'a> {
    let [x, y] = thinned(&s.time, y, PLACES);
    Curve { name, colour, x, y, drawn: Drawn::Joined }
}

fn plot(title: &str, unit: &str, whole: bool, curves: Vec<Curve<'_>>) -> Markup {
    let title = title.to_string();
    Plot { title, across: "time / s", up: unit, curves, whole, ..Plot::default() }.markup()
}
