//! Recording -> uniformly sampled motion and torque, with every choice visible.
//!
//! [`condition`] picks the channels, puts them on a uniform grid, low-passes and differentiates
//! the motion. The torque stays as measured: whoever regresses on it filters torque and regressors
//! alike ([`LowPass::apply_many`]), keeps every [`Samples::decimation`]-th sample and masks
//! standstill ([`Samples::rows`]); parallel filtering, Swevers, Verdonck and De Schutter,
//! "Dynamic model identification for industrial robots", IEEE Control Systems 27(5), 2007.

mod channels;
mod condition;
mod cycle;
mod decimator;
mod derivative;
mod error;
mod low_pass;
mod mask;
mod resample;
mod response;
mod savitzky_golay;
mod thin;
mod tracking;

pub use condition::condition;
pub use cycle::{ALIKE, SAME, cycle};
pub use decimator::Decimator;
pub use derivative::{central_difference, mean_difference, second_difference};
pub use error::SignalError;
pub use low_pass::LowPass;
pub use mask::{Rows, erode, runs};
pub use resample::{Interpolation, UniformGrid};
pub use response::{Giving, Response};
pub use savitzky_golay::SavitzkyGolay;
pub use thin::thin;

use std::sync::Arc;

use crate::robot::Told;
use crate::series::JointSeries;

/// Choices made on the way from a recording to [`Samples`]; echoed in every output.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Conditioning {
    /// Uniform grid, Hz; `None` takes the recording's own rate (its commonest step, or the mean
    /// step when fewer than four in five agree).
    pub rate_hz: Option<f64>,
    /// How values between recorded instants are found.
    pub interpolation: Interpolation,
    /// Steps longer than this many periods are gaps: nothing in or near them is used.
    pub gap_periods: f64,
    /// How velocity and acceleration come about.
    pub derivatives: Derivatives,
    /// Zero-phase low-pass of the motion before it is differentiated, Hz; 0 is none. Of the
    /// tracking error alone where [`Derivatives::TrackingError`] is chosen. Well above the torque
    /// cutoff, so that reversals stay sharp: the torque filter then smooths both sides alike.
    pub motion_cutoff_hz: f64,
    /// Cutoff of that low-pass near standstill, where friction that changes its sign kinks the motion, Hz:
    /// more noise there, but less of the kink smeared over its neighbours. For
    /// [`Derivatives::TrackingError`]; one that is not above `motion_cutoff_hz` has no effect.
    pub standstill_cutoff_hz: f64,
    /// Zero-phase low-pass of torque and regressors alike, Hz; 0 is none.
    pub torque_cutoff_hz: f64,
    /// Butterworth order (each pass; forward and backward doubles it).
    pub filter_order: usize,
    /// Samples with |qd| at or below this are not sliding, rad/s; 0 keeps all.
    pub standstill_rad_s: f64,
    /// Sliding samples nearer than this to standstill are not used either: filters smear the
    /// arbitrary torque of a standing joint over its neighbours, s. Long guards lose the slow
    /// sliding that shows Stribeck friction.
    pub guard_s: f64,
    /// Dropped at both ends and beside gaps, where zero-phase filters have no past or future, s.
    pub margin_s: f64,
    /// Keep every n-th sample; `None` follows from the torque cutoff ([`Samples::decimation`]).
    pub decimation: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Derivatives {
    /// Central differences of the low-passed measured position.
    Position,
    /// Commanded motion plus the smoothed tracking error: no differentiation noise.
    TrackingError,
    /// The recorded velocity, low-passed and differentiated once.
    Recorded,
    /// The paper's: recorded velocity, mean of forward and backward difference, no filter.
    Paper,
}

impl Default for Conditioning {
    fn default() -> Self {
        Self {
            rate_hz: None,
            interpolation: Interpolation::Cubic,
            gap_periods: 5.0,
            derivatives: Derivatives::Position,
            motion_cutoff_hz: 20.0,
            standstill_cutoff_hz: 0.0,
            torque_cutoff_hz: 8.0,
            filter_order: 4,
            standstill_rad_s: 0.02,
            guard_s: 0.1,
            margin_s: 0.5,
            decimation: None,
        }
    }
}

impl Conditioning {
    /// The highest cutoff by which the motion is smoothed anywhere, Hz; 0 is none.
    pub fn sharpest_cutoff_hz(&self) -> f64 {
        match self.derivatives {
            Derivatives::TrackingError => self.motion_cutoff_hz.max(self.standstill_cutoff_hz),
            _ => self.motion_cutoff_hz,
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
    /// rad
    pub q: JointSeries,
    /// rad/s
    pub qd: JointSeries,
    /// rad/s^2
    pub qdd: JointSeries,
    /// N.m at the joint, drive side.
    pub torque: JointSeries,
    /// What position servos were told, where the torque follows from that.
    pub told: Option<Told>,
    /// Where the motion is simulated along a command: what torque shows of itself in recorded position.
    pub response: Option<Arc<Response>>,
    /// Present where velocities are recorded and the motion is made from positions.
    pub sensed: Option<Sensed>,
    /// Acceleration of the motion smoothed at half the sharpest cutoff less that at it, rad/s^2: large where the motion
    /// kinks. `None` where it is not smoothed.
    pub smoothed_further: Option<JointSeries>,
    /// deg C, where recorded.
    pub temperature: Option<JointSeries>,
    /// False in the margins at both ends, in gaps and beside them; the same for every joint.
    pub usable: Vec<bool>,
    pub conditioning: Conditioning,
    /// What was resampled, filled or dropped, for people.
    pub notes: Vec<String>,
}

/// Position (rad) and velocity (rad/s) as recorded, not filtered.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensed {
    pub q: JointSeries,
    pub qd: JointSeries,
}

impl Samples {
    pub fn joints(&self) -> usize {
        self.q.joints()
    }

    /// Samples per joint.
    pub fn len(&self) -> usize {
        self.q.samples()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn rate_hz(&self) -> f64 {
        1.0 / self.dt
    }

    /// Recording time of sample `k`, s.
    pub fn time(&self, k: usize) -> f64 {
        self.start + k as f64 * self.dt
    }

    /// Samples of a quarter of a period of the motion's sharpest cutoff, or the torque's if that is lower: what is left
    /// of a kink swings no faster.
    pub fn quarter_period(&self) -> usize {
        let cutoffs = [self.conditioning.sharpest_cutoff_hz(), self.conditioning.torque_cutoff_hz];
        let given = cutoffs.into_iter().filter(|hz| *hz > 0.0);
        (0.25 * self.rate_hz() / given.fold(0.5 * self.rate_hz(), f64::min)).round() as usize
    }

    /// The low-pass for torque and regressors; `None` where the conditioning says none.
    pub fn torque_filter(&self) -> Result<Option<LowPass>, SignalError> {
        let Conditioning { torque_cutoff_hz, filter_order, .. } = self.conditioning;
        // The servos themselves are one.
        if self.response.is_some() {
            return Ok(None);
        }
        LowPass::if_wanted(torque_cutoff_hz, self.rate_hz(), filter_order)
    }
}

#[cfg(test)]
pub mod testing;
#[cfg(test)]
mod tests;
