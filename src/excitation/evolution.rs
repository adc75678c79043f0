//! Separable CMA-ES: an evolution strategy that learns the scale of every coordinate.
//!
//! Hansen, *The CMA evolution strategy: a tutorial*, arXiv:1604.00772, 2016 (symbols and constants);
//! the diagonal covariance and its faster learning: Ros and Hansen, PPSN X, 2008.

use std::cmp::Ordering;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// A point and what it is worth.
#[derive(Clone)]
pub struct Member<T> {
    pub x: Vec<f64>,
    pub worth: T,
}

pub struct Settings {
    pub seed: u64,
    /// Points that are tried, in all.
    pub evaluations: usize,
    /// First step, in the units of x.
    pub sigma: f64,
}

/// Goes on from the best of `starts` (never empty). `order` puts the better one first; `done` hears
/// how many points were tried. The same seed gives the same point, whatever the number of threads.
pub fn search<T: Send + Clone>(
    starts: Vec<Vec<f64>>,
    settings: &Settings,
    worth: impl Fn(&[f64]) -> T + Sync,
    order: impl Fn(&T, &T) -> Ordering,
    mut done: impl FnMut(usize),
) -> Option<Member<T>> {
    let tried = |all: Vec<Vec<f64>>| -> Vec<Member<T>> {
        let member = |x: Vec<f64>| Member { worth: worth(&x), x };
        all.into_par_iter().map(member).collect()
    };
    let better = |a: &Member<T>, b: &Member<T>| order(&a.worth, &b.worth);
    let mut count = starts.len();
    let mut best = tried(starts).into_iter().min_by(better)?;
    let mut strategy = Strategy::new(best.x.clone(), settings.sigma);
    let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
    while count < settings.evaluations {
        let mut members = tried(strategy.sample(&mut rng));
        members.sort_by(better);
        count += members.len();
        done(count);
        if better(&members[0], &best) == Ordering::Less {
            best = members[0].clone();
        }
        strategy.learn(&members.iter().map(|m| m.x.as_slice()).collect::<Vec<_>>());
    }
    Some(best)
}

/// The state of the search; C is diagonal.
struct Strategy {
    m: Vec<f64>,
    sigma: f64,
    c: Vec<f64>,
    p_sigma: Vec<f64>,
    p_c: Vec<f64>,
    lambda: usize,
    /// Weights of the better half, best first; their sum is 1.
    weights: Vec<f64>,
    mu_eff: f64,
    generation: i32,
}

impl Strategy {
    fn new(m: Vec<f64>, sigma: f64) -> Self {
        let n = m.len();
        let lambda = 4 + (3.0 * (n as f64).ln()) as usize;
        let raw: Vec<f64> = (1..=lambda / 2)
            .map(|i| (0.5 * (lambda as f64 + 1.0)).ln() - (i as f64).ln())
            .collect();
        let total: f64 = raw.iter().sum();
        let weights: Vec<f64> = raw.iter().map(|w| w / total).collect();
        let mu_eff = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let zero = vec![0.0; n];
        let (p_sigma, p_c) = (zero.clone(), zero);
        Self { m, sigma, c: vec![1.0; n], p_sigma, p_c, lambda, weights, mu_eff, generation: 0 }
    }

    fn sample(&self, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        let mut one = || {
            let draw = |(m, c): (&f64, &f64)| {
                let z: f64 = StandardNormal.sample(rng);
                m + self.sigma * c.sqrt() * z
            };
            self.m.iter().zip(&self.c).map(draw).collect()
        };
        (0..self.lambda).map(|_| one()).collect()
    }

    /// Learns from the points of one generation, best first (tutorial, section 6 and figure 6).
    fn learn(&mut self, ranked: &[&[f64]]) {
        let n = self.m.len() as f64;
        let mu_eff = self.mu_eff;
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let d_sigma = 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma;
        let c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n);
        // Ros and Hansen, section 2: learning of the diagonal alone is (n + 2) / 3 times as fast.
        let faster = (n + 2.0) / 3.0;
        let c_1 = (faster * 2.0 / ((n + 1.3).powi(2) + mu_eff)).min(0.5);
        let c_mu = faster * 2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0).powi(2) + mu_eff);
        let c_mu = c_mu.min(1.0 - c_1);
        let expected_norm = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));

        let steps: Vec<Vec<f64>> = (ranked.iter().take(self.weights.len()))
            .map(|x| x.iter().zip(&self.m).map(|(x, m)| (x - m) / self.sigma).collect())
            .collect();
        let mean = |i: usize| steps.iter().zip(&self.weights).map(|(y, w)| w * y[i]).sum::<f64>();
        let y_w: Vec<f64> = (0..self.m.len()).map(mean).collect();
        for ((p, y), c) in self.p_sigma.iter_mut().zip(&y_w).zip(&self.c) {
            *p = (1.0 - c_sigma) * *p + (c_sigma * (2.0 - c_sigma) * mu_eff).sqrt() * y / c.sqrt();
        }
        self.generation += 1;
        let norm = self.p_sigma.iter().map(|p| p * p).sum::<f64>().sqrt();
        let faded = (1.0 - (1.0 - c_sigma).powi(2 * self.generation)).sqrt();
        let h_sigma = norm / faded < (1.4 + 2.0 / (n + 1.0)) * expected_norm;
        let h = f64::from(u8::from(h_sigma));
        for (i, c) in self.c.iter_mut().enumerate() {
            self.p_c[i] =
                (1.0 - c_c) * self.p_c[i] + h * (c_c * (2.0 - c_c) * mu_eff).sqrt() * y_w[i];
            let rank_mu: f64 = steps.iter().zip(&self.weights).map(|(y, w)| w * y[i] * y[i]).sum();
            let stalled = (1.0 - h) * c_c * (2.0 - c_c);
            *c = (1.0 - c_1 - c_mu + c_1 * stalled) * *c
                + c_1 * self.p_c[i] * self.p_c[i]
                + c_mu * rank_mu;
        }
        self.m.iter_mut().zip(&y_w).for_each(|(m, y)| *m += self.sigma * y);
        self.sigma *= ((c_sigma / d_sigma) * (norm / expected_norm - 1.0)).exp();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smallest(f: impl Fn(&[f64]) -> f64 + Sync, seed: u64, evaluations: usize) -> Member<f64> {
        let settings = Settings { seed, evaluations, sigma: 0.5 };
        search(vec![vec![2.0; 8]], &settings, f, f64::total_cmp, |_| ()).unwrap()
    }

    /// An ellipsoid whose axes differ by a factor of 1000.
    #[test]
    fn it_finds_the_bottom_of_a_stretched_bowl() {
        let bowl = |x: &[f64]| -> f64 {
            let scale = |i: usize| 1e6_f64.powf(i as f64 / 7.0);
            x.iter().enumerate().map(|(i, x)| scale(i) * (x - 0.5) * (x - 0.5)).sum()
        };
        for seed in 0..3 {
            let found = smallest(bowl, seed, 4000);
            assert!(found.worth < 1e-9, "seed {seed}: {}", found.worth);
        }
        assert_eq!(smallest(bowl, 1, 300).x, smallest(bowl, 1, 300).x);
        assert_ne!(smallest(bowl, 1, 300).x, smallest(bowl, 2, 300).x);
    }
}
