//! The report of `identify`: how much of the torque is explained, by which parameters, how surely.

use maud::{Markup, html};

use super::chart::{Chart, Row};
use super::frame::{Fact, Page, Section, facts};
use super::plot::{AFTER, BEFORE, Curve, Drawn, MEASURED, Plot, key, with_gaps};
use super::table::table;
use crate::identification::{JointEstimate, MethodResult, ParameterEstimate};
use crate::text::to_uncertainty;

/// Points of a curve at most.
const MOST_POINTS: usize = 900;

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
    /// Recorded torque less what moves the masses, N.m.
    pub measured: Vec<f64>,
    /// The fitted twin's less the same, N.m.
    pub fitted: Vec<f64>,
}

/// The whole file.
pub fn identification_report(report: &IdentificationReport<'_>) -> String {
    let mut sections = vec![
        Section::new("found", "What was found", lines(report.found)),
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
    let picture = report.results.last().map_or(html! {}, chart);
    Page { kind: &kind, answer: &answer(report), picture, sections }.html()
}

/// The recording it is judged by: the check where there is one.
fn judged(j: &JointEstimate) -> &crate::identification::Goodness {
    j.check.as_ref().unwrap_or(&j.fit)
}

fn answer(report: &IdentificationReport<'_>) -> String {
    let Some(result) = report.results.last() else { return "Nothing was fitted.".into() };
    let shares = result.joints.iter().map(|j| judged(j).r2);
    let (low, high) = shares
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), r2| (low.min(r2), high.max(r2)));
    let all = || result.joints.iter().flat_map(|j| &j.parameters).chain(&result.arm);
    let sure = all().filter(|p| p.identifiable).count();
    let checked = result.joints.iter().all(|j| j.check.is_some());
    let on = if checked { "a recording it was not fitted on" } else { "the recording itself" };
    format!(
        "{} explains {:.2} % to {:.2} % of what the torques of the moving joints vary by, on {on}; \
         {sure} of {} parameters are determined by these data.",
        result.method.to_uppercase(),
        100.0 * low,
        100.0 * high,
        all().count()
    )
}

fn chart(result: &MethodResult) -> Markup {
    let row = |j: &JointEstimate| {
        let varies = (j.fit.mse_nm2 / (1.0 - j.fit.r2)).sqrt();
        Row {
            label: format!("joint {}", j.joint),
            bar: Some(varies),
            dots: vec![Some(j.fit.mse_nm2.sqrt()), j.check.map(|c| c.mse_nm2.sqrt())],
        }
    };
    Chart {
        about: "What is left of every joint's torque, against what it varies by",
        across: "torque, rms over the samples used, N.m",
        bar: "torque",
        dots: vec![("left, fit", BEFORE), ("left, check", AFTER)],
        rows: result.joints.iter().map(row).collect(),
        caption: "What the fitted twin leaves of each joint's torque (dots), beside what that \
                  torque varies by about its mean (grey). The scale is logarithmic.",
    }
    .markup()
}

fn lines(lines: &[String]) -> Markup {
    html! { @for line in lines { p { (line) } } }
}

fn friction(curves: &[JointCurves]) -> Markup {
    if curves.is_empty() {
        return html! {};
    }
    html! {
        p { "Recorded torque less what it takes to move the masses, and the fitted twin's torque less the same." }
        (key(&[("measured", MEASURED), ("fitted twin", AFTER)]))
        div.grid { @for c in curves { (joint(c)) } }
    }
}

/// So many points of all that a plot stays quick.
fn points<'a>(name: &'a str, colour: &'static str, x: &[f64], y: &[f64]) -> Curve<'a> {
    let step = x.len().div_ceil(MOST_POINTS).max(1);
    let thin = |values: &[f64]| values.iter().step_by(step).copied().collect::<Vec<f64>>();
    Curve { name, colour, x: thin(x), y: thin(y), drawn: Drawn::Points }
}

fn joint(c: &JointCurves) -> Markup {
    let curve = |name, colour, y: &[f64]| points(name, colour, &c.velocity, y);
    Plot {
        title: format!("Joint {}", c.joint),
        across: "speed / (rad/s)",
        up: "torque / N.m",
        curves: vec![
            curve("measured", MEASURED, &c.measured),
            curve("fitted twin", AFTER, &c.fitted),
        ],
        ..Plot::default()
    }
    .markup()
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
                div.grid.two { (over_time(c, &residual)) (over_motion(c, &residual)) }
            }
        }
    }
}

fn over_time(c: &JointCurves, residual: &[f64]) -> Markup {
    let [x, y] = with_gaps(&c.time, residual, c.step, 2 * MOST_POINTS);
    Plot {
        title: "over time".into(),
        across: "time in the recording / s",
        up: "residual / N.m",
        curves: vec![Curve { name: "left", colour: AFTER, x, y, drawn: Drawn::Joined }],
        whole: true,
        ..Plot::default()
    }
    .markup()
}

fn over_motion(c: &JointCurves, residual: &[f64]) -> Markup {
    let plot = |title: &str, across, x: &[f64]| Plot {
        title: title.into(),
        across,
        up: "residual / N.m",
        curves: vec![points("left", AFTER, x, residual)],
        ..Plot::default()
    };
    html! {
        (plot("over speed", "speed / (rad/s)", &c.velocity).markup())
        (plot("over angle", "angle / rad", &c.position).markup())
    }
}

fn parameters(result: &MethodResult) -> Markup {
    let joints = result
        .joints
        .iter()
        .flat_map(|j| j.parameters.iter().map(move |p| (j.joint.to_string(), p)));
    let arm = result.arm.iter().map(|p| ("arm".to_string(), p));
    let row = |(joint, p): (String, &ParameterEstimate)| {
        let [value, low, high] = to_uncertainty(p.value, p.low, p.high);
        let remark = match (p.identifiable, p.at_bound) {
            (false, _) => "not identifiable",
            (true, true) => "at its bound",
            (true, false) => "",
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
