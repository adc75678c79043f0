//! The report of `motor`: which of the ten parameters come back, and how well.

mod over_time;

use maud::{Markup, html};

use super::bars::{Bars, Row};
use super::frame::{Fact, Page, Section, facts};
use super::plot::{AFTER, BEFORE, Look, MEASURED, NOISE, key, plot};
use super::table::table;
use crate::figure::{Colour, Drawn, Line, Panel, Scale};
use crate::motor::model::{COUNT, Motor};
use crate::motor::render::{self, Grid};
use crate::motor::report::{MethodReport, ScenarioReport};
use crate::motor::series::Series;

/// Points of a friction curve.
const POINTS: usize = 120;
/// One per method.
const COLOURS: [Colour; 2] = [Colour::Before, Colour::After];
const VARIABLES: [&str; 2] = [BEFORE, AFTER];
/// A section needs a name that a link can end in.
const IDS: [&str; 4] = ["scenario-1", "scenario-2", "scenario-3", "scenario-4"];

/// The whole file; `series` are the recordings of every scenario.
pub fn motor_report(reports: &[ScenarioReport], series: &[[Series; 2]]) -> String {
    let mut sections: Vec<Section> = reports
        .iter()
        .zip(series)
        .zip(IDS)
        .map(|((r, series), id)| {
            Section::new(id, format!("Scenario {}: {}", r.scenario, r.title), scenario(r, series))
        })
        .collect();
    let about: Vec<Fact> = vec![
        ("seed".into(), reports.first().map_or(String::new(), |r| r.seed.to_string())),
        ("armtwin".into(), env!("CARGO_PKG_VERSION").into()),
    ];
    let about = html! {
        (facts(&about))
        @for r in reports {
            details {
                summary { "Settings of scenario " (r.scenario) }
                pre { (serde_json::to_string_pretty(&r.settings).unwrap_or_default()) }
            }
        }
    };
    sections.push(Section::new("about", "Settings, version", about));
    let kind = format!("armtwin {} motor", env!("CARGO_PKG_VERSION"));
    let picture = html! { @for r in reports { (bars(r)) } };
    Page { kind: &kind, answer: &answer(reports), more: "", picture, sections }.html()
}

fn answer(reports: &[ScenarioReport]) -> String {
    let one = |r: &ScenarioReport| {
        let Some(m) = r.methods.last() else { return String::new() };
        let sure = m.parameters.iter().filter(|p| p.identifiable && !p.given).count();
        let free = m.parameters.iter().filter(|p| !p.given).count();
        let open: Vec<String> = r.unidentifiable.iter().map(|d| d.join(", ")).collect();
        let except = match open.is_empty() {
            true => String::new(),
            false => format!(" (not {})", open.join("; ")),
        };
        format!("scenario {}: {sure} of {free} parameters can be identified{except}", r.scenario)
    };
    let all: Vec<String> = reports.iter().map(one).collect();
    let mut text = all.join("; ");
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text + "."
}

/// Errors of the parameters that have an interval.
fn bars(r: &ScenarioReport) -> Markup {
    let Some(last) = r.methods.last() else { return html! {} };
    let known = |k: &usize| !last.parameters[*k].given && last.parameters[*k].identifiable;
    let row = |k: usize| {
        let p = &last.parameters[k];
        let half = 50.0 * (p.high - p.low) / p.truth.abs();
        let errors = r.methods.iter().map(|m| m.parameters[k].error_percent.map(f64::abs));
        Row { label: p.name.into(), values: errors.chain([Some(half)]).collect() }
    };
    let mut names: Vec<(&str, &'static str)> =
        r.methods.iter().map(|m| m.method).zip(VARIABLES).collect();
    names.push(("half of the 99 % interval", NOISE));
    Bars {
        about: "Error of every parameter, beside its interval",
        names,
        rows: (0..COUNT).filter(known).map(row).collect(),
        caption: &format!(
            "Scenario {}: how far each estimate is from the truth, in % of the truth. Parameters that \
             the data do not determine have no interval and are left out.",
            r.scenario
        ),
    }
    .markup()
}

fn scenario(r: &ScenarioReport, series: &[Series; 2]) -> Markup {
    let top = series[0].measured.omega.iter().fold(0.0f64, |top, w| w.abs().max(top));
    html! {
        @for warning in &r.warnings { p.note { "Warning: " (warning) } }
        @for line in render::remarks(r) { p { (line.trim_end()) } }
        (friction(r, top))
        (over_time::section(series))
        @for grid in render::grids(r) { (grid_table(&grid)) }
    }
}

fn grid_table(grid: &Grid) -> Markup {
    html! { h3 { (grid.title) } (table(&grid.header, grid.left, grid.rows.iter().cloned())) }
}

/// Friction over speed: of the true motor, and as each method has it.
fn friction(r: &ScenarioReport, top: f64) -> Markup {
    let speeds: Vec<f64> = (1..=POINTS).map(|k| k as f64 * top / POINTS as f64).collect();
    let law = |values: [f64; COUNT]| -> Vec<f64> {
        let motor = Motor::from_array(&values);
        speeds.iter().map(|w| motor.sliding_friction(*w, 1.0)).collect()
    };
    let values = |m: &MethodReport| std::array::from_fn(|k| m.parameters[k].value);
    let Some(first) = r.methods.first() else { return html! {} };
    let truth = std::array::from_fn(|k| first.parameters[k].truth);
    let line = |label: &str, colour, y: Vec<f64>| Line {
        label: label.into(),
        colour,
        drawn: Drawn::Joined,
        points: speeds.iter().copied().zip(y).collect(),
        band: Vec::new(),
    };
    let mut lines = vec![line("truth", Colour::Measured, law(truth))];
    let mut names = vec![("truth", MEASURED)];
    for ((m, colour), variable) in r.methods.iter().zip(COLOURS).zip(VARIABLES) {
        lines.push(line(m.method, colour, law(values(m))));
        names.push((m.method, variable));
    }
    let panel = Panel {
        title: "Friction over speed".into(),
        across: ("speed / (rad/s)", Scale::Linear),
        up: ("torque / N.m", Scale::Linear),
        lines,
        ..Panel::default()
    };
    let look = Look { whole: true, ..Look::default() };
    html! { (key(&names)) div.grid { (plot(&panel, look)) } }
}
