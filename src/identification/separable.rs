//! NLSE: separable least squares, then Levenberg-Marquardt on all parameters.
//!
//! Five of the six parameters of Eq. 1 enter linearly, so for each w_s the best of them follow
//! from bounded linear least squares; what is left is a function of w_s alone (variable
//! projection: Golub and Pereyra, SIAM J. Numerical Analysis 10, 1973), searched on a grid over
//! its whole range, every local minimum refined. That reaches the global optimum; a descent from
//! one guess, as the paper's NLSE, need not.

use super::levenberg_marquardt as lm;
use super::problem::JointProblem;
use super::quadratic::QuadraticCost;
use crate::regression::bounds::Bounds;
use crate::regression::brent;

#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Stribeck velocities tried, evenly in ln w_s.
    pub grid: usize,
    /// Tolerance to which a local minimum is refined, in ln w_s.
    pub tolerance: f64,
    pub refinement: lm::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        Self { grid: 64, tolerance: 1e-8, refinement: lm::Settings::default() }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    pub x: Vec<f64>,
    /// SSE, evaluated sample by sample.
    pub sum_of_squares: f64,
    /// Stribeck velocities tried, plus evaluations of the refinement.
    pub evaluations: usize,
    /// Local minima over w_s.
    pub minima: usize,
    pub stop: lm::Stop,
}

/// The global optimum of `problem` within `bounds` (its own); `cost` is made from both.
pub fn minimise(
    problem: &JointProblem,
    cost: &QuadraticCost,
    bounds: &Bounds,
    settings: &Settings,
) -> Outcome {
    let (start, tried, minima) = match &problem.curve {
        Some(curve) => search(cost, curve.velocity.lower, curve.velocity.upper, settings),
        None => (cost.profile(0.0).x, 1, 1),
    };
    let refined = lm::minimise(problem, &start, bounds, &settings.refinement);
    Outcome {
        x: refined.x,
        sum_of_squares: refined.sum_of_squares,
        evaluations: tried + refined.evaluations,
        minima,
        stop: refined.stop,
    }
}

/// The best point of the profile over w_s, the number of w_s tried, and of local minima.
fn search(
    cost: &QuadraticCost,
    low: f64,
    high: f64,
    settings: &Settings,
) -> (Vec<f64>, usize, usize) {
    let (a, b) = (low.ln(), high.ln());
    let last = settings.grid.max(3) - 1;
    let at = |k: usize| a + (b - a) * k as f64 / last as f64;
    let height = |ln_w: f64| cost.profile(ln_w.exp().clamp(low, high)).sum_of_squares;
    let heights: Vec<f64> = (0..=last).map(|k| height(at(k))).collect();
    let is_minimum = |k: usize| {
        (k == 0 || heights[k] <= heights[k - 1]) && (k == last || heights[k] <= heights[k + 1])
    };
    let (mut best, mut tried, mut minima) = ((at(0), heights[0]), last + 1, 0);
    for k in (0..=last).filter(|&k| is_minimum(k)) {
        let count = |x| {
            tried += 1;
            height(x)
        };
        let (from, to) = (at(k.saturating_sub(1)), at((k + 1).min(last)));
        let refined = brent::minimise(count, from, to, settings.tolerance);
        let lowest = if refined.1 < heights[k] { refined } else { (at(k), heights[k]) };
        best = if lowest.1 < best.1 { lowest } else { best };
        minima += 1;
    }
    (cost.profile(best.0.exp().clamp(low, high)).x, tried, minima)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::pso;
    use crate::identification::testing::{self, TRUTH};

    fn solve(problem: &JointProblem) -> Outcome {
        let bounds = problem.bounds().unwrap();
        let cost = QuadraticCost::new(problem, &bounds);
        minimise(problem, &cost, &bounds, &Settings::default())
    }

    #[test]
    fn finds_the_truth_in_data_without_noise() {
        let outcome = solve(&testing::problem(2000, 0.0, false));
        for (x, truth) in outcome.x.iter().zip(&TRUTH) {
            assert!((x / truth - 1.0).abs() < 1e-6, "{:?}", outcome.x);
        }
    }

    #[test]
    fn no_swarm_finds_anything_lower() {
        for (n, noise) in [(500, 2.0), (1000, 0.5), (2000, 0.3)] {
            let problem = testing::problem(n, noise, true);
            let bounds = problem.bounds().unwrap();
            let cost = QuadraticCost::new(&problem, &bounds);
            let nlse = problem.rms(solve(&problem).sum_of_squares);
            for seed in 0..5 {
                let swarm = pso::minimise(|x| cost.rms(x), &bounds, &Default::default(), seed);
                assert!(nlse <= swarm.cost * (1.0 + 1e-9), "{nlse} {}", swarm.cost);
            }
        }
    }

    #[test]
    fn without_a_curve_it_is_plain_bounded_least_squares() {
        let mut problem = testing::problem(1000, 0.3, false);
        problem.curve = None;
        let outcome = solve(&problem);
        assert_eq!(outcome.x.len(), 3);
        assert!(outcome.stop.converged());
    }
}
