//! Products with a symmetric Toeplitz matrix, and all autocovariances of a series, in n log n.
//!
//! The matrix is a corner of a circulant one of at least twice its size, which the Fourier transform diagonalises
//! (Golub and Van Loan, Matrix Computations, section 4.8).

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// Omega_ts = gamma_|t-s|, ready to be multiplied.
pub struct Toeplitz {
    /// Rows.
    n: usize,
    /// Eigenvalues of the circulant matrix over its size.
    eigenvalues: Vec<f64>,
    forward: Arc<dyn Fft<f64>>,
    back: Arc<dyn Fft<f64>>,
}

impl Toeplitz {
    /// Of `n` rows, the first of which begins with `gamma` and goes on with zeros.
    pub fn new(gamma: &[f64], n: usize) -> Self {
        let size = (2 * n).next_power_of_two();
        let mut planner = FftPlanner::new();
        let (forward, back) = (planner.plan_fft_forward(size), planner.plan_fft_inverse(size));
        let mut row = vec![Complex::default(); size];
        for (lag, g) in gamma.iter().enumerate().take(n) {
            row[lag].re = *g;
            row[(size - lag) % size].re = *g;
        }
        forward.process(&mut row);
        let eigenvalues = row.iter().map(|e| e.re / size as f64).collect();
        Self { n, eigenvalues, forward, back }
    }

    /// Omega q for every column, of n values each: two at a time, as real and imaginary part.
    pub fn times(&self, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        columns.chunks(2).flat_map(|pair| self.times_pair(pair)).collect()
    }

    fn times_pair(&self, pair: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut x = vec![Complex::default(); self.eigenvalues.len()];
        x.iter_mut().zip(&pair[0]).for_each(|(x, q)| x.re = *q);
        pair[1..].iter().for_each(|q| x.iter_mut().zip(q).for_each(|(x, q)| x.im = *q));
        self.forward.process(&mut x);
        x.iter_mut().zip(&self.eigenvalues).for_each(|(x, e)| *x *= *e);
        self.back.process(&mut x);
        let rows = &x[..self.n];
        let parts = [rows.iter().map(|x| x.re).collect(), rows.iter().map(|x| x.im).collect()];
        parts.into_iter().take(pair.len()).collect()
    }
}

/// sum_t x_t x_{t+l} for lags 0 to n - 1.
pub fn lagged_products(x: &[f64]) -> Vec<f64> {
    let size = (2 * x.len()).next_power_of_two();
    let mut planner = FftPlanner::new();
    let mut transform = vec![Complex::default(); size];
    transform.iter_mut().zip(x).for_each(|(t, x)| t.re = *x);
    planner.plan_fft_forward(size).process(&mut transform);
    let share = 1.0 / size as f64;
    transform.iter_mut().for_each(|t| *t = Complex::new(share * t.norm_sqr(), 0.0));
    planner.plan_fft_inverse(size).process(&mut transform);
    transform[..x.len()].iter().map(|t| t.re).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(n: usize, seed: f64) -> Vec<f64> {
        (0..n)
            .map(|k| (seed + 1.7 * k as f64).sin() + 0.3 * (0.11 * (k * k) as f64).cos())
            .collect()
    }

    #[test]
    fn products_are_those_of_the_whole_matrix() {
        for n in [1, 2, 7, 64, 100] {
            let gamma: Vec<f64> = (0..n).map(|l| 0.9f64.powi(l as i32)).collect();
            let columns: Vec<Vec<f64>> = (0..3).map(|i| series(n, i as f64)).collect();
            for (q, found) in
                columns.iter().zip(Toeplitz::new(&gamma[..n.min(40)], n).times(&columns))
            {
                for (t, found) in found.iter().enumerate() {
                    let wanted: f64 = (0..n)
                        .filter(|s| t.abs_diff(*s) < 40)
                        .map(|s| gamma[t.abs_diff(s)] * q[s])
                        .sum();
                    assert!((found - wanted).abs() < 1e-11, "{n} {t}: {found} {wanted}");
                }
            }
        }
    }

    #[test]
    fn lagged_products_are_sums_over_pairs() {
        for n in [1, 2, 7, 64, 100] {
            let x = series(n, 0.4);
            for (lag, found) in lagged_products(&x).into_iter().enumerate() {
                let wanted: f64 = x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum();
                assert!((found - wanted).abs() < 1e-11, "{n} {lag}: {found} {wanted}");
            }
        }
    }
}
