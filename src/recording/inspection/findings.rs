//! What is wrong with a recording, in plain words: what it means and what to do.

use super::motion::{JointMotion, SLIDING_RAD_S};
use super::{Inspection, JointSignal};
use crate::recording::Recording;

/// Slower leaves Stribeck and viscous friction open.
const SLOW_RAD_S: f64 = 0.3;
const JUMP_RAD_S: f64 = 0.05;
const JUMP_TIMES: f64 = 3.0;
const ALIKE: f64 = 0.99;
const SLOPE_OFF: f64 = 0.05;
/// Velocity noise from differencing neighbouring rounded positions that matters, rad/s.
const COARSE_RAD_S: f64 = 0.002;
/// Noise below so much of a step no longer blurs it (docs/studies), ...
const BLURRED: f64 = 0.25;
/// ... which matters where the step is so much of the RMS.
const COARSE_SHARE: f64 = 0.01;

pub fn find(inspection: &Inspection, recording: &Recording) -> Vec<String> {
    [sampling, missing_signals, units, motion, velocity, rounding, coarse_load, noise]
        .iter()
        .flat_map(|rule| rule(inspection))
        .chain(constant(inspection))
        .chain(jumps(recording))
        .chain(equal(recording))
        .collect()
}

fn sampling(inspection: &Inspection) -> Vec<String> {
    let s = &inspection.sampling;
    let mut found = Vec::new();
    if s.missing > 0 {
        let times: Vec<_> = s.gaps.iter().take(3).map(|g| format!("{:.3}", g.after_s)).collect();
        let more = if s.gaps.len() > 3 { ", ..." } else { "" };
        found.push(format!(
            "{} samples are missing at {:.0} Hz: {} gaps of up to {:.1} ms, after {}{more} s",
            s.missing,
            s.nominal_hz,
            s.gaps.len(),
            1e3 * s.step_max_s,
            times.join(", "),
        ));
    }
    if s.jitter_share > 0.01 {
        found.push(format!(
            "the time steps are not equal ({:.1} to {:.1} ms, {:.1} Hz on average): use the time \
             column, never a fixed step",
            1e3 * s.step_min_s,
            1e3 * s.step_max_s,
            s.mean_hz
        ));
    }
    if s.mean_hz < 50.0 && plausible_step(s.step_median_s) {
        found.push(format!("{:.1} Hz is slow: reversals and stiction are blurred", s.mean_hz));
    }
    found
}

/// Whether a step of time, s, is that of a recording.
pub fn plausible_step(step: f64) -> bool {
    (1e-5..0.5).contains(&step)
}

fn has(inspection: &Inspection, stem: &str) -> bool {
    inspection.signals.iter().any(|s| s.name == stem)
}

fn missing_signals(inspection: &Inspection) -> Vec<String> {
    let lacks = |stem: &&(&str, &str)| !has(inspection, stem.0);
    let mut found: Vec<String> = [
        ("actual_q", "no actual_q: without joint positions nothing can be done with it"),
        ("actual_qd", "no actual_qd: velocity must come from the position"),
    ]
    .iter()
    .filter(lacks)
    .map(|(_, what)| (*what).to_string())
    .collect();
    if !has(inspection, "actual_current") && !has(inspection, "joint_torque") {
        found.push("neither actual_current nor joint_torque: friction cannot be identified".into());
    }
    if !has(inspection, "joint_temperatures") {
        found.push("no joint_temperatures: warm-up cannot be told from other changes".into());
    }
    found
}

/// Quantity, its largest plausible size in the unit expected, and what a larger one probably is.
const PLAUSIBLE: &[(&str, f64, &str)] = &[
    ("rad", 13.0, "degrees: scale by 0.0174532925"),
    ("rad/s", 20.0, "degrees/s: scale by 0.0174532925"),
    ("A", 100.0, "mA: scale by 0.001"),
    // A tonne at a reach of 3 m weighs 29 000 N.m.
    ("N.m", 50_000.0, "N.mm: scale by 0.001"),
    ("deg C", 150.0, "kelvin, or tenths of a degree"),
];

