//! How much of the true gap an answer closes on a recording nobody has seen.

mod by_position;
mod by_torque;

use std::collections::BTreeMap;

use super::super::{Hidden, TrialError, TrueValue, Truth};
use crate::diagnosis::{Change, Diagnosis, Value, changed};
use crate::effects;
use crate::recording::Recording;
use crate::twin::Twin;

/// Mean square that a twin leaves of a recording, N.m^2 or rad^2.
type Left = Box<dyn Fn(&Twin) -> Result<f64, TrialError>>;

/// Shrink of the mean square of the gap (1: all of it) on the third recording, what the twin leaves open fitted there: with the
/// causes of the answer, and with the hidden effects at their true values (`None` where the
/// catalogue cannot state them).
///
/// # Errors
/// If the recording lacks a channel of this arm, or an arm of position servos cannot be simulated as given.
pub fn realised(
    twin: &Twin,
    third: &Recording,
    truth: &Truth,
    diagnosis: &Diagnosis,
) -> Result<(f64, Option<f64>), TrialError> {
    let left = match twin.drive.servo {
        Some(_) => by_position::left(third, twin)?,
        None => by_torque::left(third, &truth.case)?,
    };
    let before = left(twin)?;
    let shrink = |changes: &[Change]| -> Result<f64, TrialError> {
        Ok(1.0 - left(&changed(twin, &BTreeMap::new(), changes))? / before)
    };
    let named: Vec<Change> = diagnosis.causes.iter().map(Change::from).collect();
    let hidden: Option<Vec<Change>> = truth.effects.iter().map(hidden).collect();
    let oracle = hidden.filter(|h| !h.is_empty()).map(|hidden| shrink(&hidden)).transpose()?;
    Ok((shrink(&named)?, oracle))
}

/// A hidden effect as a change of the twin; `None` where the catalogue cannot state it.
fn hidden(hidden: &Hidden) -> Option<Change> {
    effects::find(&hidden.effect)?;
    let values = |p: &TrueValue| -> Vec<Value> {
        p.values.iter().enumerate().map(|(i, value)| stated(hidden, p, i, *value)).collect()
    };
    let Hidden { effect, joints, parameters, .. } = hidden;
    Some(Change {
        effect: effect.clone(),
        joints: joints.clone(),
        parameters: parameters.iter().flat_map(values).collect(),
        replaces: false,
    })
}

/// Value number `i` of a parameter: one stands for all joints, several each for its own.
fn stated(hidden: &Hidden, p: &TrueValue, i: usize, value: f64) -> Value {
    let own = hidden.joints.get(i).copied().unwrap_or(i + 1);
    Value {
        name: p.name.clone(),
        joint: (p.values.len() > 1).then_some(own),
        unit: String::new(),
        value,
        low: value,
        high: value,
        at_bound: false,
    }
}
