//! Block-bootstrap intervals of what is computed from sums over time.

use crate::statistics::{autocorrelation, block_bootstrap, block_length};

/// Confidence level of every interval of a diagnosis.
pub const LEVEL: f64 = 0.9;
const REPLICATIONS: usize = 400;
/// Residuals of arms go along with their motion for about a second (measured on UR10e logs), which
/// the correlation of neighbouring rows alone does not tell; s.
const SHORTEST_BLOCK_S: f64 = 1.0;

/// Rows are summed over as long before they are resampled, s.
const BIN_S: f64 = 0.1;

/// 90 % interval of `of(sum of a, sum of b)` over rows `dt` s apart, resampled in blocks. Of so `many` that are looked at
/// all hold together with that probability at least (Bonferroni); 1 for one alone.
pub fn interval(
    many: usize,
    [a, b]: [&[f64]; 2],
    dt: f64,
    seed: u64,
    of: impl Fn(f64, f64) -> f64,
) -> [f64; 2] {
    let level = 1.0 - (1.0 - LEVEL) / many as f64;
    let per_bin = ((BIN_S / dt) as usize).max(1);
    let binned = |x: &[f64]| x.chunks(per_bin).map(|c| c.iter().sum()).collect::<Vec<f64>>();
    let (a, b) = (binned(a), binned(b));
    let n = a.len();
    let rho = autocorrelation(&a, 1)[1];
    let second = (SHORTEST_BLOCK_S / (dt * per_bin as f64)).ceil() as usize;
    let block = block_length(rho, n).max(second).clamp(1, (n / 3).max(1));
    // As many lie beyond each end as of one alone.
    block_bootstrap([&a, &b], block, REPLICATIONS * many, level, seed, |[a, b]| of(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that shrink by a tenth on the mean, by another share each second.
    #[test]
    fn one_among_many_has_to_be_surer() {
        let of = |k: usize| 1.0 + 0.3 * ((k / 100) as f64 * 2.4).sin();
        let before: Vec<f64> = (0..3000).map(|_| 1.0).collect();
        let after: Vec<f64> = (0..3000).map(|k| 0.9 * of(k)).collect();
        let share = |b: f64, a: f64| 1.0 - a / b;
        let [alone, among] = [1, 50].map(|many| interval(many, [&before, &after], 0.01, 1, share));
        assert!(among[0] < alone[0] && alone[1] < among[1], "{alone:?} {among:?}");
    }
}
