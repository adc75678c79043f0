//! The report of `diagnose`: the answer and one picture first, then what it rests on.

mod found;
mod gap;
mod plots;

use maud::{Markup, html};

use super::bars::{Bars, Row};
use super::frame::{Fact, Page, Section, facts};
use super::plot::{AFTER, BEFORE, NOISE};
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
        Section::new("torque", "Recorded torque and the twin's", plots::torque(report.traces)),
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
    let (answer, more) = (words::headline(d), words::further(d));
    let picture = html! { (plots::first(d, report.traces)) (gap_bars(d)) };
    Page { kind: &kind, answer: &answer, more: &more, picture, sections }.html()
}

/// The gap of every joint before and after, beside the noise floor.
fn gap_bars(d: &Diagnosis) -> Markup {
    let mended = !d.causes.is_empty();
    let after = |joint: usize| {
        let found = d.shrink.torque.joints.iter().find(|j| j.joint == joint);
        found.map(|j| j.after_nm)
    };
    let row = |j: &JointGap| {
        let mut values = vec![Some(j.rms_nm)];
        values.extend(mended.then(|| after(j.joint)));
        values.push(Some(j.noise_floor_nm));
        Row { label: format!("joint {}", j.joint), values }
    };
    let mut names = vec![("twin as given", BEFORE)];
    names.extend(mended.then_some(("mended twin", AFTER)));
    names.push(("noise alone", NOISE));
    Bars {
        about: "Gap of every joint before and after, beside the noise floor",
        names,
        rows: d.gap.joints.iter().map(row).collect(),
        caption: "Recorded less predicted torque on the check recording, root mean square in N.m. \"Noise \
                  alone\" is what a perfect twin would leave.",
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
        (table(&rows::UNEXPLAINED, 5, d.unexplained.joints.iter().map(rows::unexplained)))
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
