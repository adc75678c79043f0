//! What the arm was asked to do.

use super::ResimulationError;
use crate::recording::Recording;
use crate::series::JointSeries;
use crate::signals::{LowPass, Samples, UniformGrid};

/// The recorded command (rad) on the samples' grid, low-passed as the recorded position is; `None`
/// where no command of all joints is recorded.
///
/// # Errors
/// If the conditioning's low-pass does not fit the rate.
pub fn command(
    recording: &Recording,
    samples: &Samples,
) -> Result<Option<JointSeries>, ResimulationError> {
    let how = &samples.conditioning;
    let Some(target) = recording.joints("target_q").filter(|q| q.joints() >= samples.joints())
    else {
        return Ok(None);
    };
    let grid = UniformGrid::new(&recording.time, how.rate_hz, how.interpolation, how.gap_periods);
    let filter = LowPass::if_wanted(how.motion_cutoff_hz, samples.rate_hz(), how.filter_order)?;
    let mut rows: Vec<Vec<f64>> =
        (0..samples.joints()).map(|j| grid.resample(target.joint(j))).collect();
    if let Some(filter) = filter {
        filter.apply_many(&mut rows);
    }
    Ok(Some(JointSeries::from_joints(&rows)))
}
