//! The posterior of one joint's parameters by Markov chains.
//!
//! Prior: uniform within the bounds, and 1/sigma^2 for the noise level. Likelihood: Gaussian noise
//! that an autoregression describes, fitted to the residual of the best fit (generalised least
//! squares: fit, model the residual, whiten, fit again). With SSE the sum of squares of the
//! whitened residual and sigma integrated out,
//!
//! p(x | y) ~ SSE(x)^(-n/2) within the bounds
//!
//! (Gelman et al., Bayesian Data Analysis, 3rd ed., section 14.2). Whitening is linear, so the
//! whitened problem is again a [`JointProblem`] whose SSE is cheap ([`QuadraticCost`]); chains walk
//! in the coordinates of [`super::coordinates`], where w_s is redrawn from its whole range. What is
//! not integrated out are the coefficients of the autoregression: they are told by thousands of
//! samples and, for large n, do not correlate with the parameters.

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::adaptive_metropolis::{self as metropolis, Chain};
use super::coordinates::Coordinates;
use super::error::IdentificationError;
use super::prepared::Prepared;
use super::problem::{Column, Curve, JointProblem};
use super::quadratic::QuadraticCost;
use super::{LEVEL, ParameterEstimate, judge, separable};
use crate::follow::{Watch, go_on};
use crate::regression::bounds::Bounds;
use crate::statistics::{Autoregression, Convergence, Whitening};

/// Fits after whitening with the residual of the one before.
const ROUNDS: usize = 2;
/// Chains that have not converged are made anew, longer by this factor, so many times.
const EXTENSION: usize = 4;
const EXTENSIONS: usize = 2;
/// Scatter of the starts, in standard deviations.
const SCATTER: f64 = 3.0;

/// Posterior of one parameter.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Posterior {
    pub mean: f64,
    pub median: f64,
    pub standard_deviation: f64,
    /// Ends of the interval that holds 99 % of the draws, with equal tails.
    pub low: f64,
    pub high: f64,
    #[serde(flatten)]
    pub convergence: Convergence,
    pub converged: bool,
}

/// Draws of one joint's parameters.
pub struct Sampled {
    /// Posterior mean; the best fit where there are too few samples to draw from.
    pub x: Vec<f64>,
    pub evaluations: usize,
    /// Draws by name, chain by chain; with a curve also `stribeck_excess`.
    draws: Vec<(String, Vec<Vec<f64>>)>,
}

/// # Errors
/// If bounds are the wrong way round.
pub fn sample(
    prepared: &Prepared,
    settings: &metropolis::Settings,
    search: &separable::Settings,
    seed: u64,
    watch: &dyn Watch,
) -> Result<Sampled, IdentificationError> {
    let problem = &prepared.problem;
    let mut x = prepared.separable(search).x;
    let nothing = Sampled { x: x.clone(), evaluations: 0, draws: vec![] };
    if judge::too_few(problem) {
        return Ok(nothing);
    }
    let mut white = whitened(problem, &x).0;
    for _ in 1..ROUNDS {
        x = Prepared::new(white)?.separable(search).x;
        white = whitened(problem, &x).0;
    }
    let bounds = white.bounds()?;
    let cost = QuadraticCost::new(&white, &bounds);
    let sigma = problem.rms(cost.sum_of_squares(&x)).max(f64::MIN_POSITIVE);
    let rows = white.samples() as f64 / white.design_effect(&white.residual(&x));
    let Some(coordinates) = Coordinates::new(&cost, &bounds, sigma) else { return Ok(nothing) };
    let target = Target { problem, rows, cost: &cost, bounds: &bounds, coordinates, watch };
    let mut sampled = target.sample(settings, seed);
    let mut longer = *settings;
    for _ in 0..EXTENSIONS {
        if sampled.converged() {
            break;
        }
        longer.warm_up *= EXTENSION;
        longer.thinning *= EXTENSION;
        let before = sampled.evaluations;
        sampled = target.sample(&longer, seed);
        sampled.evaluations += before;
    }
    Ok(sampled)
}

/// What is drawn from: `cost` is of the whitened problem.
struct Target<'a> {
    problem: &'a JointProblem,
    /// As many as count: what comes again with the motion counts once.
    rows: f64,
    cost: &'a QuadraticCost,
    bounds: &'a Bounds,
    coordinates: Coordinates<'a>,
    watch: &'a dyn Watch,
}

impl Target<'_> {
    fn sample(&self, settings: &metropolis::Settings, seed: u64) -> Sampled {
        let starts = self.starts(settings.chains, seed);
        let range = self.range().map(|(low, high)| [low.ln(), high.ln()]);
        let mut chains = metropolis::sample(|u| self.ln_density(u), range, &starts, settings, seed);
        let all = chains.iter_mut().flat_map(|c| &mut c.draws);
        all.for_each(|draw| *draw = self.coordinates.parameters(draw).0);
        let draws = named(self.problem, &chains);
        let x = (0..self.bounds.len()).map(|i| mean(&draws[i].1)).collect();
        let evaluations = settings.evaluations(1 + usize::from(range.is_some()));
        Sampled { x, evaluations, draws }
    }

    fn ln_density(&self, u: &[f64]) -> f64 {
        go_on(self.watch);
        let (x, ln_volume) = self.coordinates.parameters(u);
        if !self.bounds.contain(&x) {
            return f64::NEG_INFINITY;
        }
        let half_n = 0.5 * self.rows;
        ln_volume - half_n * self.cost.sum_of_squares(&x).max(f64::MIN_POSITIVE).ln()
    }

    /// Range of Stribeck velocities, rad/s.
    fn range(&self) -> Option<(f64, f64)> {
        self.problem.curve.as_ref().map(|c| (c.velocity.lower, c.velocity.upper))
    }

    /// One start per chain, wider apart than the posterior: over the whole range of Stribeck velocities, each
    /// with the other parameters that fit best there, moved by a few of their standard deviations as far as
    /// the bounds allow.
    fn starts(&self, chains: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(u64::MAX);
        let fixed = usize::from(self.range().is_some());
        let start = |k: usize| {
            let share = (k as f64 + 0.5) / chains as f64;
            let velocity = self.range().map_or(0.0, |(a, b)| a * (b / a).powf(share));
            let best = self.coordinates.of(&self.cost.profile(velocity).x);
            let mut step: Vec<f64> = best.iter().map(|_| StandardNormal.sample(&mut rng)).collect();
            step[..fixed].fill(0.0);
            let moved = |far: f64| best.iter().zip(&step).map(|(u, s)| u + far * s).collect();
            let mut tries = (0..20).map(|halvings| moved(SCATTER * 0.5f64.powi(halvings)));
            let inside = |u: &Vec<f64>| self.bounds.contain(&self.coordinates.parameters(u).0);
            tries.find(inside).unwrap_or_else(|| best.clone())
        };
        (0..chains).map(start).collect()
    }
}

