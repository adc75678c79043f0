//! How much of the true gap an answer closes on a recording nobody has seen.

use std::collections::BTreeMap;

use super::super::strength::{SLIDING_RAD_S, rms, without_friction};
use super::super::third::Third;
use super::super::{Hidden, TrueValue, Truth};
use crate::diagnosis::{Cause, Checked, Diagnosis, Value, mend};
use crate::effects;
use crate::signals::{Conditioning, Derivatives, Samples};
use crate::twin::Twin;

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
    let mended = |causes: &[Cause]| mend(twin, &BTreeMap::new(), causes);
    let shrink = |causes: &[Cause]| 1.0 - left(&mended(causes), &samples) / before;
    let hidden: Option<Vec<Cause>> = truth.effects.iter().map(hidden).collect();
    (shrink(&diagnosis.causes), hidden.filter(|h| !h.is_empty()).map(|hidden| shrink(&hidden)))
}

/// A hidden effect as an answer would state it.
fn hidden(hidden: &Hidden) -> Option<Cause> {
    effects::find(&hidden.effect)?;
    let value = |p: &TrueValue| {
        let value = *p.values.first()?;
        let (name, unit) = (p.name.clone(), String::new());
        Some(Value { name, joint: None, unit, value, low: value, high: value, at_bound: false })
    };
    Some(Cause {
        effect: hidden.effect.clone(),
        joints: hidden.joints.clone(),
        probability: 1.0,
        equivalent: Vec::new(),
        parameters: hidden.parameters.iter().filter_map(value).collect(),
        shrink: Checked::default(),
        replaces: None,
        recording: None,
        found_without_check: true,
        cause: String::new(),
        remedy: String::new(),
    })
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
        told: None,
        response: None,
        sensed: None,
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
    let joints = samples.joints();
    (0..joints).map(squares).sum::<f64>() / joints as f64
}
