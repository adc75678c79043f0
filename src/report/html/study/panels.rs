//! A study's figures as plots, and as drawings where no script runs.

use base64::{Engine, engine::general_purpose::STANDARD};
use maud::{Markup, html};

use super::super::chart::ticks;
use super::super::plot::{Area, Curve, Drawn, NOMINAL, Plot, SERIES, Scale, key};
use crate::studies::StudyError;
use crate::studies::sweep::{Figure, Line, Panel, Scale as Along};

/// Numbers along an axis of dB at most.
const TICKS: f64 = 7.0;

/// # Errors
/// If the drawing for readers without scripts fails.
pub fn figure(figure: &Figure) -> Result<Markup, StudyError> {
    let labels = figure.labels();
    let mut colours: Vec<(&str, &str)> = labels.iter().map(|l| (*l, colour(&labels, l))).collect();
    if figure.panels.iter().any(|p| !p.nominal.is_empty()) {
        colours.push(("what should be (dashed)", NOMINAL));
    }
    let drawing = format!("data:image/svg+xml;base64,{}", STANDARD.encode(figure.svg()?));
    let whole = figure.panels.len() == 1;
    Ok(html! {
        figure {
            (key(&colours))
            div.grid { @for panel in &figure.panels { (plot(panel, &labels, whole).markup()) } }
            noscript { img src=(drawing) alt=(figure.caption); }
            @if !figure.caption.is_empty() { figcaption { (figure.caption) } }
        }
    })
}

fn colour(labels: &[&str], label: &str) -> &'static str {
    SERIES[labels.iter().position(|l| *l == label).unwrap_or(0) % SERIES.len()]
}

fn plot<'a>(panel: &'a Panel, labels: &[&str], whole: bool) -> Plot<'a> {
    let curve = |line: &'a Line| {
        let [x, y] = numbers(panel, panel.placed(&line.points));
        let colour = colour(labels, &line.label);
        Curve { name: &line.label, colour, x, y, drawn: Drawn::Marked }
    };
    let mut curves: Vec<Curve<'a>> = panel.lines.iter().map(curve).collect();
    if !panel.nominal.is_empty() {
        let [x, y] = numbers(panel, panel.placed(&panel.nominal));
        curves.push(Curve { name: "nominal", colour: NOMINAL, x, y, drawn: Drawn::Dashed });
    }
    let area = |line: &Line| {
        let [x, y] = numbers(panel, panel.outline(line));
        Area { colour: colour(labels, &line.label), outline: x.into_iter().zip(y).collect() }
    };
    let areas: Vec<Area> = panel.lines.iter().filter(|l| !l.band.is_empty()).map(area).collect();
    let across: Vec<f64> = curves.iter().flat_map(|c| &c.x).copied().collect();
    let edges = areas.iter().flat_map(|a| &a.outline).map(|p| p.1);
    let up: Vec<f64> = curves.iter().flat_map(|c| &c.y).copied().chain(edges).collect();
    Plot {
        title: panel.title.clone(),
        across: panel.across.0,
        up: panel.up.0,
        scales: [
            scale(panel.across.1, &across, panel.none()),
            scale(panel.up.1, &up, panel.none()),
        ],
        curves,
        areas,
        whole,
        ..Plot::default()
    }
}

/// Places as what is written there: the library takes logarithms itself.
fn numbers(panel: &Panel, places: Vec<(f64, f64)>) -> [Vec<f64>; 2] {
    let number = |along: Along, place: f64| match along {
        Along::Log => 10f64.powf(place),
        _ => place,
    };
    let (across, up) = (panel.across.1, panel.up.1);
    let (x, y) = places.iter().map(|p| (number(across, p.0), number(up, p.1))).unzip();
    [x, y]
}

/// Along an axis with `values` on it; `none` is where no noise stands.
fn scale(along: Along, values: &[f64], none: f64) -> Scale {
    let (low, high) = values
        .iter()
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
    let there = low <= high;
    match along {
        Along::Share => Scale { range: Some([-3.0, 103.0]), ..Scale::default() },
        Along::Log if there => Scale { log: true, ticks: decades(low, high), ..Scale::default() },
        Along::Decibel if there => Scale { ticks: decibels(low, high, none), ..Scale::default() },
        _ => Scale { log: along == Along::Log, ..Scale::default() },
    }
}

/// Left to the library where there are too few.
fn decades(low: f64, high: f64) -> Vec<(f64, String)> {
    let ticks = ticks(low, high);
    let text = |v: f64| if v < 1e-3 { format!("{v:e}") } else { v.to_string() };
    match ticks.len() {
        0 | 1 => Vec::new(),
        _ => ticks.into_iter().map(|v| (v, text(v))).collect(),
    }
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
