//! Largest values of a sum of sines on a fine grid: only what can hold the largest is looked at.

use std::f64::consts::TAU;
use std::ops::Range;

use super::trajectory::{Piece, STEP_PEAK, Shape, Wave, product, window};

/// Between points of the grid, s.
const GRID_S: f64 = 0.005;
/// The fastest wave turns by so much between points that are tried, rad: between them the sum is larger
/// by 3 % of its waves' amplitudes at most.
const TURN: f64 = 0.5;
/// Points of the grid that are passed at a time, at most.
const MOST: usize = 1000;
/// Rounding of rotated waves, relative; they are rotated some million times.
const ROUNDING: f64 = 1e-9;

/// Largest absolute position, velocity and acceleration of a joint on a 5 ms grid, in a piece of waves around
/// zero.
pub(super) fn peaks(piece: &Piece, joint: usize) -> [f64; 3] {
    let last = (piece.duration / GRID_S) as usize;
    let mut peaks = Peaks { piece, joint, largest: [0.0; 3], least: [0.0; 3] };
    match &piece.shape {
        Shape::Waves { waves, fade } if stride(&waves[joint]) > 1 => {
            let (waves, stride) = (&waves[joint], stride(&waves[joint]));
            // Between these the waves are whole.
            let whole = ((fade / GRID_S).ceil() as usize).min(last);
            let until = (((piece.duration - fade) / GRID_S).floor() as usize).clamp(whole, last);
            peaks.sift(waves, *fade, whole..until, stride);
            peaks.each(waves, *fade, 0..whole);
            peaks.each(waves, *fade, until..last + 1);
        }
        _ => peaks.look(0..last + 1),
    }
    peaks.largest
}

/// Points of the grid that are passed at a time; one where waves are too fast for that.
fn stride(waves: &[Wave]) -> usize {
    let fastest = waves.iter().map(|w| w.frequency_hz).fold(0.0, f64::max);
    ((TURN / (TAU * fastest) / GRID_S) as usize).clamp(1, MOST)
}

/// What was looked at so far.
struct Peaks<'a> {
    piece: &'a Piece,
    joint: usize,
    largest: [f64; 3],
    /// What the largest are at least, as rotated waves say.
    least: [f64; 3],
}

impl Peaks<'_> {
    fn look(&mut self, points: Range<usize>) {
        for k in points {
            let now = self.piece.at(self.joint, k as f64 * GRID_S);
            self.largest = std::array::from_fn(|i| self.largest[i].max(now[i].abs()));
        }
    }

    /// At a point of the grid these are about the values.
    fn raise(&mut self, about: [f64; 3], rounding: [f64; 3]) {
        self.least = std::array::from_fn(|i| self.least[i].max(about[i].abs() - rounding[i]));
    }

    /// Can nothing up to these bounds be the largest? A bound that is no number says nothing.
    fn covers(&self, bounds: [f64; 3]) -> bool {
        (0..3).all(|i| bounds[i] <= self.largest[i].max(self.least[i]))
    }

    /// Looks at the points of whole waves between which a sum may be the largest: it is above its values at
    /// both ends by h^2 / 8 times its largest second derivative at most.
    fn sift(&mut self, waves: &[Wave], fade: f64, points: Range<usize>, stride: usize) {
        let step = stride as f64 * GRID_S;
        let sizes: [f64; 5] = std::array::from_fn(|i| size(waves, i as i32));
        let rounding: [f64; 3] = std::array::from_fn(|i| ROUNDING * sizes[i]);
        let above = |i: usize| step * step / 8.0 * sizes[i + 2] + rounding[i];
        let start = Turning::new(waves, points.start as f64 * GRID_S, step);
        let mut turning = start.clone();
        for _ in points.clone().step_by(stride) {
            self.raise(turning.sums(), rounding);
            turning.turn();
        }
        turning = start;
        let mut here = turning.sums();
        for from in points.clone().step_by(stride) {
            turning.turn();
            let next = turning.sums();
            let bounds = std::array::from_fn(|i| here[i].abs().max(next[i].abs()) + above(i));
            if !self.covers(bounds) {
                self.each(waves, fade, from..(from + stride).min(points.end));
            }
            here = next;
        }
    }

    /// Looks at those points at which rotated waves may be the largest.
    fn each(&mut self, waves: &[Wave], fade: f64, points: Range<usize>) {
        let steepest = [1.0, STEP_PEAK[0] / fade, STEP_PEAK[1] / (fade * fade)];
        let sizes = std::array::from_fn(|i| size(waves, i as i32));
        let rounding = product(steepest, sizes).map(|size| ROUNDING * size);
        let mut turning = Turning::new(waves, points.start as f64 * GRID_S, GRID_S);
        let about = points.clone().map(|k| {
            let window = window(k as f64 * GRID_S, self.piece.duration, fade);
            let about = product(window, turning.sums()).map(f64::abs);
            turning.turn();
            about
        });
        let about: Vec<[f64; 3]> = about.collect();
        about.iter().for_each(|about| self.raise(*about, rounding));
        for (k, about) in points.zip(about) {
            if !self.covers(std::array::from_fn(|i| about[i] + rounding[i])) {
                self.look(k..k + 1);
            }
        }
    }
}

