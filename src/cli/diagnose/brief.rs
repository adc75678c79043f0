//! A diagnosis on one screen: the answer, where, which causes, how far, what stays, what next.

use crate::diagnosis::{Cause, Diagnosis, Value, words};
use crate::numbers::angle;
use crate::report::diagnosis as rows;
use crate::report::{paragraph, table, to_uncertainty};
use crate::text::titled;
use crate::workflow::{Diagnosed, Recorded};

pub fn page(done: &Diagnosed) -> String {
    let d = &done.diagnosis;
    let seconds = done.seconds;
    let source = |what: &str, r: &Recorded| paragraph(&format!("{what:6} "), &r.provenance.source);
    findings(d)
        + &source("fit", &done.fit)
        + &source("check", &done.check)
        + &format!("armtwin {}, seed {}, {seconds:.1} s; ", d.armtwin, done.settings.seed)
        + &format!("{} notes and all tables: --full", d.notes.len())
}

pub fn findings(d: &Diagnosis) -> String {
    let mut text = format!("{}\n", paragraph("", &words::headline(d)));
    text += &titled("Somebody pushed", &paragraph("", &words::pushes(d)));
    text += &titled("Where: recorded torque less the twin's, check recording, rms", &joints(d));
    text += &titled("Causes, what takes most off first", &causes(d));
    text += &titled("How far", &how_far(d));
    text += &titled("What stays", &paragraph("", &words::stays(d)));
    text += &titled("Perhaps a push (not explained by all joints alike)", &words::suspicions(d));
    text += &titled("Comes again with the motion", &paragraph("", &words::come_again(d)));
    text + &titled("Next experiment", &paragraph("", &d.next_experiment))
}

const JOINTS: [&str; 5] = ["joint", "before N.m", "after N.m", "noise N.m", "of the gap"];

fn joints(d: &Diagnosis) -> String {
    let both = d.gap.joints.iter().zip(&d.shrink.torque.joints);
    let row = both.map(|(gap, shrink)| {
        let nm = |torque: f64| format!("{torque:.2}");
        let share = words::percent(gap.share);
        let [before, after] = [shrink.before_nm, shrink.after_nm].map(nm);
        vec![gap.joint.to_string(), before, after, nm(gap.noise_floor_nm), share]
    });
    table(&JOINTS, 1, row)
}

const CAUSES: [&str; 7] = ["cause", "parameter", "value", "90 % low", "high", "sure", "takes off"];

fn causes(d: &Diagnosis) -> String {
    if d.causes.is_empty() {
        return String::new();
    }
    let rows = table(&CAUSES, 2, d.causes.iter().flat_map(|c| cause(d, c)));
    let same = d.causes.iter().filter(|c| !c.equivalent.is_empty()).map(|c| {
        let others: Vec<String> = c.equivalent.iter().map(rows::named).collect();
        paragraph("", &format!("{} looks the same as {}", c.effect, others.join("; ")))
    });
    format!("{rows}\n{}", same.collect::<String>())
}

/// A row of the foremost value; of what people read as ratios (a load and its centre) a row of each value.
fn cause(d: &Diagnosis, c: &Cause) -> Vec<Vec<String>> {
    let all = c.read();
    let values = match c.has_ratios() {
        true => all,
        false => words::foremost(c).into_iter().collect(),
    };
    let name = format!("{}, {}", c.effect, words::acts(c));
    let (_, fraction) = words::takes_off(d, c);
    let [sure, share] = [c.probability, fraction].map(words::percent);
    // What is not in the check recording has nothing to take off there.
    let share = if c.recording.is_some() { "-".into() } else { share };
    let first = |k: usize, text: &String| if k == 0 { text.clone() } else { String::new() };
    let row = |(k, cells): (usize, [String; 4])| {
        let [parameter, value, low, high] = cells;
        vec![first(k, &name), parameter, value, low, high, first(k, &sure), first(k, &share)]
    };
    let cells: Vec<[String; 4]> = match values.is_empty() {
        true => vec![Default::default()],
        false => values.into_iter().map(value).collect(),
    };
    cells.into_iter().enumerate().map(row).collect()
}

fn value(v: &Value) -> [String; 4] {
    let unit = if v.unit == "-" { String::new() } else { format!(", {}", v.unit) };
    let [value, low, high] = to_uncertainty(v.value, v.low, v.high);
    [words::parameter(v) + &unit, value, low, high]
}

fn how_far(d: &Diagnosis) -> String {
    let torque = match d.position {
        Some(_) => String::new(),
        None => paragraph("torque    ", &words::how_far(d)),
    };
    let simulated = d.shrink.simulation.as_ref().map_or(String::new(), |s| {
        let moved = format!("{} -> {} in simulation", angle(s.before_rad), angle(s.after_rad));
        paragraph("position  ", &moved)
    });
    torque + &simulated
}
