//! What was watched over days: the gap of every joint, its level, temperature, and what changed.

use maud::{Markup, html};

use super::frame::{Page, Section};
use super::plot::{AFTER, BEFORE, Look, MEASURED, key, plot, variable};
use crate::figure::{Colour, Drawn, Line, Panel, Scale, Shaded};
use crate::recording::Recording;

const HOURS: (&str, Scale) = ("time / h", Scale::Linear);

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
    let picture = html! {};
    Page { kind: "armtwin history", answer: report.answer, more: "", picture, sections }.html()
}

/// A channel over hours from the first row on.
fn over_hours(report: &HistoryReport<'_>, channel: &str) -> Vec<(f64, f64)> {
    let time = &report.rows.time;
    let first = time.first().copied().unwrap_or(0.0);
    let values = report.rows.channel(channel).unwrap_or(&[]);
    time.iter().zip(values).map(|(t, y)| ((t - first) / 3600.0, *y)).collect()
}

fn joint(report: &HistoryReport<'_>, j: usize) -> Markup {
    let line = |what: &str, label: &str, colour: Colour| Line {
        label: label.into(),
        colour,
        drawn: Drawn::Joined,
        points: over_hours(report, &format!("{what}_{j}")),
        band: Vec::new(),
    };
    let panel = Panel {
        title: format!("Joint {}", j + 1),
        across: HOURS,
        up: ("N.m", Scale::Linear),
        lines: vec![
            line("level_nm", "level", Colour::After),
            line("along_nm", "along", Colour::Measured),
            line("gap_nm", "gap", Colour::Before),
        ],
        shaded: bands(report, j),
        ..Panel::default()
    };
    plot(&panel, Look { group: Some("hours"), ..Look::default() })
}

/// From when a change began until it was noticed.
fn bands(report: &HistoryReport<'_>, j: usize) -> Vec<Shaded> {
    let first = report.rows.time.first().copied().unwrap_or(0.0);
    let of_joint = |e: &&serde_json::Value| e["kind"] == "change" && e["joint"] == j + 1;
    let band = |e: &serde_json::Value| {
        let hour = |at: &str| Some((e[at].as_f64()? - first) / 3600.0);
        Some(Shaded { name: "changed".into(), from: hour("since")?, to: hour("noticed")? })
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
        let points = over_hours(report, &format!("temperature_c_{j}"));
        points.iter().any(|(_, t)| *t != 0.0).then(|| (format!("joint {}", j + 1), points))
    });
    let line = |(label, points): (String, Vec<(f64, f64)>)| Line {
        label,
        drawn: Drawn::Joined,
        points,
        ..Line::default()
    };
    let lines: Vec<Line> = joints.map(line).collect();
    if lines.is_empty() {
        return html! {};
    }
    let panel = Panel { across: HOURS, up: ("deg C", Scale::Linear), lines, ..Panel::default() };
    let names: Vec<&str> = panel.lines.iter().map(|l| l.label.as_str()).collect();
    let colours = names.iter().enumerate().map(|(k, name)| (*name, variable(Colour::ByName, k)));
    let entries: Vec<(&str, &str)> = colours.collect();
    html! { (key(&entries)) (plot(&panel, Look { names: &names, whole: true, group: None })) }
}
