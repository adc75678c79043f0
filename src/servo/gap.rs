//! How far a twin's positions are from those recorded.

use super::Track;
use crate::series::JointSeries;

/// Position error of one joint, rad.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct JointPosition {
    /// From 1.
    pub joint: usize,
    pub rms_rad: f64,
    pub mean_abs_rad: f64,
    /// What rounding to the encoder's steps alone leaves of a perfect twin, root mean square.
    pub rounding_rad: f64,
    /// 1 less the errors' share of the recorded position's variance.
    pub r2: f64,
}

/// Position errors of all joints.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PositionGap {
    pub joints: Vec<JointPosition>,
}

impl PositionGap {
    /// Between a simulated motion and what is recorded, where nothing is missing.
    pub fn new(track: &Track, simulated: &JointSeries) -> Self {
        let of = |j: usize| {
            let used: Vec<usize> = (0..track.len()).filter(|&k| track.usable[k]).collect();
            let n = used.len().max(1) as f64;
            let q = track.q.joint(j);
            let mean = used.iter().map(|&k| q[k]).sum::<f64>() / n;
            let error = |k: &usize| simulated.joint(j)[*k] - q[*k];
            let squares: f64 = used.iter().map(|k| error(k).powi(2)).sum();
            let spread: f64 = used.iter().map(|&k| (q[k] - mean).powi(2)).sum();
            JointPosition {
                joint: j + 1,
                rms_rad: (squares / n).sqrt(),
                mean_abs_rad: used.iter().map(|k| error(k).abs()).sum::<f64>() / n,
                rounding_rad: track.resolution[j] / 12f64.sqrt(),
                r2: if spread > 0.0 { 1.0 - squares / spread } else { f64::NAN },
            }
        };
        Self { joints: (0..track.joints()).map(of).collect() }
    }

    /// Root mean square over all joints, rad.
    pub fn rms_rad(&self) -> f64 {
        let n = self.joints.len().max(1) as f64;
        (self.joints.iter().map(|j| j.rms_rad.powi(2)).sum::<f64>() / n).sqrt()
    }

    /// Mean size of the error over all joints, rad.
    pub fn mean_abs_rad(&self) -> f64 {
        let n = self.joints.len().max(1) as f64;
        self.joints.iter().map(|j| j.mean_abs_rad).sum::<f64>() / n
    }
}
