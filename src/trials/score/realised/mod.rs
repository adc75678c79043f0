//! How much of the true gap an answer closes on a recording nobody has seen.

mod by_position;
mod by_torque;

use std::collections::BTreeMap;

use super::super::{Hidden, TrialError, TrueValue, Truth};
use crate::diagnosis::{Cause, Checked, Diagnosis, Value, mend};
use crate::effects;
use crate::recording::Recording;
use crate::twin::Twin;

/// Mean square that a twin leaves of a recording.
type Left = Box<dyn Fn(&Twin) -> Result<f64, TrialError>>;

/// Shrink of the mean square of the gap on the third recording, what the twin leaves open fitted there: with the
/// causes of the answer, and with the hidden effects at their true values (`None` where the
/// catalogue cannot state them).
///
/// # Errors
/// If the recording is not of this arm, or an arm of position servos cannot be simulated as given.
pub fn realised(
    twin: &Twin,
    third: &Recording,
    truth: &Truth,
    diagnosis: &Diagnosis,
) -> Result<(f64, Option<f64>), TrialError> {
    let left = match &twin.drive.servo {
        Some(servo) => by_position::left(third, twin, servo)?,
        None => by_torque::left(third)?,
    };
    let before = left(twin)?;
    let shrink = |causes: &[Cause]| -> Result<f64, TrialError> {
        let mended = mend(twin, &BTreeMap::new(), causes);
        Ok(1.0 - left(&mended)? / before)
    };
    let hidden: Option<Vec<Cause>> = truth.effects.iter().map(hidden).collect();
    let oracle = hidden.filter(|h| !h.is_empty()).map(|hidden| shrink(&hidden)).transpose()?;
    Ok((shrink(&diagnosis.causes)?, oracle))
}

/// A hidden effect as an answer would state it.
fn hidden(hidden: &Hidden) -> Option<Cause> {
    effects::find(&hidden.effect)?;
    // One value stands for all joints, several each for its own.
    let joint = |p: &TrueValue, i: usize| {
        let own = hidden.joints.get(i).copied().unwrap_or(i + 1);
        (p.values.len() > 1).then_some(own)
    };
    let value = |(p, (i, &value)): (&TrueValue, (usize, &f64))| Value {
        name: p.name.clone(),
        joint: joint(p, i),
        unit: String::new(),
        value,
        low: value,
        high: value,
        at_bound: false,
    };
    let values =
        hidden.parameters.iter().flat_map(|p| p.values.iter().enumerate().map(move |v| (p, v)));
    Some(Cause {
        effect: hidden.effect.clone(),
        joints: hidden.joints.clone(),
        probability: 1.0,
        equivalent: Vec::new(),
        parameters: values.map(value).collect(),
        shrink: Checked::default(),
        replaces: None,
        recording: None,
        found_without_check: true,
        cause: String::new(),
        remedy: String::new(),
    })
}
