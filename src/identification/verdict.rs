//! What a fit says, in plain words.

use super::judge::LEVEL;
use super::{JointEstimate, MethodResult, ParameterEstimate};
use crate::numbers::digits;

/// One line per joint, one for the arm's own parameters.
pub fn verdict(result: &MethodResult) -> Vec<String> {
    let mut lines: Vec<String> = result.joints.iter().map(of_joint).collect();
    if !result.arm.is_empty() {
        lines.push(format!("arm: {}", sentence(result.arm.iter())));
    }
    lines
}

fn of_joint(j: &JointEstimate) -> String {
    if j.parameters.iter().all(|p| !p.identifiable) {
        let why = j.parameters.iter().find_map(|p| p.why_not.as_deref()).unwrap_or("no data");
        return format!("joint {}: nothing can be said: {why}", j.joint);
    }
    // The curve is spoken of by its excess.
    let spoken = j.parameters.iter().filter(|p| !["static", EXCESS].contains(&p.name.as_str()));
    let curve = j.parameters.iter().find(|p| p.name == EXCESS);
    let curve = curve.map(|excess| format!("; {}", curve_words(excess, &j.parameters)));
    let terms = spoken.filter(|p| p.name != "stribeck_velocity");
    format!("joint {}: {}{}", j.joint, sentence(terms), curve.unwrap_or_default())
}

const EXCESS: &str = "stribeck_excess";

/// What data say of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It has a value, and zero is not within its interval.
    Shown,
    /// It has a value, and zero is within its interval: it may be absent.
    MayBeZero,
    /// These data do not determine it: it has no interval.
    Open,
}

/// The one place that decides what is said of a parameter.
pub fn standing(p: &ParameterEstimate) -> Standing {
    match (p.identifiable, !p.at_bound && p.p < 1.0 - LEVEL) {
        (false, _) => Standing::Open,
        (true, true) => Standing::Shown,
        (true, false) => Standing::MayBeZero,
    }
}

/// "a 1.0 N.m; may be zero: b; not determined: c"
fn sentence<'a>(parameters: impl Iterator<Item = &'a ParameterEstimate>) -> String {
    let (mut has, mut lacks, mut open) = (vec![], vec![], vec![]);
    for p in parameters {
        let name = p.name.replace('_', " ");
        match standing(p) {
            Standing::Open => open.push(name),
            Standing::Shown => has.push(format!("{name} {} {}", digits(p.value), p.unit)),
            Standing::MayBeZero => lacks.push(name),
        }
    }
    let mut parts = Vec::new();
    let mut say = |names: Vec<String>, before: &str| {
        if !names.is_empty() {
            parts.push(format!("{before}{}", names.join(", ")));
        }
    };
    say(has, "");
    say(lacks, "may be zero: ");
    say(open, "not determined: ");
    parts.join("; ")
}

/// A dip is an excess that is significant, positive, and has a velocity of its own.
fn curve_words(excess: &ParameterEstimate, all: &[ParameterEstimate]) -> String {
    let velocity = all.iter().find(|p| p.name == "stribeck_velocity");
    match velocity {
        Some(v) if v.identifiable && excess.value > 0.0 => {
            format!("Stribeck dip of {:.2} N.m below {:.3} rad/s", excess.value, v.value)
        }
        Some(v) if v.identifiable => format!(
            "T_s lies {:.2} N.m below T_c (w_s {:.3} rad/s): friction rises with speed at first, \
             which is no Stribeck dip",
            -excess.value, v.value
        ),
        _ => "no Stribeck dip shown".into(),
    }
}
