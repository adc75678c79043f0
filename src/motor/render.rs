//! Reports as text for a terminal and as Markdown for the documentation.

use super::dependence::Dependence;
use super::inference::Interval;
use super::model::COUNT;
use super::paper::printed;
use super::report::{CombinationReport, Given, MethodReport, ParameterReport, ScenarioReport};
use super::scenario::Channel;
use crate::numbers::chance;
use crate::text::table;

/// A table before it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    pub title: String,
    pub header: Vec<&'static str>,
    /// How many leading columns hold text.
    pub left: usize,
    pub rows: Vec<Vec<String>>,
}

impl Grid {
    pub fn text(&self) -> String {
        let drawn = table(&self.header, self.left, self.rows.iter().cloned());
        format!("{}\n{drawn}\n", self.title)
    }

    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let header: Vec<String> = self.header.iter().map(ToString::to_string).collect();
        let rule = |n: usize| if n < self.left { "---" } else { "---:" }.to_string();
        let rule: Vec<String> = (0..header.len()).map(rule).collect();
        let rows: String = self.rows.iter().map(|r| line(r)).collect();
        format!("{}\n\n{}{}{rows}\n", self.title, line(&header), line(&rule))
    }
}

/// Everything about one scenario, for a terminal.
pub fn text(report: &ScenarioReport) -> String {
    let mut parts = vec![heading(report)];
    parts.extend(report.warnings.iter().map(|w| format!("warning: {w}\n")));
    parts.extend(remarks(report));
    parts.extend(grids(report).iter().map(Grid::text));
    parts.join("\n")
}

/// Everything about one scenario, as a Markdown fragment.
pub fn markdown(report: &ScenarioReport) -> String {
    let mut parts = vec![format!("### {}\n", heading(report).trim_end())];
    parts.extend(report.warnings.iter().map(|w| format!("> {w}\n")));
    parts.extend(remarks(report));
    parts.extend(grids(report).iter().map(Grid::markdown));
    parts.join("\n")
}

/// What is said beside the tables.
pub fn remarks(report: &ScenarioReport) -> Vec<String> {
    let methods = || report.methods.iter();
    methods().map(identifiability).chain(methods().filter_map(stopped_short)).collect()
}

/// The tables of a report, in reading order.
pub fn grids(report: &ScenarioReport) -> Vec<Grid> {
    let mut grids = Vec::new();
    for method in &report.methods {
        grids.push(estimates(method));
        if !method.combinations.is_empty() {
            grids.push(combinations(method));
        }
        grids.push(conventions(report, method));
    }
    if !report.dependence.is_empty() {
        grids.push(dependence(&report.dependence));
    }
    grids
}

fn heading(report: &ScenarioReport) -> String {
    format!(
        "Scenario {}: {}; measured: {}; seed {}\n",
        report.scenario,
        report.title,
        setting(&report.measured, &report.given),
        report.seed
    )
}

/// What is known: `omega, R = 1.5 given`.
pub fn setting(measured: &[Channel], given: &[Given]) -> String {
    let name = |c: &Channel| match c {
        Channel::Omega => "omega",
        Channel::Current => "current",
    };
    let measured = measured.iter().map(|c| name(c).to_string());
    let given = given.iter().map(|g| format!("{} = {} given", g.name, g.value));
    measured.chain(given).collect::<Vec<_>>().join(", ")
}

fn identifiability(method: &MethodReport) -> String {
    let cliff = &method.identifiability;
    let kept = format!("smallest singular value kept {:.1e}", cliff.smallest_kept);
    let Some(dropped) = cliff.largest_dropped else {
        return format!(
            "{}: every direction is determined ({kept}, threshold {:.0e})\n",
            method.method, cliff.threshold
        );
    };
    let directions: Vec<String> = method
        .unidentifiable
        .iter()
        .map(|d| format!("not identifiable together: {}", d.join(", ")))
        .collect();
    format!(
        "{}: {} ({kept}, largest dropped {dropped:.1e}, threshold {:.0e})\n",
        method.method,
        directions.join("; "),
        cliff.threshold
    )
}

