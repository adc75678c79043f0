//! Axes of a plot: their range, and what is written along them.

use serde_json::{Value, json};

use crate::figure::{Panel, Scale};

/// Digits that are kept of a value: a plot is no data store.
const DIGITS: i32 = 4;
/// Numbers along an axis of dB at most.
const TICKS: f64 = 7.0;

/// The horizontal axis (0) or the vertical one (1), as the plotting library is told.
pub fn axis(panel: &Panel, which: usize) -> Value {
    let (title, scale) = if which == 0 { panel.across } else { panel.up };
    let values = values(panel, which);
    let mut axis = json!({
        "title": { "text": title, "font": { "size": 11, "color": "--quiet" } },
        "gridcolor": "--line",
        "zerolinecolor": "--line",
        "linecolor": "--line",
        "exponentformat": "e",
        // Only one of them makes room: what both need would depend on each other, and a drawing never settle.
        "automargin": which == 1,
    });
    if which == 0 {
        axis["tickangle"] = json!(0);
    }
    if scale == Scale::Log {
        axis["type"] = json!("log");
    }
    if let Some([from, to]) = range(scale, which, ends(&values)) {
        axis["range"] = json!([rounded(from), rounded(to)]);
    }
    let ticks = ticks_along(scale, ends(&values), panel.none());
    if !ticks.is_empty() {
        let (at, text): (Vec<f64>, Vec<String>) = ticks.into_iter().unzip();
        axis["tickvals"] = json!(at);
        axis["ticktext"] = json!(text);
    }
    axis
}

/// Numbers along an axis, of lines and of their intervals.
fn values(panel: &Panel, which: usize) -> Vec<f64> {
    let points = panel.lines.iter().map(|l| &l.points).chain([&panel.nominal]);
    let points = points.flatten().copied();
    let bands = panel.lines.iter().flat_map(|l| &l.band);
    let edges = bands.flat_map(|b| [(b.0, b.1), (b.0, b.2)]);
    let all: Vec<(f64, f64)> = points.chain(edges).collect();
    panel.written(&all).into_iter().map(|p| if which == 0 { p.0 } else { p.1 }).collect()
}

/// Least and largest number, where there is one.
fn ends(values: &[f64]) -> Option<[f64; 2]> {
    let numbers = values.iter().filter(|v| v.is_finite());
    let (low, high) = numbers
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
    (low <= high).then_some([low, high])
}

/// As the library counts along the axis; `None` leaves it to the library. What is shaded does not widen
/// the horizontal axis.
fn range(scale: Scale, which: usize, ends: Option<[f64; 2]>) -> Option<[f64; 2]> {
    if scale == Scale::Share {
        return Some([-3.0, 103.0]);
    }
    let place = |x: f64| if scale == Scale::Log { x.log10() } else { x };
    let [low, high] = ends.filter(|_| which == 0)?.map(place);
    let room = 0.02 * (high - low);
    (high > low && room.is_finite()).then_some([low - room, high + room])
}

fn ticks_along(scale: Scale, ends: Option<[f64; 2]>, none: f64) -> Vec<(f64, String)> {
    match (scale, ends) {
        (Scale::Log, Some([low, high])) => decades(low, high),
        (Scale::Decibel, Some([low, high])) => decibels(low, high, none),
        _ => Vec::new(),
    }
}

/// Left to the library where there are too few.
fn decades(low: f64, high: f64) -> Vec<(f64, String)> {
    let ticks = if low > 0.0 { ticks(low, high) } else { Vec::new() };
    let text = |v: f64| if v < 1e-3 { format!("{v:e}") } else { v.to_string() };
    match ticks.len() {
        0 | 1 => Vec::new(),
        _ => ticks.into_iter().map(|v| (v, text(v))).collect(),
    }
}

/// 1, 2, 5, 10, ... between positive numbers; powers of ten alone where those are too many.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let steps: &[f64] = if high / low > 200.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let at = |decade: i32, step: f64| match decade < 0 {
        true => step / 10f64.powi(-decade),
        false => step * 10f64.powi(decade),
    };
    let all = decades.flat_map(|d| steps.iter().map(move |s| at(d, *s)));
    all.filter(|t| (low..=high).contains(t)).collect()
}

/// Tens, or several of them, and "none" where a point stands there.
fn decibels(low: f64, high: f64, none: f64) -> Vec<(f64, String)> {
    let step = 10.0 * ((high - low) / (10.0 * TICKS)).ceil().max(1.0);
    let tens = (0..).map(|k| (low / step).ceil() * step + step * f64::from(k));
    let tens = tens.take_while(|db| *db <= high && *db < none);
    let mut ticks: Vec<(f64, String)> = tens.map(|db| (db, db.to_string())).collect();
    if high >= none {
        ticks.push((none, "none".into()));
    }
    ticks
}

/// The number rounded to [`DIGITS`] digits.
pub fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let scale = 10f64.powi(DIGITS - 1 - x.abs().log10().floor() as i32);
    // Division by a power of ten comes out as the nearest short number.
    if scale >= 1.0 {
        (x * scale).round() / scale
    } else {
        (x * scale).round() * (1.0 / scale).round()
    }
}
