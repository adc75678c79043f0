//! An identification in words: what was left out, how signals were made, what was found.

use super::{Identified, Link, LinkValue, Scaled, Summary};
use crate::identification::{Dropped, Gain};
pub use crate::numbers::chance;
use crate::report::to_uncertainty;

/// Terms that were taken out and why, one line per joint.
pub fn dropped(dropped: &[Dropped]) -> Vec<String> {
    let mut joints: Vec<usize> = dropped.iter().map(|d| d.joint).collect();
    joints.dedup();
    let line = |joint: usize| {
        let terms = dropped.iter().filter(|d| d.joint == joint).map(|d| match &d.why {
            Some(why) => format!("{} ({why})", d.term),
            None => format!("{} (p {})", d.term, chance(d.p)),
        });
        format!("joint {joint}: {}", terms.collect::<Vec<_>>().join(", "))
    };
    joints.into_iter().map(line).collect()
}

/// How recordings became samples.
pub fn signals(done: &Identified) -> String {
    let c = &done.conditioning;
    let derivatives = serde_json::to_value(c.derivatives).ok();
    let derivatives = derivatives.as_ref().and_then(|v| v.as_str()).unwrap_or("?").to_string();
    let s = &done.fit.samples;
    format!(
        "{:.6} Hz, derivatives from {derivatives}, low-pass {} Hz (motion) and {} Hz (torque and \
         regressors) of order {}, every {} sample, |qd| > {} rad/s, guard {} s, margin {} s",
        s.rate_hz(),
        c.motion_cutoff_hz,
        c.torque_cutoff_hz,
        c.filter_order,
        ordinal(s.decimation()),
        c.standstill_rad_s,
        c.guard_s,
        c.margin_s
    )
}

fn ordinal(n: usize) -> String {
    match n {
        1 => "single".into(),
        2 => "2nd".into(),
        3 => "3rd".into(),
        n => format!("{n}th"),
    }
}

/// Joint by joint, in words.
pub fn torque_constants(scaled: &Scaled) -> Vec<String> {
    let told = scaled.scale.joints.iter().filter(|gain| gain.identifiable);
    let line = |gain: &Gain| {
        let [value, low, high] = to_uncertainty(gain.value, gain.low, gain.high);
        format!(
            "joint {}: {value} times the twin's torque per ampere ({low} to {high}), {:.3} N.m/A",
            gain.joint, gain.torque_per_ampere
        )
    };
    told.map(line).collect()
}

/// Link by link, in words.
pub fn links(body: &Summary) -> Vec<String> {
    let link = |l: &Link| {
        let LinkValue { value, low, high, model } = l.mass_kg;
        let [value, low, high] = to_uncertainty(value, low, high);
        format!("{}: {value} kg ({low} to {high}; the model has {model:.3})", l.link)
    };
    let told = format!(
        "rigid body: {} of {} base parameters are told; links {:.1} % from the model's are called for",
        body.told,
        body.rank,
        100.0 * body.spread
    );
    std::iter::once(told).chain(body.links.iter().map(link)).chain(body.notes.clone()).collect()
}
