//! A motion of all joints: pieces one after the other, each a closed form in time.

use std::f64::consts::TAU;

use crate::series::JointSeries;

/// Joint position, velocity and acceleration as functions of time, from 0 to [`duration`].
/// The third derivative is continuous; the arm rests at both ends and before and after them.
///
/// [`duration`]: Trajectory::duration
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Never empty; each ends where and as (at rest) the next begins.
    pub(super) pieces: Vec<Piece>,
    /// Start time of each piece, s.
    pub(super) starts: Vec<f64>,
    pub(super) duration: f64,
}

/// A motion on a uniform grid: rad, rad/s, rad/s^2.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    pub q: JointSeries,
    pub qd: JointSeries,
    pub qdd: JointSeries,
}

impl Trajectory {
    /// s
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.pieces[0].from.len()
    }

    /// Position (rad), velocity (rad/s) and acceleration (rad/s^2) of all joints at time `t` (s).
    pub fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let t = t.clamp(0.0, self.duration);
        let i = self.starts.partition_point(|&s| s <= t).max(1) - 1;
        let piece = &self.pieces[i];
        let t = (t - self.starts[i]).min(piece.duration);
        for j in 0..self.dof() {
            [q[j], qd[j], qdd[j]] = piece.at(j, t);
        }
    }

    /// At 0, `dt`, 2 `dt`, ... up to the duration.
    pub fn sampled(&self, dt: f64) -> Sampled {
        let n = (self.duration / dt + 1e-9) as usize + 1;
        let zeros = || JointSeries::zeros(self.dof(), n);
        let mut out = Sampled { q: zeros(), qd: zeros(), qdd: zeros() };
        let mut now = vec![[0.0; 3]; self.dof()].concat();
        let (q, rest) = now.split_at_mut(self.dof());
        let (qd, qdd) = rest.split_at_mut(self.dof());
        for k in 0..n {
            self.at(k as f64 * dt, q, qd, qdd);
            out.q.set_sample(k, q);
            out.qd.set_sample(k, qd);
            out.qdd.set_sample(k, qdd);
        }
        out
    }
}

/// One stretch of motion that starts and ends at rest.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    /// s
    pub duration: f64,
    /// Pose at its start, rad.
    pub from: Vec<f64>,
    pub shape: Shape,
}

/// What is added to the start pose, joint by joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    /// To the pose `from + by` along [`step`]; a rest where `by` is zero.
    Move { by: Vec<f64> },
    /// A sum of sines per joint, faded in and out over `fade` seconds.
    Waves { waves: Vec<Vec<Wave>>, fade: f64 },
    /// Constant-speed strokes per joint, one after the other.
    Strokes { strokes: Vec<Vec<Stroke>> },
}

/// amplitude sin(2 pi frequency t + phase)
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wave {
    pub amplitude: f64,
    pub frequency_hz: f64,
    pub phase: f64,
}

/// From standstill to `speed` within `blend`, constant, and back to standstill within `blend`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke {
    pub start: f64,
    /// With both blends, s.
    pub duration: f64,
    pub blend: f64,
    /// Signed, rad/s.
    pub speed: f64,
    /// Where it begins, relative to the piece's start pose, rad.
    pub offset: f64,
}

impl Piece {
    /// Position, velocity, acceleration of joint `j` at `t` s after the start of the piece.
    pub fn at(&self, j: usize, t: f64) -> [f64; 3] {
        let [x, v, a] = match &self.shape {
            Shape::Move { by } => scaled(step(t / self.duration), by[j], self.duration),
            Shape::Waves { waves, fade } => faded(&waves[j], window(t, self.duration, *fade), t),
            Shape::Strokes { strokes } => {
                let i = strokes[j].partition_point(|s| s.start <= t).max(1) - 1;
                strokes[j][i].at(t)
            }
        };
        [self.from[j] + x, v, a]
    }
}

impl Stroke {
    /// Travelled between start and end, rad.
    pub fn length(&self) -> f64 {
        self.speed * (self.duration - self.blend)
    }

    /// Velocity = speed x quintic smooth step, so position has a continuous third derivative.
    fn at(&self, t: f64) -> [f64; 3] {
        let t = (t - self.start).clamp(0.0, self.duration);
        let left = self.duration - t;
        let [x, v, a] = if t < self.blend {
            self.blended(t)
        } else if left < self.blend {
            let [x, v, a] = self.blended(left);
            [self.length() - x, v, -a]
        } else {
            [self.speed * (t - self.blend / 2.0), self.speed, 0.0]
        };
        [self.offset + x, v, a]
    }

    fn blended(&self, t: f64) -> [f64; 3] {
        let u = t / self.blend;
        let x = u.powi(4) * (2.5 - 3.0 * u + u * u);
        let v = u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
        let a = 30.0 * u * u * (1.0 - u) * (1.0 - u);
        [self.speed * self.blend * x, self.speed * v, self.speed * a / self.blend]
    }
}

/// Largest first and second derivative of [`step`]: 35/16 and 84 sqrt(5)/25.
pub(super) const STEP_PEAK: [f64; 2] = [2.1875, 7.513_188_404_399_293];

/// The polynomial of degree 7 from 0 to 1 with three vanishing derivatives at both ends.
fn step(u: f64) -> [f64; 3] {
    let w = u * (1.0 - u);
    [
        u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3)),
        140.0 * w.powi(3),
        420.0 * w * w * (1.0 - 2.0 * u),
    ]
}

fn scaled([x, v, a]: [f64; 3], by: f64, duration: f64) -> [f64; 3] {
    [by * x, by * v / duration, by * a / (duration * duration)]
}

/// Rises from 0 to 1 over `fade` at the start and falls at the end, with derivatives.
pub(super) fn window(t: f64, duration: f64, fade: f64) -> [f64; 3] {
    let left = duration - t;
    if t < fade {
        scaled(step(t / fade), 1.0, fade)
    } else if left < fade {
        let [w, wd, wdd] = scaled(step(left / fade), 1.0, fade);
        [w, -wd, wdd]
    } else {
        [1.0, 0.0, 0.0]
    }
}

/// Window x sum of sines.
fn faded(waves: &[Wave], window: [f64; 3], t: f64) -> [f64; 3] {
    let [mut s, mut sd, mut sdd] = [0.0; 3];
    for wave in waves {
        let omega = TAU * wave.frequency_hz;
        let (sin, cos) = (omega * t + wave.phase).sin_cos();
        s += wave.amplitude * sin;
        sd += wave.amplitude * omega * cos;
        sdd -= wave.amplitude * omega * omega * sin;
    }
    product(window, [s, sd, sdd])
}

/// A product and its first two derivatives.
pub(super) fn product([w, wd, wdd]: [f64; 3], [s, sd, sdd]: [f64; 3]) -> [f64; 3] {
    [w * s, wd * s + w * sd, wdd * s + 2.0 * wd * sd + w * sdd]
}
