//! A twin's torque along a recording.

use super::{SignalOptions, WorkflowError, conditioned};
use crate::recording::Recording;
use crate::series::JointSeries;
use crate::signals::Conditioning;
use crate::twin::Twin;

/// Recorded and predicted torque on the uniform grid of the conditioned recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// In the recording, s.
    pub time: Vec<f64>,
    /// By the twin, along the recorded motion, N.m.
    pub torque: JointSeries,
    /// As recorded, not filtered, N.m.
    pub measured: JointSeries,
    /// Per joint: where it slides, away from gaps, ends and standstill.
    pub slides: Vec<Vec<bool>>,
}

/// The torque of `twin` along `recording`, conditioned with the program's defaults but for `signals`.
///
/// # Errors
/// If the recording lacks a signal or is too short.
pub fn predict(
    twin: &Twin,
    recording: &Recording,
    signals: &SignalOptions,
) -> Result<Predicted, WorkflowError> {
    let how = signals.over(Conditioning::default());
    let samples = twin.correct(&conditioned(recording, twin, &how)?);
    Ok(Predicted {
        time: (0..samples.len()).map(|k| samples.time(k)).collect(),
        torque: twin.torque(&twin.motion(&samples)),
        slides: (0..samples.joints()).map(|j| samples.mask(j)).collect(),
        measured: samples.torque,
    })
}