fn units(inspection: &Inspection) -> Vec<String> {
    let mut found = Vec::new();
    for signal in &inspection.signals {
        let Some((unit, limit, guess)) = PLAUSIBLE.iter().find(|(u, ..)| *u == signal.unit) else {
            continue;
        };
        if signal.largest() > *limit {
            let (name, largest) = (&signal.name, signal.largest());
            found.push(format!("{name} reaches {largest:.4} {unit}; it may be in {guess}"));
        }
    }
    let step = inspection.sampling.step_median_s;
    if !plausible_step(step) {
        let guess = if step < 1.0 { "time in larger units" } else { "time in ms, us or ns" };
        found.push(format!("the time step is {step} s; probably {guess}: set time_scale"));
    }
    found
}

/// "joint 3", "joints 1, 3"
fn joints(which: &[&JointMotion]) -> String {
    let names: Vec<String> = which.iter().map(|m| m.joint.to_string()).collect();
    format!("joint{} {}", if names.len() == 1 { "" } else { "s" }, names.join(", "))
}

fn motion(inspection: &Inspection) -> Vec<String> {
    let all = &inspection.motion;
    let which = |test: &dyn Fn(&JointMotion) -> bool| -> Vec<&JointMotion> {
        all.iter().filter(|m| test(m)).collect()
    };
    let moves = |m: &JointMotion| m.travels() && m.top_speed() > SLIDING_RAD_S;
    let rules: [(Vec<&JointMotion>, String); 3] = [
        (
            which(&|m| !moves(m)),
            "no motion beyond shaking, so no friction can be seen there".into(),
        ),
        (
            which(&|m| moves(m) && m.top_speed() < SLOW_RAD_S),
            format!("below {SLOW_RAD_S} rad/s only: friction at higher speed stays open"),
        ),
        (
            which(&|m| moves(m) && m.top_speed() >= SLOW_RAD_S && m.reversals == 0),
            "in one direction only: friction cannot be told from a constant torque".into(),
        ),
    ];
    let stated = rules.into_iter().filter(|(which, _)| !which.is_empty());
    let who = |which: &[&JointMotion]| match which.len() == all.len() {
        true => "every joint".into(),
        false => joints(which),
    };
    stated.map(|(which, what)| format!("{}: {what}", who(&which))).collect()
}

fn velocity(inspection: &Inspection) -> Vec<String> {
    let mut found = Vec::new();
    for m in &inspection.motion {
        let (Some(correlation), Some(slope)) = (m.velocity_correlation, m.velocity_slope) else {
            continue;
        };
        let unlike = (correlation < ALIKE).then(|| format!("correlates by {correlation:.3} only"));
        let other =
            ((slope - 1.0).abs() > SLOPE_OFF).then(|| format!("is {slope:.3} times as large"));
        let what: Vec<String> = unlike.into_iter().chain(other).collect();
        if what.is_empty() {
            continue;
        }
        let what = what.join(" and ");
        found.push(format!(
            "joint {}: actual_qd {what}, beside the differentiated actual_q: one of them is not what \
             it says (unit, joint order, sign or filter)",
            m.joint
        ));
    }
    found
}

/// Rounding by a step D leaves D/sqrt(12) RMS; the difference of two over dt has sqrt(2) D/sqrt(12)/dt.
fn rounding(inspection: &Inspection) -> Vec<String> {
    let Some(q) = inspection.signals.iter().find(|s| s.name == "actual_q") else {
        return Vec::new();
    };
    let step = q.columns.iter().filter_map(|c| c.step).fold(0.0, f64::max);
    let noise = step / 6f64.sqrt() * inspection.sampling.nominal_hz;
    if noise < COARSE_RAD_S {
        return Vec::new();
    }
    vec![format!(
        "positions come in steps of {step:.1e} rad: differences of neighbouring samples carry \
         {noise:.4} rad/s of noise, so filter before differentiating"
    )]
}