fn stopped_short(m: &MethodReport) -> Option<String> {
    (!m.at_minimum).then(|| {
        format!(
            "{}: stopped {:.1} standard errors short of a minimum of its cost: its tests and \
             intervals do not hold\n",
            m.method, m.newton_step
        )
    })
}

fn estimates(m: &MethodReport) -> Grid {
    let title = format!(
        "{}: cost {:.5} (1 = noise), {} evaluations, {:.1} s, {}; verification R2 {:.5} \
         (as printed in Eq. 20: {:.5}), MSE {:.3e} (rad/s)^2",
        m.method, m.cost, m.evaluations, m.seconds, m.stopped, m.r2, m.check.r2_printed, m.mse
    );
    let row = |p: &ParameterReport| {
        vec![
            p.name.into(),
            p.unit.into(),
            p.verdict.clone(),
            number(p.truth),
            number(p.value),
            percent(p.error_percent),
            interval(p.low, p.high),
            chance(p.p),
            if p.kept { "kept".into() } else { "dropped".into() },
        ]
    };
    Grid {
        title,
        header: vec![
            "parameter",
            "unit",
            "verdict",
            "truth",
            "estimate",
            "error %",
            "99 % robust",
            "p",
            "term",
        ],
        left: 3,
        rows: m.parameters.iter().map(row).collect(),
    }
}

fn combinations(m: &MethodReport) -> Grid {
    let row = |c: &CombinationReport| {
        let found = &c.combination;
        vec![
            found.name.clone(),
            number(c.truth),
            number(found.value),
            percent(c.error_percent),
            interval(found.low, found.high),
        ]
    };
    Grid {
        title: format!("{}: what the data determine instead", m.method),
        header: vec!["combination", "truth", "estimate", "error %", "99 % robust"],
        left: 1,
        rows: m.combinations.iter().map(row).collect(),
    }
}

fn conventions(report: &ScenarioReport, m: &MethodReport) -> Grid {
    let print = printed(report.scenario);
    let row = |k: usize| {
        let p = &m.parameters[k];
        let cells = |i: &Interval| [interval(i.low, i.high), chance(i.p)];
        let mut row = vec![p.name.to_string()];
        row.extend(print.map_or(["-".into(), "-".into(), "-".into()], |t| {
            [number(t[k].value), interval(t[k].low, t[k].high), number(t[k].p)]
        }));
        row.extend([interval(p.low, p.high), chance(p.p)]);
        row.extend(cells(&p.asymptotic));
        row.extend(cells(&p.paper));
        row
    };
    Grid {
        title: format!(
            "{}: intervals and p by three conventions, beside the paper's print",
            m.method
        ),
        header: vec![
            "parameter",
            "printed",
            "interval",
            "p",
            "robust",
            "p",
            "asymptotic",
            "p",
            "paper's (Eq. 8)",
            "p",
        ],
        left: 1,
        rows: (0..COUNT).map(row).collect(),
    }
}

fn dependence(rows: &[Dependence]) -> Grid {
    let range = |[low, high]: [f64; 2]| format!("{} .. {}", number(low), number(high));
    let row = |d: &Dependence| {
        vec![
            format!("truth x {} (or / {})", d.width, d.width),
            d.method.into(),
            d.combination.clone(),
            d.runs.to_string(),
            range(d.cost),
            range(d.member_error),
            range(d.combination_error),
        ]
    };
    Grid {
        title: "Errors within 5 % are the box's doing: bounds and starts against errors".into(),
        header: vec![
            "bounds",
            "method",
            "combination",
            "runs",
            "cost",
            "worst member's error %",
            "combination's error %",
        ],
        left: 3,
        rows: rows.iter().map(row).collect(),
    }
}

/// Four significant digits.
pub fn number(v: f64) -> String {
    if v.is_nan() {
        return "-".into();
    }
    if v == 0.0 {
        return "0".into();
    }
    let size = v.abs();
    if !(1e-4..1e5).contains(&size) {
        return format!("{v:.2e}");
    }
    let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
    format!("{v:.decimals$}")
}

fn percent(v: Option<f64>) -> String {
    v.map_or("-".into(), |v| format!("{v:.2}"))
}

fn interval(low: f64, high: f64) -> String {
    if low.is_nan() { "refused".into() } else { format!("[{} {}]", number(low), number(high)) }
}
