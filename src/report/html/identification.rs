//! The report of `identify`: how much of the torque is explained, by which parameters, how surely.

use maud::{Markup, html};

use super::bars::{Bars, Row};
use super::frame::{Fact, Page, Section, facts};
use super::plot::{AFTER, BEFORE, Look, MEASURED, key, plot};
use super::table::table;
use crate::figure::{Colour, Drawn, Line, Panel, Scale, every, over_time};
use crate::identification::{JointEstimate, MethodResult, ParameterEstimate, Standing, standing};
use crate::text::to_uncertainty;

/// Points that are scattered in a plot at most.
const MOST_POINTS: usize = 600;

const TIME: (&str, Scale) = ("time in the recording / s", Scale::Linear);
/// Plots over time are looked closer at together.
const OVER_TIME: Look<'_> = Look { names: &[], whole: true, group: Some("time") };
const TORQUE: [(&str, &str); 2] = [("recorded", MEASURED), ("fitted twin", AFTER)];

pub struct IdentificationReport<'a> {
    pub results: &'a [MethodResult],
    /// Curves of the last method's twin, on the recording it is judged by.
    pub joints: &'a [JointCurves],
    /// What the last method found, line by line.
    pub found: &'a [String],
    /// Terms that were taken out, and why.
    pub dropped: &'a [String],
    pub facts: &'a [Fact],
    pub files: &'a [(&'a str, String)],
}

/// One value per sample used.
pub struct JointCurves {
    /// From 1 at the base.
    pub joint: usize,
    /// Times in the recording, s.
    pub time: Vec<f64>,
    /// Time between neighbouring samples, s; where they are further apart a stretch is left out.
    pub step: f64,
    /// rad
    pub position: Vec<f64>,
    /// rad/s
    pub velocity: Vec<f64>,
    /// What moves the masses, N.m.
    pub masses: Vec<f64>,
    /// Recorded torque less what moves the masses, N.m.
    pub measured: Vec<f64>,
    /// The fitted twin's less the same, N.m.
    pub fitted: Vec<f64>,
}

/// The whole file.
pub fn identification_report(report: &IdentificationReport<'_>) -> String {
    let mut sections = vec![
        Section::new("found", "What was found", lines(report.found)),
        Section::new("torque", "Recorded torque and the fitted twin's", torque(report.joints)),
        Section::new("friction", "Torque over speed", friction(report.joints)),
        Section::new("residual", "What is left, and where", residuals(report.joints)),
    ];
    let methods = report.results.iter().rev();
    sections.extend(methods.zip(["parameters", "parameters-2", "parameters-3"]).map(|(m, id)| {
        Section::new(id, format!("Parameters by {}", m.method.to_uppercase()), parameters(m))
    }));
    sections.push(Section::new("fit", "How well it fits", fits(report.results)));
    sections.push(Section::new("untestable", "What these data do not determine", open(report)));
    sections.push(Section::new("dropped", "Terms taken out", lines(report.dropped)));
    let about = html! {
        (facts(report.facts))
        @for (name, text) in report.files { details { summary { (name) } pre { (text) } } }
    };
    sections.push(Section::new("about", "Recordings, settings, version", about));
    let kind = format!("armtwin {} identify", env!("CARGO_PKG_VERSION"));
    let picture = report.results.last().map_or(html! {}, bars);
    let (answer, more) = answer(report);
    Page { kind: &kind, answer: &answer, more: &more, picture, sections }.html()
}

/// The recording it is judged by: the check where there is one.
fn judged(j: &JointEstimate) -> &crate::identification::Goodness {
    j.check.as_ref().unwrap_or(&j.fit)
}

/// How much is explained, and what is said of the parameters.
fn answer(report: &IdentificationReport<'_>) -> (String, String) {
    let Some(result) = report.results.last() else {
        return ("Nothing was fitted.".into(), String::new());
    };
    let shares = result.joints.iter().map(|j| judged(j).r2);
    let (low, high) = shares
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), r2| (low.min(r2), high.max(r2)));
    let checked = result.joints.iter().all(|j| j.check.is_some());
    let on = if checked { "a recording it was not fitted on" } else { "the recording itself" };
    let answer = format!(
        "The fitted twin explains {:.2} % to {:.2} % of what each joint's torque varies by, on {on}.",
        100.0 * low,
        100.0 * high
    );
    (answer, counted(result))
}