/// The problem as seen through the filter that makes the residual at `x` white, and the order of
/// the autoregression.
fn whitened(problem: &JointProblem, x: &[f64]) -> (JointProblem, usize) {
    let model = Autoregression::fit(&problem.residual(x), &problem.slots);
    let filter = Arc::new(Whitening::new(&model, &problem.slots));
    let column = |c: &Column| Column { values: filter.apply(&c.values), ..c.clone() };
    let curve = |c: &Curve| {
        let (filter, reduce) = (filter.clone(), c.reduce.clone());
        Curve {
            sign: filter.apply(&c.sign),
            reduce: Arc::new(move |all| reduce(all).iter().map(|c| filter.apply(c)).collect()),
            ..c.clone()
        }
    };
    let white = JointProblem {
        measured: filter.apply(&problem.measured),
        y: filter.apply(&problem.y),
        columns: problem.columns.iter().map(column).collect(),
        curve: problem.curve.as_ref().map(curve),
        ..problem.clone()
    };
    (white, model.order())
}

fn named(problem: &JointProblem, chains: &[Chain]) -> Vec<(String, Vec<Vec<f64>>)> {
    let each = |f: &dyn Fn(&Vec<f64>) -> f64| -> Vec<Vec<f64>> {
        chains.iter().map(|c| c.draws.iter().map(f).collect()).collect()
    };
    let all = problem.parameters();
    let one = |(i, name): (usize, String)| (name, each(&|x| x[i]));
    let mut draws: Vec<_> = all.iter().map(|p| p.name.clone()).enumerate().map(one).collect();
    if problem.curve.is_some() {
        draws.push(("stribeck_excess".into(), each(&|x| x[1] - x[0])));
    }
    draws
}

impl Sampled {
    /// Did every parameter's chains converge?
    pub fn converged(&self) -> bool {
        !self.draws.is_empty()
            && self.draws.iter().all(|(_, chains)| Convergence::of(chains).reached(chains.len()))
    }

    /// Puts the posterior in place of the robust interval and test: `statistic` is mean / standard
    /// deviation, `p` twice the posterior mass on the rarer side of zero, at least one draw's.
    /// Where chains have not converged, nothing is known but the range of the prior.
    pub fn replace(&self, rows: &mut [ParameterEstimate]) {
        for row in rows {
            let Some((_, chains)) = self.draws.iter().find(|(name, _)| *name == row.name) else {
                continue;
            };
            let posterior = Posterior::of(chains);
            row.value = posterior.mean;
            row.posterior = Some(posterior);
            if !posterior.converged {
                judge::give_up(row, not_converged(&posterior.convergence));
            } else if row.identifiable {
                (row.low, row.high) = (posterior.low, posterior.high);
                row.statistic = posterior.mean / posterior.standard_deviation;
                row.p = two_sided(chains);
            }
        }
    }
}

fn not_converged(c: &Convergence) -> String {
    format!(
        "the Markov chains have not converged (R-hat {:.3}, effective draws {:.0} in the bulk and \
         {:.0} in the tails)",
        c.r_hat, c.ess_bulk, c.ess_tail
    )
}

impl Posterior {
    fn of(chains: &[Vec<f64>]) -> Self {
        let mut all = chains.concat();
        all.sort_by(f64::total_cmp);
        let mean = mean(chains);
        let variance =
            all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (all.len() as f64 - 1.0);
        let convergence = Convergence::of(chains);
        Self {
            mean,
            median: quantile(&all, 0.5),
            standard_deviation: variance.sqrt(),
            low: quantile(&all, 0.5 * (1.0 - LEVEL)),
            high: quantile(&all, 0.5 * (1.0 + LEVEL)),
            convergence,
            converged: convergence.reached(chains.len()),
        }
    }
}

fn mean(chains: &[Vec<f64>]) -> f64 {
    let count: usize = chains.iter().map(Vec::len).sum();
    chains.iter().flatten().sum::<f64>() / count as f64
}

/// Linear between order statistics.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() - 1) as f64;
    let (below, share) = (place as usize, place.fract());
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + share * (sorted[above] - sorted[below])
}

/// 2 min(P(x <= 0), P(x >= 0)), one draw more than counted on the rarer side.
fn two_sided(chains: &[Vec<f64>]) -> f64 {
    let all = || chains.iter().flatten();
    let rarer = all().filter(|x| **x <= 0.0).count().min(all().filter(|x| **x >= 0.0).count());
    (2.0 * (rarer as f64 + 1.0) / (all().count() as f64 + 1.0)).min(1.0)
}

#[cfg(test)]
#[path = "posterior_tests.rs"]
mod tests;
