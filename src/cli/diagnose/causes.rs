//! What the twin lacks, and what was set aside.

use super::page::titled;
use crate::diagnosis::{Cause, Diagnosis, Named, Value, words};
use crate::report::{paragraph, table};

pub fn section(causes: &[Cause]) -> String {
    let body: Vec<String> = causes.iter().map(cause).collect();
    titled("Which effect: causes, strongest first", &body.join("\n"))
}

fn cause(c: &Cause) -> String {
    let mut text = format!(
        "{} at {}: probability {}\n",
        c.effect,
        words::place(&c.joints),
        words::percent(c.probability)
    );
    let rows: String = table(
        &["  parameter", "unit", "value", "90 % low", "high", ""],
        2,
        c.parameters.iter().map(value),
    );
    text += &format!("{rows}\n");
    let s = &c.shrink;
    text += &paragraph(
        "  check    ",
        &format!(
            "{:.3} -> {:.3} N.m when added after those above, {} of the mean square ({} .. {})",
            s.check_before_nm,
            s.check_after_nm,
            words::percent(s.fraction),
            words::percent(s.low),
            words::percent(s.high)
        ),
    );
    if !c.equivalent.is_empty() {
        let same: Vec<String> = c.equivalent.iter().map(named).collect();
        text += &paragraph("  the same ", &format!("in these data: {}", same.join("; ")));
    }
    text += &paragraph("  cause    ", &c.cause);
    text + &paragraph("  remedy   ", &c.remedy)
}

fn named(n: &Named) -> String {
    format!("{} at {}", n.effect, words::place(&n.joints))
}

fn value(v: &Value) -> Vec<String> {
    let bound = if v.at_bound { "at bound" } else { "" };
    vec![
        format!("  {}", v.name),
        v.unit.clone(),
        number(v.value),
        number(v.low),
        number(v.high),
        bound.into(),
    ]
}

/// Four digits.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if !(1e-3..1e5).contains(&a) => format!("{x:.3e}"),
        a if a < 1.0 => format!("{x:.5}"),
        a if a < 100.0 => format!("{x:.3}"),
        _ => format!("{x:.1}"),
    }
}

/// What cannot be tested and what was rejected, grouped by reason.
pub fn set_aside(d: &Diagnosis) -> String {
    let untestable = d.untestable.iter().map(|u| (&*u.effect, &*u.joints, &*u.why));
    let rejected = d.rejected.iter().map(|r| (&*r.effect, &*r.joints, &*r.why));
    titled("What these data cannot test", &by_reason(untestable))
        + &titled("Rejected", &by_reason(rejected))
}

/// An effect and the joints it is listed for.
type Listed<'a> = (&'a str, Vec<usize>);

fn by_reason<'a>(all: impl Iterator<Item = (&'a str, &'a [usize], &'a str)>) -> String {
    let mut groups: Vec<(String, Vec<Listed<'_>>)> = Vec::new();
    for (effect, joints, why) in all {
        let shared = |g: &(String, _)| common(&g.0, why);
        let at = match groups.iter().position(|g| shared(g).is_some()) {
            Some(at) => at,
            None => {
                groups.push((why.into(), Vec::new()));
                groups.len() - 1
            }
        };
        groups[at].0 = shared(&groups[at]).unwrap_or_default();
        match groups[at].1.iter_mut().find(|e| e.0 == effect) {
            Some(found) => found.1.extend(joints),
            None => groups[at].1.push((effect, joints.to_vec())),
        }
    }
    let each = |(effect, joints): &Listed<'_>| match joints.is_empty() {
        true => (*effect).to_string(),
        false => format!("{effect} ({})", words::place(joints)),
    };
    let line = |(why, effects): &(String, Vec<Listed<'_>>)| {
        let effects: Vec<String> = effects.iter().map(each).collect();
        paragraph("  ", &format!("{why}: {}", effects.join(", ")))
    };
    groups.iter().map(line).collect()
}

/// What two reasons share that differ in numbers only, `..` in place of those; `None` for others.
fn common(a: &str, b: &str) -> Option<String> {
    let number = |word: &str| word == ".." || word.starts_with(|c: char| c.is_ascii_digit());
    let (a, b): (Vec<&str>, Vec<&str>) = (a.split(' ').collect(), b.split(' ').collect());
    let word = |(a, b): (&&str, &&str)| match (a == b, number(a) && number(b)) {
        (true, _) => Some(a.to_string()),
        (false, true) => Some("..".into()),
        (false, false) => None,
    };
    let words: Option<Vec<String>> = a.iter().zip(&b).map(word).collect();
    words.filter(|_| a.len() == b.len()).map(|words| words.join(" "))
}
