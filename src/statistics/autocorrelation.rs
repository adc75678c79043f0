//! How a residual depends on its own past.

use statrs::function::gamma::gamma_ur;

use super::toeplitz::lagged_products;

/// r_l for lags 0 to `lags`, about the mean, biased (divided by n): Brockwell and Davis, Time
/// Series: Theory and Methods, section 7.2. All zero but r_0 for a constant series.
pub fn autocorrelation(x: &[f64], lags: usize) -> Vec<f64> {
    let n = x.len();
    let mean = x.iter().sum::<f64>() / n.max(1) as f64;
    let products = lagged_products(&x.iter().map(|v| v - mean).collect::<Vec<f64>>());
    let at = |l: usize| match (l, products.first()) {
        (0, _) => 1.0,
        (_, Some(power)) if *power > 0.0 && l < n => products[l] / power,
        _ => 0.0,
    };
    (0..=lags).map(at).collect()
}

/// n / (1 + 2 sum r_l): how many independent samples have a mean as uncertain as these. Summed over
/// adjacent pairs while they are positive and falling (Geyer, "Practical Markov chain Monte Carlo",
/// Statistical Science 7(4), 1992, section 3.3). Between 1 and n.
pub fn effective_samples(x: &[f64]) -> f64 {
    let n = x.len();
    if n < 4 {
        return n as f64;
    }
    let r = autocorrelation(x, n - 1);
    let (mut sum, mut least) = (0.0, f64::INFINITY);
    for pair in r.chunks_exact(2) {
        least = least.min(pair[0] + pair[1]);
        if least <= 0.0 {
            break;
        }
        sum += least;
    }
    (n as f64 / (2.0 * sum - 1.0).max(1.0)).max(1.0)
}

/// Are the autocorrelations up to some lag jointly zero?
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LjungBox {
    pub lags: usize,
    pub statistic: f64,
    pub p: f64,
}

/// Q = n (n + 2) sum r_l^2 / (n - l), chi-square with `lags` - `fitted` degrees of freedom under
/// whiteness. Ljung and Box, Biometrika 65(2), 1978.
pub fn ljung_box(x: &[f64], lags: usize, fitted: usize) -> LjungBox {
    let n = x.len() as f64;
    let lags = lags.min(x.len().saturating_sub(2));
    let r = autocorrelation(x, lags);
    let term = |l: usize| r[l] * r[l] / (n - l as f64);
    let statistic = n * (n + 2.0) * (1..=lags).map(term).sum::<f64>();
    let dof = lags.saturating_sub(fitted).max(1) as f64;
    let p = if statistic > 0.0 { gamma_ur(0.5 * dof, 0.5 * statistic) } else { 1.0 };
    LjungBox { lags, statistic, p }
}