/// How many parameters stand where.
fn counted(result: &MethodResult) -> String {
    let all = || result.joints.iter().flat_map(|j| &j.parameters).chain(&result.arm);
    let count = |what: Standing| all().filter(|p| standing(p) == what).count();
    let parts = [
        (Standing::Shown, "differ from zero"),
        (Standing::MayBeZero, "have an interval that holds zero, so that they may be absent"),
        (Standing::Open, "are not determined by these data"),
    ];
    let said: Vec<String> = parts
        .into_iter()
        .map(|(what, words)| (count(what), words))
        .filter(|(n, _)| *n > 0)
        .map(|(n, words)| format!("{n} {words}"))
        .collect();
    let method = result.method.to_uppercase();
    format!("Of {} parameters, fitted by {method}, {}.", all().count(), said.join("; "))
}

/// What is left of every joint's torque, on both recordings.
fn bars(result: &MethodResult) -> Markup {
    let row = |j: &JointEstimate| Row {
        label: format!("joint {}", j.joint),
        values: vec![Some(j.fit.mse_nm2.sqrt()), j.check.map(|c| c.mse_nm2.sqrt())],
    };
    Bars {
        about: "What is left of every joint's torque",
        names: vec![
            ("left on the recording fitted", BEFORE),
            ("left on the check recording", AFTER),
        ],
        rows: result.joints.iter().map(row).collect(),
        caption: "Recorded torque less the fitted twin's, root mean square in N.m.",
    }
    .markup()
}

fn lines(lines: &[String]) -> Markup {
    html! { @for line in lines { p { (line) } } }
}

/// Torque of every joint over time, as recorded and as the fitted twin has it.
fn torque(joints: &[JointCurves]) -> Markup {
    if joints.is_empty() {
        return html! {};
    }
    let half = Look { whole: false, ..OVER_TIME };
    let panel = |c: &JointCurves| {
        let whole = |rest: &[f64]| -> Vec<f64> {
            c.masses.iter().zip(rest).map(|(m, rest)| m + rest).collect()
        };
        let line = |name: &str, colour, rest: &[f64]| {
            line(name, colour, Drawn::Joined, over_time(&c.time, &whole(rest), c.step))
        };
        Panel {
            title: format!("Joint {}", c.joint),
            across: TIME,
            up: ("torque / N.m", Scale::Linear),
            lines: vec![
                line("recorded", Colour::Measured, &c.measured),
                line("fitted twin", Colour::After, &c.fitted),
            ],
            ..Panel::default()
        }
    };
    html! {
        p { "Gaps: the joint stands still. Drag across a plot to look closer, double-click to come back." }
        (key(&TORQUE))
        div.grid.two { @for c in joints { (plot(&panel(c), half)) } }
    }
}

fn line(name: &str, colour: Colour, drawn: Drawn, points: Vec<(f64, f64)>) -> Line {
    Line { label: name.into(), colour, drawn, points, band: Vec::new() }
}

fn friction(curves: &[JointCurves]) -> Markup {
    if curves.is_empty() {
        return html! {};
    }
    html! {
        p { "Recorded torque less what moves the masses, and the fitted twin's torque less the same." }
        (key(&TORQUE))
        div.grid { @for c in curves { (plot(&joint(c), Look::default())) } }
    }
}

fn points(name: &str, colour: Colour, x: &[f64], y: &[f64]) -> Line {
    line(name, colour, Drawn::Points, every(x, y, MOST_POINTS))
}

fn joint(c: &JointCurves) -> Panel {
    Panel {
        title: format!("Joint {}", c.joint),
        across: ("speed / (rad/s)", Scale::Linear),
        up: ("torque / N.m", Scale::Linear),
        lines: vec![
            points("recorded", Colour::Measured, &c.velocity, &c.measured),
            points("fitted twin", Colour::After, &c.velocity, &c.fitted),
        ],
        ..Panel::default()
    }
}

/// What the fitted twin leaves, joint by joint; the joint with most of it is open.
fn residuals(joints: &[JointCurves]) -> Markup {
    let left = |c: &JointCurves| -> Vec<f64> {
        c.measured.iter().zip(&c.fitted).map(|(m, f)| m - f).collect()
    };
    let rms = |r: &[f64]| (r.iter().map(|x| x * x).sum::<f64>() / r.len().max(1) as f64).sqrt();
    let worst = joints.iter().map(|c| rms(&left(c))).fold(0.0, f64::max);
    html! {
        @if !joints.is_empty() {
            p {
                "Recorded torque less the fitted twin's. A shape in it is an effect the twin lacks: "
                code { "armtwin diagnose" }
                " looks for its name."
            }
        }
        @for c in joints {
            @let residual = left(c);
            details open[rms(&residual) >= worst] {
                summary { "Joint " (c.joint) }
                div.grid.two {
                    (plot(&left_over_time(c, &residual), OVER_TIME))
                    @for panel in left_over_motion(c, &residual) { (plot(&panel, Look::default())) }
                }
            }
        }
    }
}

