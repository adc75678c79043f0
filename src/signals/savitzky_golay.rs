//! Savitzky-Golay smoothing and differentiation.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

/// Least-squares polynomial over a sliding window; its value and derivatives at the middle.
/// Savitzky and Golay, Analytical Chemistry 36(8), 1964.
#[derive(Debug, Clone, PartialEq)]
pub struct SavitzkyGolay {
    half: usize,
    degree: usize,
    dt: f64,
}

impl SavitzkyGolay {
    /// Window of 2 `half` + 1 samples, `dt` s apart; `half` is raised to what `degree` needs.
    pub fn new(half: usize, degree: usize, dt: f64) -> Self {
        Self { half: half.max(degree.div_ceil(2)), degree, dt }
    }

    /// The window whose smoothing has its -3 dB point at `cutoff_hz`. Schafer, "What is a
    /// Savitzky-Golay filter?", IEEE Signal Processing Magazine 28(4), 2011, Eq. 12, gives
    /// M = ((N + 1) f_s / (2 f_c) + 4.6) / 3.2 for half-width M and degree N; the exact gain
    /// decides around it.
    pub fn with_cutoff(cutoff_hz: f64, rate_hz: f64, degree: usize) -> Self {
        let relative = cutoff_hz / rate_hz;
        let estimate = ((degree + 1) as f64 / (2.0 * relative) + 4.6) / 3.2;
        let (mut wide, mut narrow) = ((1.5 * estimate) as usize + 1, degree.div_ceil(2));
        while wide - narrow > 1 {
            let half = usize::midpoint(wide, narrow);
            match gain(half, degree, relative) > 0.5f64.sqrt() {
                true => narrow = half,
                false => wide = half,
            }
        }
        Self::new(wide, degree, 1.0 / rate_hz)
    }

    /// Samples on either side of the middle.
    pub fn half(&self) -> usize {
        self.half
    }

    /// The `order`-th derivative of `x` (0: smoothed). Near the ends the polynomial of the first
    /// or last full window is evaluated off its middle; signals shorter than a window use a
    /// window of their own length.
    pub fn apply(&self, x: &[f64], order: usize) -> Vec<f64> {
        let half = self.half.min(x.len().saturating_sub(1) / 2);
        let degree = self.degree.min(2 * half);
        let fit = pseudo_inverse(half, degree);
        let at = |k: usize| {
            let middle = k.clamp(half, x.len() - 1 - half);
            let window = DVector::from_column_slice(&x[middle - half..=middle + half]);
            let offset = k as f64 - middle as f64;
            weights(degree, order, offset).dot(&(&fit * window)) / self.dt.powi(order as i32)
        };
        let ends = |k: usize| k < half || k + half >= x.len();
        let row = fit.transpose() * weights(degree, order, 0.0) / self.dt.powi(order as i32);
        let inside = |k: usize| {
            let window = &x[k - half..=k + half];
            window.iter().zip(row.iter()).map(|(x, w)| x * w).sum()
        };
        (0..x.len()).map(|k| if ends(k) { at(k) } else { inside(k) }).collect()
    }
}

/// Gain of smoothing at `relative` = frequency over sample rate: the weights are even.
fn gain(half: usize, degree: usize, relative: f64) -> f64 {
    let row = pseudo_inverse(half, degree).row(0).clone_owned();
    let cosine = |i: usize| (TAU * relative * (i as f64 - half as f64)).cos();
    row.iter().enumerate().map(|(i, w)| w * cosine(i)).sum()
}

/// (A^T A)^-1 A^T with A[i][p] = i^p for i = -half .. half.
fn pseudo_inverse(half: usize, degree: usize) -> DMatrix<f64> {
    let scale = half.max(1) as f64;
    let a = DMatrix::from_fn(2 * half + 1, degree + 1, |i, p| {
        ((i as f64 - half as f64) / scale).powi(p as i32)
    });
    let qr = a.qr();
    let q_t = qr.q().transpose();
    let mut fit = qr.r().solve_upper_triangular(&q_t).unwrap_or(q_t);
    for (p, mut row) in fit.row_iter_mut().enumerate() {
        row /= scale.powi(p as i32);
    }
    fit
}

/// d^order/du^order of [1, u, u^2, ...] at u = `offset`, in samples.
fn weights(degree: usize, order: usize, offset: f64) -> DVector<f64> {
    DVector::from_fn(degree + 1, |p, _| {
        if p < order {
            return 0.0;
        }
        let falling: f64 = (p - order + 1..=p).map(|f| f as f64).product();
        falling * offset.powi((p - order) as i32)
    })
}
