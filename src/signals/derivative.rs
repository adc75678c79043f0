//! Differences of equidistant samples.

/// Fornberg, "Generation of finite difference formulas on arbitrarily spaced grids", Mathematics
/// of Computation 51, 1988, Table 1: first derivative, weights of offsets 1 to 4 (odd).
const FIRST: [&[f64]; 4] = [
    &[1.0 / 2.0],
    &[2.0 / 3.0, -1.0 / 12.0],
    &[3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0],
    &[4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0],
];

/// Second derivative from that table: weight of offset 0, then of offsets 1 to 4 (even).
const SECOND: [(f64, &[f64]); 4] = [
    (-2.0, &[1.0]),
    (-5.0 / 2.0, &[4.0 / 3.0, -1.0 / 12.0]),
    (-49.0 / 18.0, &[3.0 / 2.0, -3.0 / 20.0, 1.0 / 90.0]),
    (-205.0 / 72.0, &[8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0]),
];

/// dx/dt by central differences of eighth order: a sinusoid of angular frequency w comes out
/// (w dt)^8/630 too small. Order drops towards the ends; the end samples are one-sided.
pub fn central_difference(x: &[f64], dt: f64) -> Vec<f64> {
    differences(x, |k, reach| {
        let odd = |(i, w): (usize, &f64)| w * (x[k + i + 1] - x[k - i - 1]);
        FIRST[reach - 1].iter().enumerate().map(odd).sum::<f64>() / dt
    })
}

/// d2x/dt2 by central differences of eighth order: relative error (w dt)^8/3150.
pub fn second_difference(x: &[f64], dt: f64) -> Vec<f64> {
    differences(x, |k, reach| {
        let (middle, weights) = SECOND[reach - 1];
        let even = |(i, w): (usize, &f64)| w * (x[k + i + 1] + x[k - i - 1]);
        (middle * x[k] + weights.iter().enumerate().map(even).sum::<f64>()) / (dt * dt)
    })
}

/// Mean of forward and backward difference, (x[k+1] - x[k-1]) / (2 dt): the paper's acceleration
/// from measured velocity. One-sided at the ends.
pub fn mean_difference(x: &[f64], dt: f64) -> Vec<f64> {
    let n = x.len();
    let slope = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(n - 1));
        (x[b] - x[a]) / ((b - a).max(1) as f64 * dt)
    };
    (0..n).map(slope).collect()
}

/// `stencil(k, reach)` wherever `reach` samples (at most 4) lie on both sides of k; the end
/// samples copy their neighbour.
fn differences(x: &[f64], stencil: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let n = x.len();
    if n < 3 {
        return vec![0.0; n];
    }
    let at = |k: usize| {
        let k = k.clamp(1, n - 2);
        stencil(k, k.min(n - 1 - k).min(FIRST.len()))
    };
    (0..n).map(at).collect()
}
