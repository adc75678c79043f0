//! Tables of a diagnosis as the terminal and the HTML report both show them: a header, and the
//! cells under it.

use super::to_uncertainty;
use crate::diagnosis::{
    Diagnosis, JointGap, Named, Ranked, SimulationShrink, UnexplainedJoint, Value, words,
};
use crate::numbers::angle;

/// Candidates that are shown at once, besides "none" and "unknown".
const RANKED: usize = 8;

pub const GAP: [&str; 7] =
    ["joint", "gap N.m", "90 % low", "high", "noise floor", "floor told by", "of the gap"];

pub fn gap(j: &JointGap) -> Vec<String> {
    vec![
        j.joint.to_string(),
        nm(j.rms_nm),
        nm(j.low_nm),
        nm(j.high_nm),
        nm(j.noise_floor_nm),
        floor_from(&j.floor_from),
        words::percent(j.share),
    ]
}

/// How the noise floor is known, in words.
fn floor_from(name: &str) -> String {
    match name {
        "repeats" => "repeated cycles".into(),
        "estimate" => "the spectrum".into(),
        other => other.into(),
    }
}

pub const PARAMETERS: [&str; 6] = ["parameter", "unit", "value", "90 % low", "high", ""];

/// Rounded to what is known of it.
pub fn parameter(v: &Value) -> Vec<String> {
    let [value, low, high] = to_uncertainty(v.value, v.low, v.high);
    let bound = if v.at_bound { "at its bound" } else { "" };
    vec![words::parameter(v), v.unit.clone(), value, low, high, bound.into()]
}

/// "payload at the whole arm"
pub fn named(n: &Named) -> String {
    format!("{} at {}", n.effect, words::place(&n.joints))
}

pub const CANDIDATES: [&str; 4] = ["effect", "at", "probability", "evidence"];

pub fn candidate(r: &Ranked) -> Vec<String> {
    let special = is_special(r);
    let place = if special { String::new() } else { words::place(&r.joints) };
    let gain = |x: f64| if special { "-".into() } else { format!("{x:.1}") };
    let probability = words::percent(r.probability);
    vec![r.effect.clone(), place, probability, gain(r.nats)]
}

pub const UNEXPLAINED: [&str; 6] =
    ["joint", "stays N.m", "beyond tolerances", "noise floor", "discrepancy", "goes along with"];

/// What the causes leave at a joint.
pub fn unexplained(j: &UnexplainedJoint) -> Vec<String> {
    let along = j.depends_on.iter();
    let along: Vec<String> =
        along.map(|d| format!("{} ({})", d.variable, words::percent(d.share))).collect();
    vec![
        j.joint.to_string(),
        nm(j.rms_nm),
        j.beyond_tolerances_nm.map_or("-".into(), nm),
        nm(j.noise_floor_nm),
        nm(j.discrepancy_nm),
        along.join(", "),
    ]
}

/// What the rows of [`CANDIDATES`] say.
pub const EVIDENCE: &str = "evidence: logarithm of how much more probable the data are with it than without, \
                            beside what else is there, a discrepancy of any shape included (in nats: 3 are \
                            20 to 1). none: chance. unknown: a cause that is not in the catalogue. \
                            Probabilities sum to 1";

/// Those to show first, "none" and "unknown" among them, the likeliest first; and the others.
pub fn ranked(ranking: &[Ranked]) -> (Vec<&Ranked>, Vec<&Ranked>) {
    let (special, effects): (Vec<&Ranked>, Vec<&Ranked>) =
        ranking.iter().partition(|r| is_special(r));
    let probable = effects.iter().take_while(|r| words::percent(r.probability) != "0 %").count();
    let (first, rest) = effects.split_at(probable.min(RANKED));
    let mut shown = [first, &special[..]].concat();
    shown.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    (shown, rest.to_vec())
}

/// Not an effect.
fn is_special(r: &Ranked) -> bool {
    ["none", "unknown"].contains(&r.effect.as_str())
}

pub const TORQUE: [&str; 4] =
    ["torque on the check recording", "before N.m", "after N.m", "of mean square"];

/// Joint by joint, and all of them.
pub fn torque(d: &Diagnosis) -> Vec<Vec<String>> {
    let t = &d.shrink.torque;
    let [share, low, high] = [t.fraction, t.low, t.high].map(words::percent);
    let joints = t.joints.iter().map(|j| {
        let share = words::percent(j.fraction);
        vec![format!("joint {}", j.joint), nm(j.before_nm), nm(j.after_nm), share]
    });
    let share = format!("{share} ({low} .. {high})");
    let all = vec!["all joints".into(), nm(t.before_nm), nm(t.after_nm), share];
    joints.chain([all]).collect()
}

pub const SIMULATED: [&str; 3] = ["twin simulated again, less recorded (rms)", "before", "after"];

pub fn simulated(s: &SimulationShrink) -> [Vec<String>; 3] {
    let open = format!("position {} s after a recorded state, driven by its torque", s.window_s);
    [
        vec!["position, closed loop".into(), angle(s.before_rad), angle(s.after_rad)],
        vec!["torque, closed loop, N.m".into(), nm(s.torque_before_nm), nm(s.torque_after_nm)],
        vec![open, angle(s.open_loop_before_rad), angle(s.open_loop_after_rad)],
    ]
}

fn nm(torque: f64) -> String {
    format!("{torque:.3}")
}
