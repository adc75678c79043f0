//! Torque over speed, and the residual over whatever it may depend on.

use maud::{Markup, html};

use super::super::plot::{AFTER, BEFORE, Band, Curve, Drawn, MEASURED, Plot, key, with_gaps};
use crate::diagnosis::{Diagnosis, JointTraces, Traces};

/// Points of a curve at most.
const MOST_POINTS: usize = 700;
/// Later than that after a reversal nothing of it is left, s.
const AFTER_REVERSAL_S: f64 = 1.5;

/// Friction of every joint: as measured, and as both twins have it.
pub fn friction(traces: &Traces) -> Markup {
    let moved = || traces.joints.iter().filter(|t| !t.time.is_empty());
    html! {
        p {
            "Recorded torque less what it takes to move the masses the mended twin knows of; both "
            "twins' torque less the same. Where the points of the twin as given leave the measured "
            "ones, the gap lies."
        }
        (key(&[("measured", MEASURED), ("twin as given", BEFORE), ("mended twin", AFTER)]))
        div.grid { @for joint in moved() { (joint_friction(joint)) } }
    }
}

fn joint_friction(t: &JointTraces) -> Markup {
    let kept = thinned(t.time.len());
    let curve = |name, colour, y: Vec<f64>| points(name, colour, &kept, &t.velocity, &y);
    let mut curves = vec![
        curve("measured", MEASURED, t.friction()),
        curve("twin as given", BEFORE, t.friction_of(&t.before)),
    ];
    if t.after != t.before {
        curves.push(curve("mended twin", AFTER, t.friction_of(&t.after)));
    }
    Plot {
        title: format!("Joint {}", t.joint),
        across: "speed / (rad/s)",
        up: "torque / N.m",
        curves,
        bands: bands(t, &t.velocity, &["slow"]),
        ..Plot::default()
    }
    .markup()
}

/// What either twin leaves, joint by joint; those with most of the gap are open.
pub fn residuals(d: &Diagnosis, traces: &Traces) -> Markup {
    let share =
        |joint: usize| d.gap.joints.iter().find(|j| j.joint == joint).map_or(0.0, |j| j.share);
    let worst = traces.joints.iter().map(|t| share(t.joint)).fold(0.0, f64::max);
    let moved = || traces.joints.iter().filter(|t| !t.time.is_empty());
    html! {
        p {
            "Recorded torque less the twin's on the check recording. Shaded: the regimes of the "
            "table above, and in the plot over time the moments after a reversal and contacts. Drag to "
            "look closer, double-click to come back."
        }
        (key(&[("twin as given", BEFORE), ("mended twin", AFTER)]))
        @for t in moved() {
            details open[share(t.joint) >= worst.min(0.3)] {
                summary { "Joint " (t.joint) }
                div.grid.two { (over_time(t, traces.step)) (over_all(t)) }
            }
        }
    }
}

fn over_time(t: &JointTraces, step: f64) -> Markup {
    let mut bands = time_bands(t, t.held("reversal").unwrap_or(&[]), step, "");
    bands.extend(time_bands(t, &t.contact, step, "contact"));
    let curve = |name, colour, y: &[f64]| {
        let [x, y] = with_gaps(&t.time, y, step, 2 * MOST_POINTS);
        Curve { name, colour, x, y, drawn: Drawn::Joined }
    };
    Plot {
        title: "over time (shaded: after a reversal)".into(),
        across: "time in the recording / s",
        up: "residual / N.m",
        curves: both(t, curve),
        bands,
        whole: true,
        ..Plot::default()
    }
    .markup()
}

