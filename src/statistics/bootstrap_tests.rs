//! Golden numbers from arch (`tests/golden/bootstrap.py`).

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Deserialize;

use super::*;
use crate::statistics::autocorrelation;

#[derive(Deserialize)]
struct Golden {
    series: Vec<f64>,
    block: usize,
    /// level, low, high
    intervals: Vec<[f64; 3]>,
    /// Correlation of neighbours, rows, rows per block.
    block_lengths: Vec<[f64; 3]>,
    coverage_series: usize,
    /// rho, rows, level, share that holds the truth
    coverage: Vec<[f64; 4]>,
}

fn golden() -> Golden {
    serde_json::from_str(include_str!("../../tests/golden/bootstrap.json")).unwrap()
}

/// Interval of the mean.
fn of_mean(x: &[f64], block: usize, replications: usize, level: f64, seed: u64) -> [f64; 2] {
    block_bootstrap([x], block, replications, level, seed, |[sum]| sum / x.len() as f64)
}

/// Both sides draw: the ends of 40000 replications agree to a few percent of the width.
#[test]
fn intervals_of_a_mean_repeat_arch() {
    let golden = golden();
    for [level, low, high] in golden.intervals {
        let found = of_mean(&golden.series, golden.block, 40_000, level, 3);
        let near = 0.03 * (high - low);
        assert!((found[0] - low).abs() < near, "{level}: {found:?} [{low}, {high}]");
        assert!((found[1] - high).abs() < near, "{level}: {found:?} [{low}, {high}]");
    }
}

/// arch sums the autocovariances it takes for nonzero, the rule here knows they are an AR(1)'s.
#[test]
fn blocks_are_as_long_as_archs() {
    for [rho, n, rows] in golden().block_lengths {
        let found = block_length(rho, n as usize) as f64;
        assert!((found / rows - 1.0).abs() < 0.15, "{rho}: {found} {rows}");
    }
}

/// A series of variance 1 whose mean is zero.
fn first_order(n: usize, rho: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut e: Vec<f64> = (0..n).map(|_| StandardNormal.sample(rng)).collect();
    for t in 1..n {
        e[t] = rho * e[t - 1] + (1.0 - rho * rho).sqrt() * e[t];
    }
    e
}

/// As often as arch's, which is less often than promised where rows are correlated.
#[test]
fn intervals_hold_the_truth_as_often_as_archs() {
    const SERIES: usize = 800;
    let golden = golden();
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for [rho, n, level, expected] in golden.coverage {
        let n = n as usize;
        let holds = |seed: u64, x: Vec<f64>| {
            let block = block_length(autocorrelation(&x, 1)[1], n);
            let [low, high] = of_mean(&x, block, 300, level, seed);
            low <= 0.0 && 0.0 <= high
        };
        let series = (0..SERIES as u64).map(|seed| (seed, first_order(n, rho, &mut rng)));
        let held = series.filter(|(seed, x)| holds(*seed, x.clone())).count();
        let found = held as f64 / SERIES as f64;
        let draws = 1.0 / SERIES as f64 + 1.0 / golden.coverage_series as f64;
        let spread = (expected * (1.0 - expected) * draws).sqrt();
        assert!((found - expected).abs() < 3.3 * spread, "{rho}, {n}: {found}, arch {expected}");
    }
}
