//! How much of the true gap an answer closes on a recording nobody has seen.

use super::super::strength::{SLIDING_RAD_S, rms, without_friction};
use super::super::third::Third;
use super::super::{Hidden, Truth};
use crate::diagnosis::{Cause, Diagnosis};
use crate::effects::{self, Effect, Role, Scope};
use crate::series::JointSeries;
use crate::signals::{Conditioning, Derivatives, Samples};
use crate::twin::Twin;

/// An effect with values, as an answer or a truth states it.
struct Stated<'a> {
    effect: &'static dyn Effect,
    /// From 1; empty is the whole arm.
    joints: &'a [usize],
    /// By name and place in `joints`.
    value: Box<dyn Fn(&str, usize) -> Option<f64> + 'a>,
}

/// Shrink of the mean square of the gap on the third recording, friction fitted there: with the
/// causes of the answer, and with the hidden effects at their true values (`None` where the
/// catalogue cannot state them).
pub fn realised(
    twin: &Twin,
    third: &Third,
    truth: &Truth,
    diagnosis: &Diagnosis,
) -> (f64, Option<f64>) {
    let samples = samples(third);
    let before = left(twin, &samples);
    let shrink = |stated: &[Stated<'_>]| 1.0 - left(&mended(twin, stated), &samples) / before;
    let causes: Vec<Stated<'_>> = diagnosis.causes.iter().filter_map(cause).collect();
    let hidden: Option<Vec<Stated<'_>>> = truth.effects.iter().map(hidden).collect();
    (shrink(&causes), hidden.filter(|h| !h.is_empty()).map(|hidden| shrink(&hidden)))
}

fn cause(cause: &Cause) -> Option<Stated<'_>> {
    let value = |name: &str, i: usize| {
        let of_joint = format!("{name}_{}", cause.joints.get(i).copied().unwrap_or(i + 1));
        let named = |n: &str| cause.parameters.iter().find(|p| p.name == n);
        named(&of_joint).or_else(|| named(name)).map(|p| p.value)
    };
    let effect = effects::find(&cause.effect)?;
    Some(Stated { effect, joints: &cause.joints, value: Box::new(value) })
}

fn hidden(hidden: &Hidden) -> Option<Stated<'_>> {
    let value = |name: &str, i: usize| {
        let p = hidden.parameters.iter().find(|p| p.name == name)?;
        p.values.get(i).or(p.values.first()).copied()
    };
    let effect = effects::find(&hidden.effect)?;
    Some(Stated { effect, joints: &hidden.joints, value: Box::new(value) })
}

fn samples(third: &Third) -> Samples {
    let dt = match third.time.as_slice() {
        [a, b, ..] => b - a,
        _ => 1.0,
    };
    let conditioning =
        Conditioning { derivatives: Derivatives::TrackingError, ..Conditioning::default() };
    Samples {
        dt,
        start: third.time.first().copied().unwrap_or(0.0),
        q: third.q.clone(),
        qd: third.qd.clone(),
        qdd: third.qdd.clone(),
        torque: third.torque.clone(),
        temperature: Some(third.temperature.clone()),
        usable: vec![true; third.time.len()],
        conditioning,
        notes: Vec::new(),
    }
}

/// Mean square over all joints of what the twin leaves while sliding, friction fitted, N.m^2.
fn left(twin: &Twin, samples: &Samples) -> f64 {
    let samples = twin.correct(samples);
    let known = twin.torque(&twin.motion(&samples));
    let squares = |j: usize| {
        let qd = samples.qd.joint(j);
        let sliding = |k: &usize| qd[*k].abs() > SLIDING_RAD_S;
        let gap = |k: usize| (samples.torque.joint(j)[k] - known.joint(j)[k], qd[k]);
        let (gap, qd): (Vec<f64>, Vec<f64>) = (0..samples.len()).filter(sliding).map(gap).unzip();
        rms(&without_friction(&gap, &qd)).powi(2)
    };
    let all: JointSeries = samples.torque.clone();
    (0..all.joints()).map(squares).sum::<f64>() / all.joints() as f64
}

/// The twin with these effects at these values.
fn mended(twin: &Twin, stated: &[Stated<'_>]) -> Twin {
    let mut mended = twin.clone();
    for s in stated {
        let about = s.effect.about();
        if !mended.effects.iter().any(|name| name == about.name) {
            mended.effects.push(about.name.into());
        }
        for joint in 0..twin.robot.dof() {
            let Some(row) = row(s, joint) else { continue };
            write(&mut mended, s.effect, joint, &row);
        }
    }
    mended
}

/// Values at a joint in the order of the parameters, references settled; `None` where the effect
/// does not act.
fn row(stated: &Stated<'_>, joint: usize) -> Option<Vec<f64>> {
    let about = stated.effect.about();
    let place = match (about.scope, stated.joints.is_empty()) {
        (Scope::Arm, _) if joint > 0 => return None,
        (Scope::Arm, _) => 0,
        (_, true) => joint,
        (_, false) => stated.joints.iter().position(|j| *j == joint + 1)?,
    };
    let value = |p: &effects::Parameter| (stated.value)(p.name, place).unwrap_or(p.typical);
    let mut row: Vec<f64> = about.parameters.iter().map(value).collect();
    let linear = about.parameters.iter().filter(|p| p.role == Role::Linear).count();
    let (linear, nonlinear) = row.split_at_mut(linear);
    stated.effect.settle(linear, nonlinear);
    Some(row)
}

/// Where no value stands yet, the effect vanishes. Rotor inertia comes on top of the drive's.
fn write(twin: &mut Twin, effect: &dyn Effect, joint: usize, row: &[f64]) {
    let about = effect.about();
    let count = if about.scope == Scope::Arm { 1 } else { twin.robot.dof() };
    for (p, value) in about.parameters.iter().zip(row) {
        let drive = &twin.drive.rotor_inertia;
        let own = |j: usize| if p.name == "rotor_inertia" { drive[j] } else { 0.0 };
        let absent = |j: usize| own(j) + if p.null.is_nan() { p.typical } else { p.null };
        let fresh: Vec<f64> = (0..count).map(absent).collect();
        let on_top = own(joint);
        let values = twin.values.entry(p.name.into()).or_insert(fresh);
        if let Some(v) = values.get_mut(joint) {
            *v = on_top + value;
        }
    }
}
