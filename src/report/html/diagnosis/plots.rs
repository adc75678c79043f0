//! Recorded torque beside the twin's, torque over speed, and the residual over whatever it may depend on.

use maud::{Markup, html};

use super::super::plot::{AFTER, BEFORE, Look, MEASURED, key, plot};
use crate::diagnosis::{Diagnosis, JointTraces, Traces};
use crate::figure::{Colour, Drawn, Line, Panel, Scale, Shaded, every, over_time};

/// Points that are scattered in a plot at most.
const MOST_POINTS: usize = 350;
/// Later than that after a reversal nothing of it is left, s.
const AFTER_REVERSAL_S: f64 = 1.5;

const TIME: (&str, Scale) = ("time in the recording / s", Scale::Linear);
/// Plots over time are looked closer at together.
const OVER_TIME: Look<'_> = Look { names: &[], whole: true, group: Some("time") };
const TORQUE: [(&str, &str); 3] =
    [("recorded", MEASURED), ("twin as given", BEFORE), ("mended twin", AFTER)];

/// The joint with most of the gap, over time: recorded and predicted torque, and what is between them.
pub fn first(d: &Diagnosis, traces: &Traces) -> Markup {
    let most = moved(traces).max_by(|a, b| share(d, a.joint).total_cmp(&share(d, b.joint)));
    let Some(t) = most else { return html! {} };
    html! {
        figure {
            (keyed(t, &TORQUE))
            (plot(&torque_over_time(t, traces.step, "recorded and predicted torque"), OVER_TIME))
            (plot(&residual_over_time(t, traces.step, titled(t, "recorded less predicted torque")), OVER_TIME))
            figcaption {
                "The joint with most of the gap, on the check recording, which was not searched. Gaps: the "
                "joint stands still. Drag across a plot to look closer, double-click to come back."
            }
        }
    }
}

/// Torque of every joint over time.
pub fn torque(traces: &Traces) -> Markup {
    let Some(some) = moved(traces).next() else { return html! {} };
    let half = Look { whole: false, ..OVER_TIME };
    html! {
        (keyed(some, &TORQUE))
        div.grid.two {
            @for t in moved(traces) { (plot(&torque_over_time(t, traces.step, ""), half)) }
        }
    }
}

fn moved(traces: &Traces) -> impl Iterator<Item = &JointTraces> {
    traces.joints.iter().filter(|t| !t.time.is_empty())
}

fn share(d: &Diagnosis, joint: usize) -> f64 {
    d.gap.joints.iter().find(|j| j.joint == joint).map_or(0.0, |j| j.share)
}

fn is_mended(t: &JointTraces) -> bool {
    t.after != t.before
}

/// The key, without the mended twin where there is none.
fn keyed(t: &JointTraces, entries: &[(&str, &str)]) -> Markup {
    let shown: Vec<(&str, &str)> =
        entries.iter().copied().filter(|e| is_mended(t) || e.1 != AFTER).collect();
    key(&shown)
}

fn torque_over_time(t: &JointTraces, step: f64, what: &str) -> Panel {
    let mut lines = vec![line("recorded", Colour::Measured, &t.time, &t.torque, step)];
    let twins = both(t, |name, colour, residual| {
        let predicted: Vec<f64> = t.torque.iter().zip(residual).map(|(t, r)| t - r).collect();
        line(name, colour, &t.time, &predicted, step)
    });
    lines.extend(twins);
    Panel {
        title: titled(t, what),
        across: TIME,
        up: ("torque / N.m", Scale::Linear),
        lines,
        ..Panel::default()
    }
}

fn titled(t: &JointTraces, what: &str) -> String {
    if what.is_empty() {
        format!("Joint {}", t.joint)
    } else {
        format!("Joint {}: {what}", t.joint)
    }
}

fn line(name: &str, colour: Colour, time: &[f64], y: &[f64], step: f64) -> Line {
    let points = over_time(time, y, step);
    Line { label: name.into(), colour, drawn: Drawn::Joined, points, band: Vec::new() }
}

/// Friction of every joint: as measured, and as both twins have it.
pub fn friction(traces: &Traces) -> Markup {
    let Some(some) = moved(traces).next() else { return html! {} };
    html! {
        p {
            "Recorded torque less what moves the masses of the mended twin, beside what each twin has of "
            "it. The gap lies where the points of the twin as given leave the recorded ones."
        }
        (keyed(some, &TORQUE))
        div.grid { @for t in moved(traces) { (plot(&joint_friction(t), Look::default())) } }
    }
}

fn joint_friction(t: &JointTraces) -> Panel {
    let mut lines = vec![scattered("recorded", Colour::Measured, &t.velocity, &t.friction())];
    lines.extend(both(t, |name, colour, residual| {
        scattered(name, colour, &t.velocity, &t.friction_of(residual))
    }));
    Panel {
        title: titled(t, ""),
        across: ("speed / (rad/s)", Scale::Linear),
        up: ("torque / N.m", Scale::Linear),
        lines,
        shaded: shaded(t, &t.velocity, &["slow"]),
        ..Panel::default()
    }
}

/// What either twin leaves, joint by joint; those with most of the gap are open.
pub fn residuals(d: &Diagnosis, traces: &Traces) -> Markup {
    let Some(some) = moved(traces).next() else { return html! {} };
    let worst = moved(traces).map(|t| share(d, t.joint)).fold(0.0, f64::max);
    html! {
        p {
            "Recorded torque less the twin's on the check recording. Shaded: kinds of motion of the "
            "table above, and in the plot over time the moments after a reversal and contacts."
        }
        (keyed(some, &TORQUE[1..]))
        @for t in moved(traces) {
            details open[share(d, t.joint) >= worst.min(0.3)] {
                summary { "Joint " (t.joint) }
                div.grid.two {
                    @let title = "over time (shaded: after a reversal)".to_string();
                    (plot(&residual_over_time(t, traces.step, title), OVER_TIME))
                    @for panel in over_all(t) { (plot(&panel, Look::default())) }
                }
            }
        }
    }
}

