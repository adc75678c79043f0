//! What was watched over days: the gap of every joint, its level, temperature, and what changed.

use maud::{Markup, html};

use super::frame::{Page, Section};
use super::plot::{AFTER, BEFORE, Band, Curve, Drawn, MEASURED, Plot, key};
use crate::recording::Recording;

/// Rows of `armtwin watch --history` and what happened.
pub struct HistoryReport<'a> {
    /// In one sentence.
    pub answer: &'a str,
    /// Unix time, s; `gap_nm_0`, `level_nm_0`, `along_nm_0`, `temperature_c_0`, ..
    pub rows: &'a Recording,
    pub events: &'a [serde_json::Value],
}

pub fn history_report(report: &HistoryReport<'_>) -> String {
    let joints = (0..).take_while(|j| report.rows.channel(&format!("gap_nm_{j}")).is_some());
    let plots: Vec<Markup> = joints.map(|j| joint(report, j)).collect();
    let keys = key(&[
        ("gap, N.m rms", BEFORE),
        ("level it was fitted with", AFTER),
        ("along the motion, N.m", MEASURED),
    ]);
    let sections = vec![
        Section::new("gap", "Gap", html! { (keys) div.plots { @for plot in &plots { (plot) } } }),
        Section::new("events", "What changed", events(report)),
        Section::new("temperature", "Temperature", temperature(report)),
    ];
    Page { kind: "armtwin history", answer: report.answer, picture: html! {}, sections }.html()
}

/// Hours from the first row on.
fn hours(report: &HistoryReport<'_>) -> Vec<f64> {
    let first = report.rows.time.first().copied().unwrap_or(0.0);
    report.rows.time.iter().map(|t| (t - first) / 3600.0).collect()
}

fn joint(report: &HistoryReport<'_>, j: usize) -> Markup {
    let x = hours(report);
    let curve = |what: &str, name: &'static str, colour: &'static str, drawn: Drawn| {
        let y = report.rows.channel(&format!("{what}_{j}")).unwrap_or(&[]).to_vec();
        Curve { name, colour, x: x.clone(), y, drawn }
    };
    Plot {
        title: format!("Joint {}", j + 1),
        across: "h",
        up: "N.m",
        curves: vec![
            curve("level_nm", "level", AFTER, Drawn::Dashed),
            curve("along_nm", "along", MEASURED, Drawn::Joined),
            curve("gap_nm", "gap", BEFORE, Drawn::Joined),
        ],
        bands: bands(report, j),
        ..Plot::default()
    }
    .markup()
}

/// From when a change began until it was noticed.
fn bands(report: &HistoryReport<'_>, j: usize) -> Vec<Band> {
    let first = report.rows.time.first().copied().unwrap_or(0.0);
    let of_joint = |e: &&serde_json::Value| e["kind"] == "change" && e["joint"] == j + 1;
    let band = |e: &serde_json::Value| {
        let hour = |at: &str| Some((e[at].as_f64()? - first) / 3600.0);
        Some(Band { name: "changed".into(), from: hour("since")?, to: hour("noticed")? })
    };
    report.events.iter().filter(of_joint).filter_map(band).collect()
}

fn events(report: &HistoryReport<'_>) -> Markup {
    let says: Vec<&str> = report.events.iter().filter_map(|e| e["says"].as_str()).collect();
    match says.is_empty() {
        true => html! { p { "Nothing changed." } },
        false => html! { ul { @for line in says { li { (line) } } } },
    }
}

fn temperature(report: &HistoryReport<'_>) -> Markup {
    let joints = (0..10).filter_map(|j| {
        let y = report.rows.channel(&format!("temperature_c_{j}"))?.to_vec();
        y.iter().any(|t| *t != 0.0).then_some((j, y))
    });
    let curves: Vec<(String, usize, Vec<f64>)> =
        joints.map(|(j, y)| (format!("joint {}", j + 1), j, y)).collect();
    if curves.is_empty() {
        return html! {};
    }
    let drawn = curves.iter().map(|(name, j, y)| Curve {
        name,
        colour: super::plot::SERIES[*j],
        x: hours(report),
        y: y.clone(),
        drawn: Drawn::Joined,
    });
    let entries: Vec<(&str, &str)> =
        curves.iter().map(|(name, j, _)| (name.as_str(), super::plot::SERIES[*j])).collect();
    let plot =
        Plot { across: "h", up: "deg C", curves: drawn.collect(), whole: true, ..Plot::default() };
    html! { (key(&entries)) (plot.markup()) }
}
