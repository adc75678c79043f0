//! Random-walk Metropolis with a proposal that learns the posterior's shape.
//!
//! A proposal x' ~ N(x, lambda C) is accepted with probability min(1, p(x') / p(x)). While warming
//! up, C follows the covariance of the chain so far (Haario, Saksman and Tamminen, "An adaptive
//! Metropolis algorithm", Bernoulli 7(2), 2001) and lambda the share of accepted proposals (Andrieu
//! and Thoms, "A tutorial on adaptive MCMC", Statistics and Computing 18, 2008, algorithm 4). Then
//! both are frozen: what is kept is an ordinary Metropolis chain. Before each such step the first
//! coordinate alone may be redrawn from its whole range, which crosses between modes.
//!
//! Every chain has its own stream of random numbers: the outcome does not depend on threads.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    pub chains: usize,
    /// Steps whose draws are not kept.
    pub warm_up: usize,
    /// Draws that are kept per chain.
    pub draws: usize,
    /// Steps per kept draw.
    pub thinning: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { chains: 4, warm_up: 10_000, draws: 4000, thinning: 10 }
    }
}

impl Settings {
    /// Evaluations of the density, all chains, with `moves` per step.
    pub fn evaluations(&self, moves: usize) -> usize {
        self.chains * (1 + moves * (self.warm_up + self.draws * self.thinning))
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Draw after draw, a value per parameter.
    pub draws: Vec<Vec<f64>>,
    /// Share of the proposals accepted after warming up.
    pub accepted: f64,
}

/// Accepted share that mixes fastest (Roberts and Rosenthal, Statistical Science 16(4), 2001).
const WANTED: f64 = 0.234;
/// Learning slows down as step^-0.6.
const FORGETTING: f64 = 0.6;
/// Steps between two factorisations of C.
const REFRESH: usize = 20;
/// Least variance of a proposal.
const LEAST_VARIANCE: f64 = 1e-12;

/// One chain from each of `starts`. `ln_density` is known up to a constant and minus infinity where
/// the density vanishes; coordinates should be of the order of 1. `redrawn`: the range from which
/// the first coordinate is redrawn.
pub fn sample(
    ln_density: impl Fn(&[f64]) -> f64 + Sync,
    redrawn: Option<[f64; 2]>,
    starts: &[Vec<f64>],
    settings: &Settings,
    seed: u64,
) -> Vec<Chain> {
    let chain = |(k, start): (usize, &Vec<f64>)| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(k as u64);
        Walk::new(&ln_density, redrawn, start, rng).run(settings)
    };
    starts.par_iter().enumerate().map(chain).collect()
}

/// A chain on its way.
struct Walk<'a, F> {
    ln_density: &'a F,
    redrawn: Option<[f64; 2]>,
    rng: ChaCha8Rng,
    at: DVector<f64>,
    ln_p: f64,
    mean: DVector<f64>,
    /// C
    covariance: DMatrix<f64>,
    /// C = L L'
    root: DMatrix<f64>,
    ln_lambda: f64,
}

impl<'a, F: Fn(&[f64]) -> f64> Walk<'a, F> {
    fn new(ln_density: &'a F, redrawn: Option<[f64; 2]>, start: &[f64], rng: ChaCha8Rng) -> Self {
        let d = start.len();
        let at = DVector::from_column_slice(start);
        Self {
            ln_density,
            redrawn,
            rng,
            ln_p: ln_density(start),
            mean: at.clone(),
            covariance: DMatrix::identity(d, d),
            root: DMatrix::identity(d, d),
            ln_lambda: (2.38f64 * 2.38 / d as f64).ln(),
            at,
        }
    }

    fn run(mut self, settings: &Settings) -> Chain {
        for k in 0..settings.warm_up {
            let chance = self.step();
            self.learn(k, chance);
        }
        let mut accepted = 0.0;
        let mut draws = Vec::with_capacity(settings.draws);
        for _ in 0..settings.draws {
            accepted += (0..settings.thinning).map(|_| self.step()).sum::<f64>();
            draws.push(self.at.as_slice().to_vec());
        }
        Chain { draws, accepted: accepted / (settings.draws * settings.thinning) as f64 }
    }

