//! How far, how fast and how hard each joint may move in a test.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::MotionError;
use super::settings::Settings;
use crate::robot::Robot;

/// Per joint, base to wrist.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// rad
    pub centre: Vec<f64>,
    /// Largest distance from the centre, rad.
    pub range: Vec<f64>,
    /// rad/s
    pub velocity: Vec<f64>,
    /// rad/s^2
    pub acceleration: Vec<f64>,
}

/// Kept between the trajectory and the robot's own limits, where a controller would stop.
const SHARE_OF_LIMIT: f64 = 0.95;

impl Envelope {
    /// What `settings` ask for, cut to what the robot's joint limits allow.
    ///
    /// # Errors
    /// If the home pose has the wrong length or lies at or beyond a joint limit.
    pub fn new(robot: &Robot, settings: &Settings) -> Result<Self, MotionError> {
        let centre = settings.home_rad.clone().unwrap_or_else(|| home(robot));
        if centre.len() != robot.dof() {
            return Err(MotionError::HomeLength { given: centre.len(), joints: robot.dof() });
        }
        let limits: Vec<_> = robot.bodies.iter().map(|b| b.joint.limits).collect();
        let mut range = Vec::with_capacity(centre.len());
        for (j, (&q, l)) in centre.iter().zip(&limits).enumerate() {
            let room = (q - l.lower).min(l.upper - q) * SHARE_OF_LIMIT;
            if room.is_nan() || room <= 0.0 {
                let (lower, upper) = (l.lower, l.upper);
                return Err(MotionError::HomeOutside { joint: j + 1, home: q, lower, upper });
            }
            range.push(room.min(settings.range_rad));
        }
        let velocity = limits.iter().map(|l| settings.speed_rad_s.min(SHARE_OF_LIMIT * l.velocity));
        Ok(Self {
            velocity: velocity.collect(),
            acceleration: vec![settings.acceleration_rad_s2; centre.len()],
            range,
            centre,
        })
    }

    /// A random pose at most `share` of the range away from the centre.
    pub(super) fn random_pose(&self, share: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let draw = |(c, r)| c + share * r * rng.random_range(-1.0..1.0);
        self.centre.iter().zip(&self.range).map(draw).collect()
    }
}

/// A pose to test around: UR arms bent above the table, other arms in the middle of their limits
/// (0 where a joint has none).
fn home(robot: &Robot) -> Vec<f64> {
    if robot.name.starts_with("ur") && robot.dof() == 6 {
        return vec![0.0, -1.75, 0.95, -0.8, -1.5, 0.0];
    }
    let middle = |l: &crate::robot::Limits| (l.lower + l.upper) / 2.0;
    let or_zero = |q: f64| if q.is_finite() { q } else { 0.0 };
    robot.bodies.iter().map(|b| or_zero(middle(&b.joint.limits))).collect()
}
