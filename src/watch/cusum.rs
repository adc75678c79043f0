//! Cumulative sums of standard normal numbers, and how long they run until a false alarm.
//!
//! S_n = max(0, S_{n-1} + z_n - k) is an alarm when S_n > h (Page, Biometrika 41, 1954). The mean number
//! of steps until then, the average run length, is that of a Markov chain over slices of [0, h] (Brook
//! and Evans, "An approach to the probability distribution of CUSUM run length", Biometrika 59, 1972).

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Normal};

/// Half the shift that is looked for, in standard deviations of a block.
pub const REFERENCE: f64 = 0.5;
/// Slices of [0, h].
const SLICES: usize = 80;

/// One side of a chart.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cusum {
    pub sum: f64,
    /// When the sum left zero last, s: since when the change lasts.
    pub since: f64,
}

impl Cusum {
    /// Takes a number of the block that began at `begins`, s; whether the sum is above `limit`.
    pub fn add(&mut self, z: f64, begins: f64, limit: f64) -> bool {
        if self.sum == 0.0 {
            self.since = begins;
        }
        self.sum = (self.sum + z - REFERENCE).max(0.0);
        self.sum > limit
    }
}

/// Average run length of one side with the limit `h`, steps.
pub fn run_length(h: f64) -> f64 {
    let Ok(normal) = Normal::new(0.0, 1.0) else { return 0.0 };
    let width = h / (SLICES as f64 - 0.5);
    // Slice 0 is half a slice around zero; the others are centred on multiples of the width.
    let stays = DMatrix::from_fn(SLICES, SLICES, |from, to| {
        let step = (to as f64 - from as f64) * width + REFERENCE;
        let above = normal.cdf(step + 0.5 * width);
        let below = if to == 0 { 0.0 } else { normal.cdf(step - 0.5 * width) };
        above - below
    });
    let leaves = DMatrix::identity(SLICES, SLICES) - stays;
    let ones = DVector::from_element(SLICES, 1.0);
    leaves.lu().solve(&ones).map_or(f64::INFINITY, |runs| runs[0])
}

/// The limit with which one side runs for `steps` on average.
pub fn threshold(steps: f64) -> f64 {
    let (mut low, mut high) = (0.1, 25.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if run_length(middle) < steps { low = middle } else { high = middle }
    }
    high
}