/// What the derivative of this order of a sum can be at most.
fn size(waves: &[Wave], order: i32) -> f64 {
    let one = |w: &Wave| w.amplitude.abs() * (TAU * w.frequency_hz).abs().powi(order);
    waves.iter().map(one).sum()
}

/// Waves that are turned on by the same step again and again, which costs less than a sine each time.
#[derive(Clone)]
struct Turning {
    /// Amplitude times sine and cosine of the phase at the moment.
    now: Vec<[f64; 2]>,
    /// Sine and cosine of what a step turns by.
    by: Vec<[f64; 2]>,
    omega: Vec<f64>,
}

impl Turning {
    fn new(waves: &[Wave], start: f64, step: f64) -> Self {
        let at = |w: &Wave| <[f64; 2]>::from((TAU * w.frequency_hz * start + w.phase).sin_cos());
        Self {
            now: waves.iter().map(|w| at(w).map(|x| w.amplitude * x)).collect(),
            by: waves.iter().map(|w| (TAU * w.frequency_hz * step).sin_cos().into()).collect(),
            omega: waves.iter().map(|w| TAU * w.frequency_hz).collect(),
        }
    }

    fn turn(&mut self) {
        for ([s, c], [ds, dc]) in self.now.iter_mut().zip(&self.by) {
            (*s, *c) = (*s * dc + *c * ds, *c * dc - *s * ds);
        }
    }

    /// The sum and its first two derivatives.
    fn sums(&self) -> [f64; 3] {
        self.now
            .iter()
            .zip(&self.omega)
            .fold([0.0; 3], |[q, v, a], ([s, c], w)| [q + s, v + w * c, a - w * w * s])
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn drawn(seed: u64, duration: f64, fade: f64) -> Piece {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let wave = |rng: &mut ChaCha8Rng| {
            let frequency_hz = 0.05 * 24_f64.powf(rng.random_range(0.0..1.0));
            let amplitude = rng.random_range(0.3..1.0) / frequency_hz;
            Wave { amplitude, frequency_hz, phase: rng.random_range(0.0..TAU) }
        };
        let waves = vec![(0..10).map(|_| wave(&mut rng)).collect()];
        Piece { duration, from: vec![0.0], shape: Shape::Waves { waves, fade } }
    }

    /// To the last bit: motions of a seed are what they were.
    #[test]
    fn nothing_large_is_passed_over() {
        for (seed, duration, fade) in (0..40).map(|k| (k, [14.0, 3.0, 61.7][k as usize % 3], 0.7)) {
            let piece = drawn(seed, duration, fade);
            let mut all = Peaks { piece: &piece, joint: 0, largest: [0.0; 3], least: [0.0; 3] };
            all.look(0..(duration / GRID_S) as usize + 1);
            assert_eq!(peaks(&piece, 0), all.largest, "seed {seed}");
        }
    }

    /// A motion of a day is planned in no time.
    #[test]
    fn waves_that_are_turned_on_for_long_are_still_where_they_belong() {
        let piece = drawn(1, 86_400.0, 2.0);
        let Shape::Waves { waves, .. } = &piece.shape else { unreachable!() };
        let step = 0.05;
        let mut turning = Turning::new(&waves[0], 0.0, step);
        (0..1_000_000).for_each(|_| turning.turn());
        let there = Turning::new(&waves[0], 1e6 * step, step);
        for (i, (a, b)) in turning.sums().into_iter().zip(there.sums()).enumerate() {
            assert!((a - b).abs() < ROUNDING * size(&waves[0], i as i32), "{a} {b}");
        }
    }
}