fn residual_over_time(t: &JointTraces, step: f64, title: String) -> Panel {
    let mut shaded = time_shaded(t, t.held("reversal").unwrap_or(&[]), step, "");
    shaded.extend(time_shaded(t, &t.contact, step, "contact"));
    Panel {
        title,
        across: TIME,
        up: ("residual / N.m", Scale::Linear),
        lines: both(t, |name, colour, y| line(name, colour, &t.time, y, step)),
        shaded,
        ..Panel::default()
    }
}

/// The residual over everything else it may go along with, as far as that is known.
fn over_all(t: &JointTraces) -> Vec<Panel> {
    let early: Vec<f64> = t
        .since_reversal
        .iter()
        .map(|s| if *s <= AFTER_REVERSAL_S { *s } else { f64::NAN })
        .collect();
    let panels: [(&str, &'static str, &[f64], &[&str]); 4] = [
        ("over speed", "speed / (rad/s)", &t.velocity, &["slow", "fast"]),
        ("over angle", "angle / rad", &t.position, &["angle_low", "angle_high"]),
        ("over load", "torque of the masses / N.m", &t.load, &["load_low", "load_high"]),
        ("since reversal", "time since the last reversal / s", &early, &["reversal"]),
    ];
    let known = panels.into_iter().filter(|p| p.2.iter().any(|x| x.is_finite()));
    let panel = |(title, across, x, regimes): (&str, &'static str, &[f64], &[&str])| Panel {
        title: title.into(),
        across: (across, Scale::Linear),
        up: ("residual / N.m", Scale::Linear),
        lines: both(t, |name, colour, y| scattered(name, colour, x, y)),
        shaded: shaded(t, x, regimes),
        ..Panel::default()
    };
    known.map(panel).collect()
}

/// Lines of both twins' residuals, of one where they are the same.
fn both(t: &JointTraces, line: impl Fn(&str, Colour, &[f64]) -> Line) -> Vec<Line> {
    let mut lines = vec![line("twin as given", Colour::Before, &t.before)];
    if is_mended(t) {
        lines.push(line("mended twin", Colour::After, &t.after));
    }
    lines
}

/// Points where x is a number.
fn scattered(name: &str, colour: Colour, x: &[f64], y: &[f64]) -> Line {
    let (x, y): (Vec<f64>, Vec<f64>) =
        x.iter().copied().zip(y.iter().copied()).filter(|p| p.0.is_finite()).unzip();
    let points = every(&x, &y, MOST_POINTS);
    Line { label: name.into(), colour, drawn: Drawn::Points, points, band: Vec::new() }
}

/// Stretches of time where `held`.
fn time_shaded(t: &JointTraces, held: &[bool], step: f64, name: &str) -> Vec<Shaded> {
    let mut bands: Vec<Shaded> = Vec::new();
    for (time, _) in t.time.iter().zip(held).filter(|(_, held)| **held) {
        match bands.last_mut().filter(|b| time - b.to < 1.5 * step) {
            Some(band) => band.to = *time,
            None => bands.push(Shaded { name: name.into(), from: *time, to: *time }),
        }
    }
    bands.iter_mut().for_each(|b| {
        b.from -= 0.5 * step;
        b.to += 0.5 * step;
    });
    bands
}

/// Bands where regimes hold along the axis `x`: stretches of neighbours in the order of `x`.
fn shaded(t: &JointTraces, x: &[f64], regimes: &[&str]) -> Vec<Shaded> {
    let mut order: Vec<usize> = (0..x.len()).filter(|&k| x[k].is_finite()).collect();
    order.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
    let one = |regime: &&str| {
        let held = t.held(regime)?;
        let name = regime.replace('_', " ");
        let mut bands: Vec<Shaded> = Vec::new();
        let mut inside = false;
        for &k in &order {
            match (held[k], inside) {
                (true, true) => bands.iter_mut().last().into_iter().for_each(|b| b.to = x[k]),
                (true, false) => bands.push(Shaded { name: name.clone(), from: x[k], to: x[k] }),
                _ => {}
            }
            inside = held[k];
        }
        Some(bands)
    };
    regimes.iter().filter_map(one).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Held;

    fn traces() -> JointTraces {
        JointTraces {
            joint: 1,
            time: vec![0.0, 0.1, 0.2, 1.0, 1.1],
            velocity: vec![0.3, -0.1, 0.1, -0.4, 0.0],
            regimes: vec![Held { regime: "slow", rows: vec![false, true, true, false, true] }],
            ..JointTraces::default()
        }
    }

    #[test]
    fn a_regime_of_the_axis_is_one_stretch() {
        let t = traces();
        let found = shaded(&t, &t.velocity, &["slow", "fast"]);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].from, found[0].to), (-0.1, 0.1));
    }

    #[test]
    fn stretches_of_time_end_where_rows_are_left_out() {
        let t = traces();
        let found = time_shaded(&t, &[true; 5], 0.1, "");
        let ends: Vec<[f64; 2]> = found.iter().map(|b| [b.from, b.to]).collect();
        assert_eq!(ends.len(), 2);
        assert!((ends[0][1] - 0.25).abs() < 1e-9 && (ends[1][0] - 0.95).abs() < 1e-9, "{ends:?}");
    }
}
