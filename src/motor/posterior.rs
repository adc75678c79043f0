//! The posterior of the motor's parameters by Markov chains.
//!
//! Prior: uniform within the scenario's bounds, and 1/sigma^2 for the noise. The measured channels
//! carry white noise, so with sigma integrated out p(x | y) ~ SSE(x)^(-n/2) within the bounds, as for
//! the arm (`identification::Posterior`) without its autoregression. Chains start around the least-squares
//! estimate and walk in its standard errors.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::inference::Knowledge;
use super::model::COUNT;
use super::output_error::OutputError;
use crate::identification::LEVEL;
use crate::identification::adaptive_metropolis::{Settings, sample};
use crate::statistics::{Convergence, normal_quantile};

/// Scatter of the starts, in standard errors.
const SCATTER: f64 = 2.0;
/// Largest step as a share of a parameter's span; it stands where there is no standard error.
const SHARE: f64 = 0.05;

#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Means of the draws; given parameters keep their value.
    pub values: [f64; COUNT],
    /// Intervals that hold 99 % of the draws, with equal tails.
    pub intervals: [[f64; 2]; COUNT],
    /// Twice the mass on the rarer side of zero.
    pub p: [f64; COUNT],
    pub evaluations: usize,
    pub converged: bool,
}

/// Draws around `best`, of which `known` says how well it is determined.
pub fn posterior(
    problem: &OutputError<'_>,
    bounds: &[[f64; 2]; COUNT],
    best: &[f64; COUNT],
    known: &Knowledge,
    settings: &Settings,
    seed: u64,
) -> Posterior {
    let steps: Vec<f64> = problem.free.iter().map(|&k| step(known, bounds[k], k)).collect();
    let centre: Vec<f64> = problem.free.iter().map(|&k| best[k]).collect();
    let at = |u: &[f64]| -> Vec<f64> {
        centre.iter().zip(&steps).zip(u).map(|((x, s), u)| x + s * u).collect()
    };
    let inside = |x: &[f64]| {
        problem.free.iter().zip(x).all(|(&k, x)| (bounds[k][0]..=bounds[k][1]).contains(x))
    };
    let half_n = 0.5 * (problem.samples() * problem.sigma.len()) as f64;
    let ln_density = |u: &[f64]| match at(u) {
        x if inside(&x) => -2.0 * half_n * problem.cost(&x).max(f64::MIN_POSITIVE).ln(),
        _ => f64::NEG_INFINITY,
    };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(u64::MAX);
    let mut scatter = |far: f64| -> Vec<f64> {
        centre.iter().map(|_| far * (2.0 * rng.random::<f64>() - 1.0)).collect()
    };
    let start = |_| {
        let mut tries = (0..20).map(|halvings| scatter(SCATTER * 0.5f64.powi(halvings)));
        tries.find(|u| inside(&at(u))).unwrap_or_else(|| vec![0.0; centre.len()])
    };
    let starts: Vec<Vec<f64>> = (0..settings.chains).map(start).collect();
    let chains = sample(ln_density, None, &starts, settings, seed);
    let draws: Vec<Vec<Vec<f64>>> =
        chains.iter().map(|c| c.draws.iter().map(|u| at(u)).collect()).collect();
    collected(problem, &draws, settings)
}

/// A standard error, or a share of the span.
fn step(known: &Knowledge, [low, high]: [f64; 2], k: usize) -> f64 {
    let interval = known.parameters[k].asymptotic;
    let error = 0.5 * (interval.high - interval.low) / normal_quantile(1.0 - LEVEL);
    let most = SHARE * (high - low);
    if error.is_finite() && error > 0.0 { error.min(most) } else { most }
}

fn collected(problem: &OutputError<'_>, draws: &[Vec<Vec<f64>>], settings: &Settings) -> Posterior {
    let mut mean = vec![0.0; problem.free.len()];
    let mut found = Posterior {
        values: [0.0; COUNT],
        intervals: [[f64::NAN; 2]; COUNT],
        p: [f64::NAN; COUNT],
        evaluations: settings.evaluations(1),
        converged: true,
    };
    for (slot, &k) in problem.free.iter().enumerate() {
        let chains: Vec<Vec<f64>> =
            draws.iter().map(|c| c.iter().map(|x| x[slot]).collect()).collect();
        found.converged &= Convergence::of(&chains).reached(chains.len());
        let mut all = chains.concat();
        all.sort_by(f64::total_cmp);
        let n = all.len();
        mean[slot] = all.iter().sum::<f64>() / n as f64;
        let tail = (0.5 * (1.0 - LEVEL) * n as f64) as usize;
        found.intervals[k] = [all[tail], all[n - 1 - tail]];
        let below = all.iter().filter(|x| **x <= 0.0).count();
        let rarer = below.min(n - below);
        found.p[k] = (2.0 * (rarer as f64 + 1.0) / (n as f64 + 1.0)).min(1.0);
    }
    found.values = problem.complete(&mean);
    found
}
