//! The gap in the position of an arm of servos.

use super::Left;
use crate::diagnosis::conditioning;
use crate::recording::Recording;
use crate::servo::{PositionGap, ServoError, Track, open_fitted, replay};
use crate::signals::condition;
use crate::trials::TrialError;
use crate::twin::Twin;

/// Mean square over all joints of the position error of a twin that is led along the command, from the first sample to
/// the last, what it leaves open fitted there, rad^2. A twin that runs away leaves everything.
///
/// # Errors
/// If the recording is not of this arm.
pub fn left(third: &Recording, nominal: &Twin) -> Result<Left, TrialError> {
    let dof = nominal.robot.dof();
    let samples = condition(third, &nominal.drive, dof, &conditioning(third, dof))?;
    let track = Track::new(&samples, nominal)?;
    let gap = move |twin: &Twin| -> Result<f64, ServoError> {
        let q = replay(&open_fitted(twin, &track, &())?, &track, &track.stretches(f64::INFINITY))?;
        Ok(PositionGap::new(&track, &q).rms_rad().powi(2))
    };
    Ok(Box::new(move |twin| match gap(twin) {
        Err(ServoError::Diverged { .. }) => Ok(f64::INFINITY),
        other => Ok(other?),
    }))
}
