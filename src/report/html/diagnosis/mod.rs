//! The report of `diagnose`: the answer and one picture first, then what it rests on.

mod found;
mod gap;
mod plots;

use maud::{Markup, html};

use super::chart::{Chart, Row};
use super::frame::{Fact, Page, Section, facts};
use super::plot::{AFTER, BEFORE};
use super::table::{explained, table};
use crate::diagnosis::{Diagnosis, JointGap, Traces, by_reason, words};
use crate::report::diagnosis as rows;

pub struct DiagnosisReport<'a> {
    pub diagnosis: &'a Diagnosis,
    pub traces: &'a Traces,
    /// Robot, recordings, settings, seed, version.
    pub facts: &'a [Fact],
    /// Files worth showing whole: name and text.
    pub files: &'a [(&'a str, String)],
}

/// The whole file.
pub fn diagnosis_report(report: &DiagnosisReport<'_>) -> String {
    let d = report.diagnosis;
    let sections = vec![
        Section::new("causes", "Which effect: causes, what takes most off first", found::causes(d)),
        Section::new("gap", "Where the twin differs", gap::tables(d, report.traces)),
        Section::new("friction", "Torque over speed", plots::friction(report.traces)),
        Section::new("residual", "What is left, and where", plots::residuals(d, report.traces)),
        Section::new("ranking", "Every candidate", found::ranking(&d.ranking)),
        Section::new("shrink", "How far the gap shrinks", found::shrink(d)),
        Section::new("untestable", "What these data cannot test", untestable(d)),
        Section::new("rejected", "Rejected", rejected(d)),
        Section::new("left", left_title(d), left(d)),
        Section::new("episodes", "Stretches that stand out", found::episodes(d)),
        Section::new("next", "Next experiment", next(d)),
        Section::new("about", "Recordings, settings, version", about(report)),
    ];
    let kind = format!("armtwin {} diagnose", d.armtwin);
    let answer = words::sentence(d);
    Page { kind: &kind, answer: &answer, picture: gap_chart(d), sections }.html()
}

/// The gap of every joint before and after, against the noise floor.
fn gap_chart(d: &Diagnosis) -> Markup {
    let mended = !d.causes.is_empty();
    let after = |joint: usize| {
        let found = d.shrink.torque.joints.iter().find(|j| j.joint == joint);
        found.map(|j| j.after_nm)
    };
    let row = |j: &JointGap| Row {
        label: format!("joint {}", j.joint),
        bar: Some(j.noise_floor_nm),
        dots: match mended {
            true => vec![Some(j.rms_nm), after(j.joint)],
            false => vec![Some(j.rms_nm)],
        },
    };
    let mut dots = vec![("twin as given", BEFORE)];
    dots.extend(mended.then_some(("mended twin", AFTER)));
    Chart {
        about: "Gap of every joint before and after, against the noise floor",
        across: "recorded torque less the twin's, rms on the check recording, N.m",
        bar: "noise",
        dots,
        rows: d.gap.joints.iter().map(row).collect(),
        caption: "How far the twin is from the arm at each joint, and how far it would be by the \
                  sensors' noise alone (grey). The scale is logarithmic.",
    }
    .markup()
}

fn untestable(d: &Diagnosis) -> Markup {
    let all = d.untestable.iter().map(|u| (&*u.effect, &*u.joints, &*u.why));
    reasons(by_reason(all))
}

fn rejected(d: &Diagnosis) -> Markup {
    let all = d.rejected.iter().map(|r| (&*r.effect, &*r.joints, &*r.why));
    reasons(by_reason(all))
}

fn reasons(rows: Vec<[String; 2]>) -> Markup {
    if rows.is_empty() {
        html! {}
    } else {
        explained(["why", "effects"], rows)
    }
}

fn left_title(d: &Diagnosis) -> String {
    let what = if d.unexplained.above_noise { "more than noise" } else { "noise" };
    format!("What stays: {what}")
}

fn left(d: &Diagnosis) -> Markup {
    html! {
        p { (words::stays(d)) }
        (table(&rows::UNEXPLAINED, 4, d.unexplained.joints.iter().map(rows::unexplained)))
    }
}

fn next(d: &Diagnosis) -> Markup {
    if d.next_experiment.is_empty() {
        html! {}
    } else {
        html! { p { (found::sentence(&d.next_experiment)) } }
    }
}

fn about(report: &DiagnosisReport<'_>) -> Markup {
    html! {
        (facts(report.facts))
        @for note in &report.diagnosis.notes { p.note { (note) "." } }
        @for (name, text) in report.files {
            details { summary { (name) } pre { (text) } }
        }
    }
}