fn left_over_time(c: &JointCurves, residual: &[f64]) -> Panel {
    let points = over_time(&c.time, residual, c.step);
    Panel {
        title: "over time".into(),
        across: TIME,
        up: ("residual / N.m", Scale::Linear),
        lines: vec![line("left", Colour::After, Drawn::Joined, points)],
        ..Panel::default()
    }
}

fn left_over_motion(c: &JointCurves, residual: &[f64]) -> [Panel; 2] {
    let panel = |(title, across, x): (&str, &'static str, &[f64])| Panel {
        title: title.into(),
        across: (across, Scale::Linear),
        up: ("residual / N.m", Scale::Linear),
        lines: vec![points("left", Colour::After, x, residual)],
        ..Panel::default()
    };
    [
        ("over speed", "speed / (rad/s)", &c.velocity[..]),
        ("over angle", "angle / rad", &c.position[..]),
    ]
    .map(panel)
}

fn parameters(result: &MethodResult) -> Markup {
    let joints = result
        .joints
        .iter()
        .flat_map(|j| j.parameters.iter().map(move |p| (j.joint.to_string(), p)));
    let arm = result.arm.iter().map(|p| ("arm".to_string(), p));
    let row = |(joint, p): (String, &ParameterEstimate)| {
        let [value, low, high] = to_uncertainty(p.value, p.low, p.high);
        let remark = match (standing(p), p.at_bound) {
            (Standing::Open, _) => "not determined",
            (_, true) => "at its bound",
            (Standing::MayBeZero, false) => "may be zero",
            (Standing::Shown, false) => "",
        };
        let or_dash = |text: String| if p.identifiable { text } else { "-".into() };
        let bounds = format!("{} .. {}", p.bounds[0], p.bounds[1]);
        let chance = if p.p < 1e-4 { "< 0.0001".into() } else { format!("{:.4}", p.p) };
        let mut row = vec![joint, p.name.clone(), p.unit.clone(), value];
        row.extend([low, high, chance].map(or_dash));
        row.extend([bounds, remark.into()]);
        row
    };
    let header =
        ["joint", "parameter", "unit", "value", "99 % low", "high", "p", "searched within", ""];
    html! {
        (table(&header, 3, joints.chain(arm).map(row)))
        p.legend { "Intervals and p are robust to residuals that hang together in time." }
    }
}

fn fits(results: &[MethodResult]) -> Markup {
    let row = |m: &MethodResult, j: &JointEstimate| {
        let check = |f: fn(&crate::identification::Goodness) -> String| {
            j.check.as_ref().map_or("-".into(), f)
        };
        vec![
            m.method.to_uppercase(),
            j.joint.to_string(),
            j.samples.to_string(),
            format!("{:.4}", j.cost),
            j.evaluations.to_string(),
            format!("{:.1}", 1e3 * j.seconds),
            j.stopped.replace('_', " "),
            format!("{:.4}", j.fit.r2),
            check(|c| format!("{:.4}", c.r2)),
            check(|c| format!("{:.4}", c.mse_nm2.sqrt())),
        ]
    };
    let rows = results.iter().flat_map(|m| m.joints.iter().map(move |j| row(m, j)));
    let header = [
        "method",
        "joint",
        "samples",
        "left N.m",
        "evaluations",
        "ms",
        "stopped",
        "R2",
        "check R2",
        "check left N.m",
    ];
    table(&header, 1, rows)
}

fn open(report: &IdentificationReport<'_>) -> Markup {
    let Some(result) = report.results.last() else { return html! {} };
    let joints = result.joints.iter().map(|j| (format!("joint {}", j.joint), &j.parameters));
    let all = joints.chain([("arm".to_string(), &result.arm)]);
    let rows: Vec<[String; 2]> = all
        .flat_map(|(place, parameters)| {
            let why = |p: &ParameterEstimate| {
                let why = p.why_not.clone()?;
                Some([format!("{} ({place})", p.name), why])
            };
            parameters.iter().filter_map(why).collect::<Vec<_>>()
        })
        .collect();
    if rows.is_empty() {
        html! {}
    } else {
        super::table::explained(["parameter", "why"], rows)
    }
}
