//! What a motion is asked for.

use super::ask::Ask;
use super::capsules::Surroundings;
use super::error::ExcitationError;
use super::limits::Limits;
use super::question::Recorder;
use crate::motion::Settings;

/// White noise where none is given: this share of a joint's largest torque.
const NOISE_SHARE: f64 = 0.01;
/// White noise where no largest torque is known either, N.m.
const NOISE_NM: f64 = 1.0;
/// Rest at either end, s.
pub(super) const REST_S: f64 = 1.0;

/// What is wanted and within which limits.
#[derive(Clone)]
pub struct Request {
    pub ask: Ask,
    /// Length of the motion with the rests, s.
    pub seconds: f64,
    /// Largest distance from the middle pose, speed and acceleration of any joint.
    pub range_rad: f64,
    pub speed_rad_s: f64,
    pub acceleration_rad_s2: f64,
    /// Middle pose; left out, as of other motions.
    pub home_rad: Option<Vec<f64>>,
    pub around: Surroundings,
    /// Radius of the capsules around the links, m; left out, a share of the arm's length.
    pub radius_m: Option<f64>,
    /// Length of a tool beyond the flange, along its z axis, m.
    pub tool_m: f64,
    /// Smallest distance of surfaces, m.
    pub clearance_m: f64,
    /// Standard deviation of the noise on each joint's torque, N.m; left out, a share of the largest torque.
    pub noise_nm: Option<Vec<f64>>,
    /// Sample rate of the recording the motion is made for, Hz.
    pub rate_hz: f64,
    pub seed: u64,
    /// Motions tried by the search.
    pub evaluations: usize,
}

impl Request {
    /// Settings of any motion of this length within these limits.
    pub(super) fn motion(&self) -> Settings {
        Settings {
            duration_s: self.seconds,
            rest_s: REST_S,
            range_rad: self.range_rad,
            speed_rad_s: self.speed_rad_s,
            acceleration_rad_s2: self.acceleration_rad_s2,
            home_rad: self.home_rad.clone(),
            ..Settings::default()
        }
    }

    pub(super) fn recorder(&self, limits: &Limits<'_>) -> Recorder {
        let usual = |limit: &f64| if limit.is_finite() { NOISE_SHARE * limit } else { NOISE_NM };
        let noise = self.noise_nm.clone();
        Recorder {
            rate_hz: self.rate_hz,
            noise_nm: noise.unwrap_or_else(|| limits.torque.iter().map(usual).collect()),
        }
    }

    pub(super) fn check(&self, dof: usize) -> Result<(), ExcitationError> {
        let must = |key, value: f64, range: std::ops::RangeInclusive<f64>, condition| match range
            .contains(&value)
        {
            true => Ok(()),
            false => Err(ExcitationError::Number { key, value, condition }),
        };
        let least = f64::MIN_POSITIVE;
        must("--seconds", self.seconds, 6.0..=600.0, "from 6 to 600")?;
        must("--range", self.range_rad, least..=10.0, "above 0 and up to 10")?;
        must("--speed", self.speed_rad_s, least..=100.0, "above 0 and up to 100")?;
        must("--acceleration", self.acceleration_rad_s2, least..=1000.0, "above 0 and up to 1000")?;
        must("--radius", self.radius_m.unwrap_or(1.0), least..=10.0, "above 0 and up to 10")?;
        must("--tool", self.tool_m, 0.0..=10.0, "from 0 to 10")?;
        must("--clearance", self.clearance_m, 0.0..=10.0, "from 0 to 10")?;
        must("--rate", self.rate_hz, 1.0..=1e5, "from 1 to 100000")?;
        let table = self.around.table_z.unwrap_or(0.0);
        must("--table-z", table, -100.0..=100.0, "from -100 to 100")?;
        must("--evaluations", self.evaluations as f64, 10.0..=1e7, "from 10 to 10000000")?;
        let Some(noise) = &self.noise_nm else { return Ok(()) };
        if noise.len() != dof {
            return Err(ExcitationError::Noise { given: noise.len(), joints: dof });
        }
        noise.iter().try_for_each(|&n| must("--noise", n, least..=1e6, "above 0 and up to 1000000"))
    }
}
