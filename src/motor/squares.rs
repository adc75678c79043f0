//! The squared output error, summed while a motor is simulated, and no further than needed.

use super::consumer::Consumer;
use super::dormand_prince::Dense;
use super::scenario::Channel;
use super::simulate::{CURRENT, OMEGA, Output};
use crate::kernels::{SQUARES, add_squares_about_quartic};

/// Sum of r^2 over the samples so far, r in units of the noise.
pub struct Squares<'a> {
    measured: &'a Output,
    /// 1 / sigma^2 of current and speed, zero where not measured.
    weight: [f64; 2],
    /// Sums of squared errors of current and speed, squared units, each in parts.
    sums: [[f64; SQUARES]; 2],
    next: usize,
    limit: f64,
}

impl<'a> Squares<'a> {
    /// Has enough once the total is over `limit`.
    pub fn new<'b>(
        measured: &'a Output,
        channels: impl Iterator<Item = (&'b Channel, &'b f64)>,
        limit: f64,
    ) -> Self {
        let mut weight = [0.0; 2];
        for (channel, sigma) in channels {
            let n = if *channel == Channel::Omega { OMEGA } else { CURRENT };
            weight[n] = 1.0 / (sigma * sigma);
        }
        Self { measured, weight, sums: [[0.0; SQUARES]; 2], next: 0, limit }
    }

    pub fn total(&self) -> f64 {
        [CURRENT, OMEGA].map(|n| self.weight[n] * self.sums[n].iter().sum::<f64>()).iter().sum()
    }

    fn signal(&self, n: usize) -> &'a [f64] {
        if n == OMEGA { &self.measured.omega } else { &self.measured.current }
    }
}

impl Consumer<2> for Squares<'_> {
    fn take(&mut self, y: &[f64; 2]) {
        for n in [CURRENT, OMEGA] {
            self.sums[n][0] += (y[n] - self.signal(n)[self.next]).powi(2);
        }
        self.next += 1;
    }

    #[inline]
    fn take_all(&mut self, step: &Dense<2>, first: f64, spacing: f64, count: usize) {
        for n in [CURRENT, OMEGA].into_iter().filter(|&n| self.weight[n] > 0.0) {
            let measured = &self.signal(n)[self.next..self.next + count];
            let p = step.powers(n);
            add_squares_about_quartic(&p, first, spacing, measured, &mut self.sums[n]);
        }
        self.next += count;
    }

    fn has_enough(&self) -> bool {
        self.total() > self.limit
    }
}
