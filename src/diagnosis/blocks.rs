//! Block-bootstrap intervals of what is computed from sums over time.

use crate::statistics::{autocorrelation, block_bootstrap, block_length};

/// Of every interval of a diagnosis.
pub const LEVEL: f64 = 0.9;
const REPLICATIONS: usize = 400;
/// Residuals of arms go along with their motion for about a second (measured on UR10e logs), which
/// the correlation of neighbouring rows alone does not tell; s.
const SHORTEST_BLOCK_S: f64 = 1.0;

/// 90 % interval of `of(sum of a, sum of b)` over rows `dt` s apart, resampled in blocks.
pub fn interval(
    a: &[f64],
    b: &[f64],
    dt: f64,
    seed: u64,
    of: impl Fn(f64, f64) -> f64,
) -> [f64; 2] {
    let n = a.len();
    let rho = autocorrelation(a, 1)[1];
    let second = (SHORTEST_BLOCK_S / dt).ceil() as usize;
    let block = block_length(rho, n).max(second).clamp(1, (n / 3).max(1));
    block_bootstrap(n, block, REPLICATIONS, LEVEL, seed, |rows| {
        let sum = |x: &[f64]| rows.iter().map(|&k| x[k]).sum::<f64>();
        of(sum(a), sum(b))
    })
}
