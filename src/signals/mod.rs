//! Recording -> uniformly sampled motion and torque, with every choice visible.

use crate::series::JointSeries;

/// Choices made on the way from a recording to [`Samples`]; echoed in every output.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Conditioning {
    /// Uniform grid, Hz; `None` takes the recording's median rate.
    pub rate_hz: Option<f64>,
    /// How velocity and acceleration come about.
    pub derivatives: Derivatives,
    /// Zero-phase low-pass of the position before it is differentiated, Hz; 0 is none.
    pub motion_cutoff_hz: f64,
    /// Zero-phase low-pass of torque and regressors alike, Hz; 0 is none.
    pub torque_cutoff_hz: f64,
    /// Butterworth order (each pass; forward and backward doubles it).
    pub filter_order: usize,
    /// Samples with |qd| at or below this are not sliding, rad/s; 0 keeps all.
    pub standstill_rad_s: f64,
    /// Dropped at both ends, where zero-phase filters have no past or future, s.
    pub margin_s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Derivatives {
    /// Central differences of the low-passed measured position.
    Position,
    /// Commanded motion plus the smoothed tracking error: no differentiation noise.
    TrackingError,
    /// The recorded velocity, differentiated once.
    Recorded,
    /// The paper's: recorded velocity, mean of forward and backward difference, no filter.
    Paper,
}

impl Default for Conditioning {
    fn default() -> Self {
        Self {
            rate_hz: None,
            derivatives: Derivatives::Position,
            motion_cutoff_hz: 8.0,
            torque_cutoff_hz: 8.0,
            filter_order: 4,
            standstill_rad_s: 0.02,
            margin_s: 0.5,
        }
    }
}

/// Motion and torque of every joint on a uniform grid. The torque is as measured, not filtered:
/// identification filters it together with its regressors.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// s
    pub dt: f64,
    /// Time of the first sample in the recording, s.
    pub start: f64,
    pub q: JointSeries,
    pub qd: JointSeries,
    pub qdd: JointSeries,
    /// N.m at the joint, drive side.
    pub torque: JointSeries,
    /// deg C, where recorded.
    pub temperature: Option<JointSeries>,
    pub conditioning: Conditioning,
    /// What was resampled, filled or dropped, for people.
    pub notes: Vec<String>,
}