/// Steps of the current or torque that noise does not blur are errors that go with the motion.
fn coarse_load(inspection: &Inspection) -> Vec<String> {
    let load = |name: &str| ["actual_current", "actual_moment", "joint_torque"].contains(&name);
    let coarse = |c: &JointSignal| -> Option<f64> {
        let share = c.step? / c.rms;
        (c.noise < BLURRED * c.step? && (COARSE_SHARE..1.0).contains(&share)).then_some(share)
    };
    let mut found = Vec::new();
    for signal in inspection.signals.iter().filter(|s| load(&s.name)) {
        for (j, column) in signal.columns.iter().enumerate() {
            let (Some(share), Some(step)) = (coarse(column), column.step) else { continue };
            found.push(format!(
                "joint {}: {} comes in steps of {step:.4} {}, {:.0} % of its RMS, and too little \
                 noise to blur them: friction fitted to it may be off by more than its interval \
                 says, so record more digits",
                j + 1,
                signal.name,
                signal.unit,
                100.0 * share
            ));
        }
    }
    found
}

fn noise(inspection: &Inspection) -> Vec<String> {
    if inspection.signals.iter().any(|s| s.columns.iter().any(|c| c.noise_at_rest)) {
        return Vec::new();
    }
    vec!["the arm is never at rest for long: noise figures are upper bounds from motion".into()]
}

fn constant(inspection: &Inspection) -> Vec<String> {
    let measured = |name: &str| name.starts_with("actual_") || name == "joint_torque";
    let mut found = Vec::new();
    for signal in inspection.signals.iter().filter(|s| measured(&s.name) && s.columns.len() > 1) {
        let moves = |j: usize| inspection.motion.get(j).is_none_or(|m| m.moving_share > 0.0);
        let motion = signal.name.starts_with("actual_q");
        let stuck = |(j, c): &(usize, &JointSignal)| c.low == c.high && (moves(*j) || !motion);
        let columns = signal.columns.iter().enumerate().filter(stuck);
        let names: Vec<_> = columns.map(|(j, _)| format!("{}_{j}", signal.name)).collect();
        if !names.is_empty() {
            let names = names.join(", ");
            found.push(format!("constant throughout, so not measured or stuck: {names}"));
        }
    }
    found
}

/// A commanded velocity that changes by more than its own acceleration allows.
fn jumps(recording: &Recording) -> Vec<String> {
    let (Some(qd), Some(qdd)) = (recording.joints("target_qd"), recording.joints("target_qdd"))
    else {
        return Vec::new();
    };
    let time = &recording.time;
    let mut found = Vec::new();
    for j in 0..qd.joints().min(qdd.joints()) {
        let (v, top) = (qd.joint(j), qdd.joint(j).iter().fold(0.0, |m: f64, a| m.max(a.abs())));
        let beyond = |k: &usize| {
            (v[k + 1] - v[*k]).abs() > JUMP_RAD_S + JUMP_TIMES * top * (time[k + 1] - time[*k])
        };
        let all: Vec<usize> = (0..v.len() - 1).filter(beyond).collect();
        if let Some(k) = all.first() {
            found.push(format!(
                "joint {}: target_qd jumps {} time(s), first by {:.2} rad/s at {:.3} s: the motion \
                 was broken off there, and the arm will shake",
                j + 1,
                all.len(),
                v[k + 1] - v[*k],
                time[k + 1],
            ));
        }
    }
    found
}

/// A signal that repeats another holds no second measurement.
fn equal(recording: &Recording) -> Vec<String> {
    let varies = |v: &[f64]| v.iter().any(|x| *x != v[0]);
    let mut found = Vec::new();
    let firsts: Vec<_> = recording
        .stems()
        .into_iter()
        .filter(|stem| (0..recording.joint_count(stem)).any(|j| varies(column(recording, stem, j))))
        .collect();
    for (k, stem) in firsts.iter().enumerate() {
        let same = |other: &&String| {
            let joints = recording.joint_count(other);
            joints == recording.joint_count(stem)
                && (0..joints).all(|j| column(recording, stem, j) == column(recording, other, j))
        };
        if let Some(other) = firsts[..k].iter().find(same) {
            found.push(format!("{stem} repeats {other} value by value: no second measurement"));
        }
    }
    found
}

fn column<'a>(recording: &'a Recording, stem: &str, j: usize) -> &'a [f64] {
    recording.channel(&format!("{stem}_{j}")).unwrap_or_default()
}
