//! The `[motion]` table of a scenario.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::path::Path;
use super::{Envelope, Series, Trajectory};
use super::{mixed, plateaus, point_to_point, waves};
use crate::limits::TooMuch;
use crate::robot::Robot;

/// Which motion, how long, how far, how fast. Everything has a default; the robot's own limits
/// are never passed.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    pub kind: Kind,
    pub seed: u64,
    /// Length of the motion with the rests at both ends, s.
    pub duration_s: f64,
    /// Length of the rest at each end, s.
    pub rest_s: f64,
    /// Largest distance of a joint from the home pose, rad.
    pub range_rad: f64,
    /// Largest speed of any joint, rad/s.
    pub speed_rad_s: f64,
    /// Largest acceleration of any joint, rad/s^2.
    pub acceleration_rad_s2: f64,
    /// Middle of the motion, one angle per joint, rad; left out: a pose above the table for UR
    /// arms, the middle of the joint limits for others.
    pub home_rad: Option<Vec<f64>>,
    /// Coefficients of the kind `series`; other kinds have no use for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub series: Option<Series>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            kind: Kind::Mixed,
            seed: 1,
            duration_s: 60.0,
            rest_s: 1.0,
            range_rad: 1.0,
            speed_rad_s: 1.5,
            acceleration_rad_s2: 5.0,
            home_rad: None,
            series: None,
        }
    }
}

/// The shape of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Plateaus, sines and moves after each other: the default for identification.
    Mixed,
    /// Finite Fourier series.
    Fourier,
    /// Sines of random frequency, the paper's.
    RandomFrequency,
    /// Constant speeds from 0.005 to 1 rad/s in both directions.
    Plateaus,
    /// Random poses with rests.
    PointToPoint,
    /// A Fourier series with the coefficients of `[motion.series]`, as `armtwin excite` writes it.
    Series,
}

impl Kind {
    /// What draws the motion; `None` where its coefficients are given.
    fn fill(self) -> Option<fn(&mut Path, f64, &mut ChaCha8Rng)> {
        match self {
            Kind::Mixed => Some(mixed::mixed),
            Kind::Fourier => Some(waves::fourier),
            Kind::RandomFrequency => Some(waves::random_frequency),
            Kind::Plateaus => Some(plateaus::plateaus),
            Kind::PointToPoint => Some(point_to_point::point_to_point),
            Kind::Series => None,
        }
    }
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MotionError {
    #[error("motion.{key} = {value}: give a number {condition}")]
    Number { key: &'static str, value: f64, condition: &'static str },
    #[error("motion.home_rad has {given} angles, the robot has {joints} joints: give {joints}")]
    HomeLength { given: usize, joints: usize },
    #[error(
        "motion.home_rad: joint {joint} at {home} rad is not between its limits {lower} and \
         {upper} rad: choose a pose inside"
    )]
    HomeOutside { joint: usize, home: f64, lower: f64, upper: f64 },
    #[error("motion.kind = \"series\" needs its coefficients: give a table [motion.series]")]
    NoSeries,
    #[error(
        "motion.series: give sine_rad and cosine_rad as {joints} lists of finite numbers, one list \
         per joint, equally long in both"
    )]
    Coefficients { joints: usize },
    #[error("motion.series: {0}")]
    TooMuch(#[from] TooMuch),
    #[error(
        "motion.series: joint {joint} reaches {reached:.3} {what}, the robot's limit is {limit:.3}: \
         take smaller coefficients"
    )]
    Beyond { joint: usize, what: &'static str, reached: f64, limit: f64 },
}

impl Settings {
    /// The trajectory for this robot.
    ///
    /// # Errors
    /// If a setting is out of its range or the home pose does not fit the robot.
    pub fn trajectory(&self, robot: &Robot) -> Result<Trajectory, MotionError> {
        self.check()?;
        let envelope = Envelope::new(robot, self)?;
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut path = Path::from_centre(&envelope);
        path.rest_until(self.rest_s);
        let until = self.duration_s - self.rest_s;
        match (self.kind.fill(), &self.series) {
            (Some(fill), _) => fill(&mut path, until, &mut rng),
            (None, Some(series)) => series.fill(&mut path, until, robot)?,
            (None, None) => return Err(MotionError::NoSeries),
        }
        path.rest_until(self.duration_s);
        Ok(path.finish())
    }

    fn check(&self) -> Result<(), MotionError> {
        let must = |key, value, holds: bool, condition| {
            if holds { Ok(()) } else { Err(MotionError::Number { key, value, condition }) }
        };
        let (duration, rest) = (self.duration_s, self.rest_s);
        must("rest_s", rest, (0.0..=1e3).contains(&rest), "from 0 to 1000")?;
        let long_enough = duration >= 2.0 * rest + 2.0 && duration <= 1e5;
        must("duration_s", duration, long_enough, "from 2 s more than both rests to 100000")?;
        for (key, value) in [
            ("range_rad", self.range_rad),
            ("speed_rad_s", self.speed_rad_s),
            ("acceleration_rad_s2", self.acceleration_rad_s2),
        ] {
            must(key, value, value > 0.0 && value <= 1e3, "above 0 and up to 1000")?;
        }
        Ok(())
    }
}
