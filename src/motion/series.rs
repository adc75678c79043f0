//! A finite Fourier series with given coefficients: the motion that somebody designed.

use super::path::Path;
use super::peaks::peaks;
use super::trajectory::{Piece, Shape, Trajectory, Wave};
use super::{Envelope, MotionError, Sampled};
use crate::limits::SINES;
use crate::robot::Robot;

/// The `[motion.series]` table: q = home + window(t) sum over k of a_k sin(k w t) + b_k cos(k w t),
/// w = 2 pi / period (Swevers et al., IEEE Trans. Robotics and Automation 13(5), 1997, Eq. 3), t from
/// the end of the first rest. The window brings the arm to rest at both ends.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Series {
    /// Period of the first harmonic, s.
    pub period_s: f64,
    /// How long the window rises and falls, s.
    pub fade_s: f64,
    /// One list per joint, rad: a_1, a_2, ...
    pub sine_rad: Vec<Vec<f64>>,
    /// One list per joint, rad: b_1, b_2, ...
    pub cosine_rad: Vec<Vec<f64>>,
}

impl Series {
    /// Fills the time until `until`, around the centre.
    pub(super) fn fill(
        &self,
        path: &mut Path,
        until: f64,
        robot: &Robot,
    ) -> Result<(), MotionError> {
        let duration = until - path.now;
        self.check(robot.dof(), duration)?;
        let waves = self.sine_rad.iter().zip(&self.cosine_rad).map(|(a, b)| self.waves(a, b));
        let shape = Shape::Waves { waves: waves.collect(), fade: self.fade_s };
        let piece = Piece { duration, from: vec![0.0; robot.dof()], shape };
        within_limits(&piece, &path.here, robot)?;
        path.push(duration, piece.shape);
        Ok(())
    }

    /// The motion around the centre on a grid, whatever arm makes it and whatever its limits;
    /// `duration_s` counts both rests.
    pub fn around_centre(&self, rest_s: f64, duration_s: f64, dt: f64) -> Sampled {
        let zero = vec![0.0; self.sine_rad.len()];
        let [centre, range, velocity, acceleration] = [(); 4].map(|()| zero.clone());
        let envelope = Envelope { centre, range, velocity, acceleration };
        let mut path = Path::from_centre(&envelope);
        path.rest_until(rest_s);
        let waves = self.sine_rad.iter().zip(&self.cosine_rad).map(|(a, b)| self.waves(a, b));
        let shape = Shape::Waves { waves: waves.collect(), fade: self.fade_s };
        path.push(duration_s - 2.0 * rest_s, shape);
        path.rest_until(duration_s);
        let trajectory: Trajectory = path.finish();
        trajectory.sampled(dt)
    }

    /// Waves of one joint. a sin x + b cos x = |(a, b)| sin(x + atan2(b, a)).
    fn waves(&self, sine: &[f64], cosine: &[f64]) -> Vec<Wave> {
        let wave = |(k, (a, b)): (usize, (&f64, &f64))| Wave {
            amplitude: a.hypot(*b),
            frequency_hz: (k + 1) as f64 / self.period_s,
            phase: b.atan2(*a),
        };
        sine.iter().zip(cosine).enumerate().map(wave).collect()
    }

    fn check(&self, dof: usize, duration: f64) -> Result<(), MotionError> {
        let must = |key, value, holds: bool, condition| match holds {
            true => Ok(()),
            false => Err(MotionError::Number { key, value, condition }),
        };
        let (period, fade) = (self.period_s, self.fade_s);
        must("series.period_s", period, period > 0.0 && period <= 1e5, "above 0 and up to 100000")?;
        let fits = fade > 0.0 && 2.0 * fade <= duration;
        must("series.fade_s", fade, fits, "above 0 and up to half the time between the rests")?;
        let finite = |lists: &[Vec<f64>]| lists.iter().flatten().all(|x| x.is_finite());
        let (sine, cosine) = (&self.sine_rad, &self.cosine_rad);
        let paired = sine.iter().zip(cosine).all(|(a, b)| a.len() == b.len());
        let whole = sine.len() == dof && cosine.len() == dof && paired;
        let sines: usize = sine.iter().map(Vec::len).sum();
        SINES.allow((sines as f64 * duration) as u64)?;
        match whole && finite(sine) && finite(cosine) {
            true => Ok(()),
            false => Err(MotionError::Coefficients { joints: dof }),
        }
    }
}

/// The robot's own limits are never passed, whatever the coefficients are.
fn within_limits(piece: &Piece, centre: &[f64], robot: &Robot) -> Result<(), MotionError> {
    for (j, body) in robot.bodies.iter().enumerate() {
        let limits = &body.joint.limits;
        let room = (centre[j] - limits.lower).min(limits.upper - centre[j]);
        let [q, qd, _] = peaks(piece, j);
        let beyond =
            |what, reached, limit| MotionError::Beyond { joint: j + 1, what, reached, limit };
        if q > room {
            return Err(beyond("rad from home_rad", q, room));
        }
        if qd > limits.velocity {
            return Err(beyond("rad/s", qd, limits.velocity));
        }
    }
    Ok(())
}
