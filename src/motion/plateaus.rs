//! Constant-speed strokes, there and back, at a ladder of speeds: friction over speed in its
//! purest form (no acceleration, every place passed in both directions).

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::path::Path;
use super::trajectory::{Shape, Stroke};

/// Speeds equally spaced in the logarithm, rad/s; the envelope may cut the top.
#[derive(Clone, Copy)]
pub(super) struct Ladder {
    slowest: f64,
    fastest: f64,
    levels: usize,
}

/// From creeping to brisk.
const WHOLE: Ladder = Ladder { slowest: 0.005, fastest: 1.0, levels: 9 };
/// Around usual Stribeck velocities (0.01 to 0.15 rad/s), where sines spend little time.
const SLOW: Ladder = Ladder { slowest: 0.01, fastest: 0.3, levels: 7 };
const SHORTEST_BLEND_S: f64 = 0.15;
/// Largest slope of the quintic smooth step.
const BLEND_PEAK: f64 = 1.875;
/// Shortest time for a ladder, s.
const MIN_S: f64 = 5.0;

pub(super) fn plateaus(path: &mut Path, until: f64, rng: &mut ChaCha8Rng) {
    climb(path, until, rng, WHOLE);
}

pub(super) fn slow_plateaus(path: &mut Path, until: f64, rng: &mut ChaCha8Rng) {
    climb(path, until, rng, SLOW);
}

/// Fills the time with one ladder per joint, from a random pose. The joints climb in
/// different orders and change direction at different times.
fn climb(path: &mut Path, until: f64, rng: &mut ChaCha8Rng, ladder: Ladder) {
    let pose = path.envelope.random_pose(0.5, rng);
    if !path.go(pose, 0.7, until - MIN_S) {
        return path.rest_until(until);
    }
    let duration = until - path.now;
    let strokes = (0..path.here.len()).map(|j| rungs(path, j, duration, rng, ladder)).collect();
    path.push(duration, Shape::Strokes { strokes });
}

/// Strokes of joint `j`: the speeds in random order, each for an about equal share of the time.
fn rungs(
    path: &Path,
    j: usize,
    duration: f64,
    rng: &mut ChaCha8Rng,
    ladder: Ladder,
) -> Vec<Stroke> {
    let e = path.envelope;
    let mut speeds = ladder.speeds(e.velocity[j]);
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

impl Ladder {
    fn speeds(self, limit: f64) -> Vec<f64> {
        let top = self.fastest.min(limit);
        let ratio = (top / self.slowest).max(1.0).powf(1.0 / (self.levels - 1) as f64);
        (0..self.levels).map(|i| top / ratio.powi(i as i32)).collect()
    }
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
        let pairs = (self.speed.abs() * self.duration / 2.0 / self.room).ceil();
        // Where there is hardly any room, slower strokes and not ever more of them.
        let pairs = pairs.min(self.duration / 4.0 / SHORTEST_BLEND_S).max(1.0).floor();
        let duration = self.duration / (2.0 * pairs);
        let blend = (BLEND_PEAK * self.speed.abs() / acceleration).max(SHORTEST_BLEND_S);
        let blend = blend.min(duration / 2.0);
        // Too short for the full speed: what can be reached with the whole stroke as blends.
        let reached = self.speed.abs().min(acceleration * duration / 2.0 / BLEND_PEAK);
        let speed = reached.min(self.room / (duration - blend)).copysign(self.speed);
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