fn over_all(t: &JointTraces) -> Markup {
    let early: Vec<f64> = t
        .since_reversal
        .iter()
        .map(|s| if *s <= AFTER_REVERSAL_S { *s } else { f64::NAN })
        .collect();
    let plots: [(&str, &str, &[f64], &[&str]); 4] = [
        ("over speed", "speed / (rad/s)", &t.velocity, &["slow", "fast"]),
        ("over angle", "angle / rad", &t.position, &["angle_low", "angle_high"]),
        ("over load", "torque of the masses / N.m", &t.load, &["load_low", "load_high"]),
        ("since reversal", "time since the last reversal / s", &early, &["reversal"]),
    ];
    html! {
        @for (title, across, x, regimes) in plots {
            @let known: Vec<usize> = (0..x.len()).filter(|&k| x[k].is_finite()).collect();
            @if !known.is_empty() {
                @let step = known.len().div_ceil(MOST_POINTS).max(1);
                @let kept: Vec<usize> = known.into_iter().step_by(step).collect();
                (Plot {
                    title: title.into(),
                    across,
                    up: "residual / N.m",
                    curves: both(t, |name, colour, y| points(name, colour, &kept, x, y)),
                    bands: bands(t, x, regimes),
                    ..Plot::default()
                }
                .markup())
            }
        }
    }
}

/// Curves of both twins, of one where they are the same.
fn both<'a>(
    t: &JointTraces,
    curve: impl Fn(&'a str, &'static str, &[f64]) -> Curve<'a>,
) -> Vec<Curve<'a>> {
    let mut curves = vec![curve("twin as given", BEFORE, &t.before)];
    if t.after != t.before {
        curves.push(curve("mended twin", AFTER, &t.after));
    }
    curves
}

fn points<'a>(
    name: &'a str,
    colour: &'static str,
    kept: &[usize],
    x: &[f64],
    y: &[f64],
) -> Curve<'a> {
    let take = |values: &[f64]| kept.iter().map(|&k| values[k]).collect();
    Curve { name, colour, x: take(x), y: take(y), drawn: Drawn::Points }
}

fn thinned(rows: usize) -> Vec<usize> {
    (0..rows).step_by(rows.div_ceil(MOST_POINTS).max(1)).collect()
}

/// Stretches of time where `held`.
fn time_bands(t: &JointTraces, held: &[bool], step: f64, name: &str) -> Vec<Band> {
    let mut bands: Vec<Band> = Vec::new();
    for (time, _) in t.time.iter().zip(held).filter(|(_, held)| **held) {
        match bands.last_mut().filter(|b| time - b.to < 1.5 * step) {
            Some(band) => band.to = *time,
            None => bands.push(Band { name: name.into(), from: *time, to: *time }),
        }
    }
    bands.iter_mut().for_each(|b| {
        b.from -= 0.5 * step;
        b.to += 0.5 * step;
    });
    bands
}

/// Bands where regimes hold along the axis `x`: stretches of neighbours in the order of `x`.
fn bands(t: &JointTraces, x: &[f64], regimes: &[&str]) -> Vec<Band> {
    let mut order: Vec<usize> = (0..x.len()).filter(|&k| x[k].is_finite()).collect();
    order.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
    let one = |regime: &&str| {
        let held = t.held(regime)?;
        let name = regime.replace('_', " ");
        let mut bands: Vec<Band> = Vec::new();
        let mut inside = false;
        for &k in &order {
            match (held[k], inside) {
                (true, true) => bands.iter_mut().last().into_iter().for_each(|b| b.to = x[k]),
                (true, false) => bands.push(Band { name: name.clone(), from: x[k], to: x[k] }),
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
        let found = bands(&t, &t.velocity, &["slow", "fast"]);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].from, found[0].to), (-0.1, 0.1));
    }

    #[test]
    fn stretches_of_time_end_where_rows_are_left_out() {
        let t = traces();
        let found = time_bands(&t, &[true; 5], 0.1, "");
        let ends: Vec<[f64; 2]> = found.iter().map(|b| [b.from, b.to]).collect();
        assert_eq!(ends.len(), 2);
        assert!((ends[0][1] - 0.25).abs() < 1e-9 && (ends[1][0] - 0.95).abs() < 1e-9, "{ends:?}");
    }
}
