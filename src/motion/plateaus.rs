//! Constant-speed strokes, there and back, at a ladder of speeds: friction over speed in its
//! purest form (no acceleration, every place passed in both directions).

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::path::Path;
use super::trajectory::{Shape, Stroke};

/// rad/s; the top of the ladder is what the envelope allows, at most 1 rad/s.
const SLOWEST: f64 = 0.005;
const TOP: f64 = 1.0;
/// Speeds on the ladder, equally spaced in the logarithm.
const LEVELS: usize = 9;
const SHORTEST_BLEND_S: f64 = 0.15;
/// Largest slope of the quintic smooth step.
const BLEND_PEAK: f64 = 1.875;
/// Shortest time for a ladder, s.
const MIN_S: f64 = 5.0;

/// Fills the time with one ladder per joint, from a random pose. The joints climb in
/// different orders and change direction at different times.
pub(super) fn plateaus(path: &mut Path, until: f64, rng: &mut ChaCha8Rng) {
    let pose = path.envelope.random_pose(0.5, rng);
    if !path.go(pose, 0.7, until - MIN_S) {
        return path.rest_until(until);
    }
    let duration = until - path.now;
    let strokes = (0..path.here.len()).map(|j| ladder(path, j, duration, rng)).collect();
    path.push(duration, Shape::Strokes { strokes });
}

/// Strokes of joint `j`: the speeds in random order, each for an about equal share of the time.
fn ladder(path: &Path, j: usize, duration: f64, rng: &mut ChaCha8Rng) -> Vec<Stroke> {
    let e = path.envelope;
    let top = e.velocity[j].min(TOP);
    let ratio = (top / SLOWEST).max(1.0).powf(1.0 / (LEVELS - 1) as f64);
    let mut speeds: Vec<f64> = (0..LEVELS).map(|i| top / ratio.powi(i as i32)).collect();
    speeds.shuffle(rng);
    let shares: Vec<f64> = speeds.iter().map(|_| rng.random_range(0.8..1.2)).collect();
    let unit = duration / shares.iter().sum::<f64>();

    let offset = path.here[j] - e.centre[j];
    let mut strokes = Vec::new();
    let mut start = 0.0;
    for (speed, share) in speeds.into_iter().zip(shares) {
        let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let room = e.range[j] - sign * offset;
        let pass = Passes { start, duration: share * unit, speed: sign * speed, room };
        strokes.extend(pass.strokes(e.acceleration[j]));
        start += share * unit;
    }
    strokes
}

/// There and back at one speed, as often as the room demands.
struct Passes {
    start: f64,
    duration: f64,
    speed: f64,
    /// Longest stroke, rad.
    room: f64,
}

impl Passes {
    fn strokes(&self, acceleration: f64) -> Vec<Stroke> {
        let pairs = (self.speed.abs() * self.duration / 2.0 / self.room).ceil().max(1.0);
        let duration = self.duration / (2.0 * pairs);
        let blend = (BLEND_PEAK * self.speed.abs() / acceleration).max(SHORTEST_BLEND_S);
        // Too short for the full speed: what can be reached with the whole stroke as blends.
        let reached = self.speed.abs().min(acceleration * duration / 2.0 / BLEND_PEAK);
        let speed = reached.copysign(self.speed);
        let blend = blend.min(duration / 2.0);
        let there = Stroke { start: self.start, duration, blend, speed, offset: 0.0 };
        (0..2 * pairs as usize)
            .map(|i| {
                let start = self.start + i as f64 * duration;
                match i % 2 {
                    0 => Stroke { start, ..there },
                    _ => Stroke { start, speed: -speed, offset: there.length(), ..there },
                }
            })
            .collect()
    }
}
