//! A diagnosis for people: the answer first, then what it rests on.

use super::{causes, gap};
use crate::diagnosis::{Diagnosis, Ranked, words};
use crate::report::diagnosis as rows;
use crate::report::{paragraph, table};
use crate::text::titled;
use crate::workflow::Diagnosed;

pub fn page(done: &Diagnosed) -> String {
    findings(&done.diagnosis) + &circumstances(done)
}

pub fn findings(d: &Diagnosis) -> String {
    let mut text = format!("{}\n", paragraph("", &words::sentence(d)));
    text += &gap::section(&d.gap);
    text += &causes::section(d);
    text += &ranking(&d.ranking);
    text += &shrink(d);
    text += &causes::set_aside(d);
    text += &unexplained(d);
    text += &episodes(d);
    text + &next(d)
}

fn ranking(ranking: &[Ranked]) -> String {
    let (shown, rest) = rows::ranked(ranking);
    let rows = table(&rows::CANDIDATES, 2, shown.into_iter().map(rows::candidate));
    let rest = match rest.len() {
        0 => String::new(),
        more => format!("\n{more} more in diagnosis.json"),
    };
    let legend = paragraph("", rows::EVIDENCE);
    titled("Which effect: candidates", &format!("{rows}{rest}\n{legend}"))
}

fn shrink(d: &Diagnosis) -> String {
    let mut body = table(&rows::TORQUE, 1, rows::torque(d));
    body += &format!("\n{}", paragraph("", &words::how_far(d)));
    if let Some(s) = &d.shrink.simulation {
        body += &format!("\n{}", table(&rows::SIMULATED, 1, rows::simulated(s)));
    }
    titled("How far the gap shrinks", &body)
}

fn unexplained(d: &Diagnosis) -> String {
    let rows = table(&rows::UNEXPLAINED, 5, d.unexplained.joints.iter().map(rows::unexplained));
    titled("What stays", &format!("{}{rows}", paragraph("", &words::stays(d))))
}

fn episodes(d: &Diagnosis) -> String {
    if d.episodes.is_empty() {
        return String::new();
    }
    let rows = table(&words::EPISODES, 3, d.episodes.iter().map(words::episode));
    titled("Stretches that stand out", &format!("{rows}\n{}", words::LOUDER))
}

fn next(d: &Diagnosis) -> String {
    titled("Next experiment", &paragraph("", &d.next_experiment))
}

fn circumstances(done: &Diagnosed) -> String {
    let d = &done.diagnosis;
    let seed = done.settings.seed;
    let mut text = format!("armtwin {}  diagnose  seed {seed}  {:.1} s\n", d.armtwin, done.seconds);
    for (what, said) in done.facts() {
        text += &paragraph(&format!("  {what:8} "), &said);
    }
    d.notes.iter().for_each(|note| text += &paragraph("  note     ", note));
    text
}