    /// Returns the probability with which the random walk's proposal was accepted.
    fn step(&mut self) -> f64 {
        if let Some([low, high]) = self.redrawn {
            let mut proposal = self.at.clone();
            proposal[0] = self.rng.random_range(low..high);
            self.offer(proposal);
        }
        let z = DVector::from_fn(self.at.len(), |_, _| StandardNormal.sample(&mut self.rng));
        self.offer(&self.at + &self.root * z * (0.5 * self.ln_lambda).exp())
    }

    /// min(1, p(x') / p(x))
    fn offer(&mut self, proposal: DVector<f64>) -> f64 {
        let ln_p = (self.ln_density)(proposal.as_slice());
        let chance = (ln_p - self.ln_p).exp().min(1.0);
        if self.rng.random::<f64>() < chance {
            (self.at, self.ln_p) = (proposal, ln_p);
        }
        if chance.is_nan() { 0.0 } else { chance }
    }

    /// Andrieu and Thoms, algorithm 4.
    fn learn(&mut self, k: usize, chance: f64) {
        let gain = (k as f64 + 2.0).powf(-FORGETTING);
        self.ln_lambda += gain * (chance - WANTED);
        let off = &self.at - &self.mean;
        self.mean.axpy(gain, &off, 1.0);
        self.covariance.ger(gain, &off, &off, 1.0 - gain);
        if k.is_multiple_of(REFRESH) {
            let d = self.at.len();
            let padded = &self.covariance + DMatrix::identity(d, d) * LEAST_VARIANCE;
            self.root = padded.cholesky().map_or_else(|| self.root.clone(), |c| c.l());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A correlated normal, cut at 0 in the second coordinate.
    #[test]
    fn a_truncated_normal_has_its_known_moments() {
        let rho: f64 = 0.9;
        let ln_p = |x: &[f64]| {
            let z = (x[0] - 2.0) / 0.1;
            let inside = if x[1] < 0.0 { f64::NEG_INFINITY } else { 0.0 };
            inside - 0.5 * (z * z - 2.0 * rho * z * x[1] + x[1] * x[1]) / (1.0 - rho * rho)
        };
        let settings = Settings { warm_up: 20_000, draws: 5000, thinning: 10, chains: 4 };
        let starts = vec![vec![-40.0, 70.0], vec![0.0, 1.0], vec![40.0, 5.0], vec![3.0, 79.0]];
        let chains = sample(ln_p, None, &starts, &settings, 3);
        let mean = |i: usize| {
            let all = chains.iter().flat_map(|c| &c.draws).map(|x| x[i]);
            all.sum::<f64>() / (4 * settings.draws) as f64
        };
        // E[x | x > 0] = sqrt(2 / pi) for a standard normal; the other follows by regression.
        let expected = (2.0 / std::f64::consts::PI).sqrt();
        assert!((mean(1) - expected).abs() < 0.03, "{}", mean(1));
        assert!((mean(0) - (2.0 + 0.1 * rho * expected)).abs() < 0.003, "{}", mean(0));
        assert!(chains.iter().all(|c| (0.1..0.5).contains(&c.accepted)));
    }

    /// Two equal modes 30 standard deviations apart.
    #[test]
    fn redrawing_crosses_between_modes() {
        let normal = |x: f64, m: f64| (-0.5 * (x - m).powi(2)).exp();
        let ln_p = |x: &[f64]| (normal(x[0], 5.0) + normal(x[0], 35.0)).ln() - 0.5 * x[1] * x[1];
        let settings = Settings { warm_up: 1000, draws: 4000, thinning: 10, chains: 1 };
        let chain = &sample(ln_p, Some([0.0, 40.0]), &[vec![5.0, 0.0]], &settings, 1)[0];
        let share = chain.draws.iter().filter(|x| x[0] > 20.0).count() as f64 / 4000.0;
        assert!((share - 0.5).abs() < 0.04, "{share}");
    }

    #[test]
    fn chains_repeat_with_any_number_of_threads() {
        let settings = Settings { warm_up: 100, draws: 10, thinning: 2, chains: 3 };
        let starts = vec![vec![0.1], vec![0.5], vec![0.9]];
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sample(|x| -x[0] * x[0], None, &starts, &settings, 7))
        };
        assert_eq!(with(1), with(3));
    }
}
