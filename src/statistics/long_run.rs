//! The variance of a sum of autocorrelated terms, and how well it is known.

use super::kernel::{Kernel, dot, first_order, weighted_lags, zero_filled};

/// Variance of a sum, and the degrees of freedom of that variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LongRun {
    pub variance: f64,
    /// Of the chi-square the variance estimate resembles: use Student's t with it.
    pub dof: f64,
}

/// Var(sum of `terms`) robust to autocorrelation and changing spread: AR(1) prewhitening, quadratic
/// spectral kernel, Andrews' automatic bandwidth (Andrews and Monahan, Econometrica 60(4), 1992).
/// `slots` are the terms' times; what lies between counts as zero.
pub fn long_run_variance(terms: &[f64], slots: &[usize]) -> LongRun {
    let x = zero_filled(terms, slots);
    let n = terms.len() as f64;
    let rho = first_order(&x);
    let mut white: Vec<f64> = x.windows(2).map(|w| w[1] - rho * w[0]).collect();
    white.insert(0, x[0]);
    white.push(-rho * x[x.len() - 1]);
    let kernel = Kernel::QuadraticSpectral;
    let bandwidth = kernel.andrews(first_order(&white), n);
    let variance = weighted_lags(&white, &white, kernel, bandwidth).max(0.0) / (1.0 - rho).powi(2);
    let by_kernel = bandwidth * kernel.square_integral() / n;
    let by_rho = 2.0 * (1.0 + rho).max(0.0) / (n * (1.0 - rho));
    let floor = dot(terms, terms) * f64::EPSILON;
    LongRun { variance: variance.max(floor), dof: 1.0 / (by_kernel + by_rho).max(1.0 / n) }
}
