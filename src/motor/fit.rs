//! The two searches of the paper on the output-error problem: particle swarm, and Levenberg-Marquardt
//! (its "NLSE") from several starts.
//!
//! Both work in the logarithm of what must be positive: there the directions in which current and
//! torques trade off are straight.

use std::time::Instant;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::model::{COUNT, index};
use super::output_error::OutputError;
use crate::identification::levenberg_marquardt::{self as lm, Residuals};
use crate::identification::pso;
use crate::regression::bounds::Bounds;

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// `pso` or `nlse`
    pub method: &'static str,
    pub values: [f64; COUNT],
    /// sqrt(mean r^2), in units of the noise.
    pub cost: f64,
    /// Simulations; one with sensitivities counts once.
    pub evaluations: usize,
    pub seconds: f64,
    pub stopped: String,
    /// Where each start of Levenberg-Marquardt ended.
    pub starts: Vec<End>,
}

#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct End {
    pub cost: f64,
    pub values: [f64; COUNT],
    pub evaluations: usize,
    pub stopped: String,
}

/// Told after every piece of work: a simulation of the swarm, a start of Levenberg-Marquardt.
pub type Tick<'a> = &'a (dyn Fn() + Sync);

/// The paper's particle swarm on its cost, Eq. 5.
pub fn swarm(
    problem: &OutputError<'_>,
    bounds: &[[f64; 2]; COUNT],
    settings: &pso::Settings,
    seed: u64,
    tick: Tick<'_>,
) -> Fit {
    let start = Instant::now();
    let coordinates = Coordinates { problem };
    let cost = |u: &[f64], limit: f64| {
        tick();
        problem.cost_below(limit, &coordinates.parameters(u))
    };
    let found = pso::minimise_below(cost, &coordinates.bounds(bounds), settings, seed);
    let best = coordinates.parameters(&found.best);
    Fit {
        method: "pso",
        values: problem.complete(&best),
        cost: problem.cost(&best),
        evaluations: found.evaluations,
        seconds: start.elapsed().as_secs_f64(),
        stopped: text_of(&found.stop),
        starts: Vec::new(),
    }
}

/// Random points tried for every start that is taken.
const DRAWS_PER_START: usize = 30;

/// Levenberg-Marquardt from the best of many random points in the box.
pub fn least_squares(
    problem: &OutputError<'_>,
    bounds: &[[f64; 2]; COUNT],
    starts: usize,
    seed: u64,
    tick: Tick<'_>,
) -> Fit {
    let begin = Instant::now();
    let points = starting_points(problem, bounds, starts, seed);
    let mut fit = least_squares_from(problem, bounds, &points, tick);
    fit.evaluations += starts * DRAWS_PER_START;
    fit.seconds = begin.elapsed().as_secs_f64();
    fit
}

/// Levenberg-Marquardt from given points (all ten parameters each); the best end is the estimate.
pub fn least_squares_from(
    problem: &OutputError<'_>,
    bounds: &[[f64; 2]; COUNT],
    points: &[[f64; COUNT]],
    tick: Tick<'_>,
) -> Fit {
    let begin = Instant::now();
    let ends: Vec<End> = points
        .par_iter()
        .map(|point| {
            let end = descend(problem, bounds, point);
            tick();
            end
        })
        .collect();
    let best = ends.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    let (values, cost, stopped) = match best {
        Some(end) => (end.values, end.cost, end.stopped.clone()),
        None => ([f64::NAN; COUNT], f64::INFINITY, "no start".into()),
    };
    Fit {
        method: "nlse",
        values,
        cost,
        evaluations: ends.iter().map(|e| e.evaluations).sum(),
        seconds: begin.elapsed().as_secs_f64(),
        stopped,
        starts: ends,
    }
}

/// The best of many points drawn at random in the box (in the coordinates of the descent).
pub fn starting_points(
    problem: &OutputError<'_>,
    bounds: &[[f64; 2]; COUNT],
    starts: usize,
    seed: u64,
) -> Vec<[f64; COUNT]> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let coordinates = Coordinates { problem };
    let [low, high] = coordinates.corners(bounds);
    let draws: Vec<Vec<f64>> = (0..starts * DRAWS_PER_START)
        .map(|_| low.iter().zip(&high).map(|(l, h)| l + (h - l) * rng.random::<f64>()).collect())
        .collect();
    let mut costs: Vec<(f64, [f64; COUNT])> = draws
        .par_iter()
        .map(|u| {
            let x = coordinates.parameters(u);
            (problem.cost(&x), problem.complete(&x))
        })
        .collect();
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    costs.truncate(starts);
    costs.into_iter().map(|(_, point)| point).collect()
}

/// Noise makes more digits of the cost meaningless; stops and reversals make it slightly rough.
const SETTINGS: lm::Settings = lm::Settings {
    cost_tolerance: 1e-10,
    step_tolerance: 1e-9,
    gradient_tolerance: 1e-10,
    max_evaluations: 250,
};

fn descend(problem: &OutputError<'_>, bounds: &[[f64; 2]; COUNT], point: &[f64; COUNT]) -> End {
    let coordinates = Coordinates { problem };
    let start = coordinates.coordinates(point);
    let found = lm::minimise(&coordinates, &start, &coordinates.bounds(bounds), &SETTINGS);
    End {
        cost: (found.sum_of_squares / coordinates.count() as f64).sqrt(),
        values: problem.complete(&coordinates.parameters(&found.x)),
        evaluations: found.evaluations,
        stopped: text_of(&found.stop),
    }
}

/// The problem in u = ln(theta) for what is positive, u = theta for viscous terms.
struct Coordinates<'a> {
    problem: &'a OutputError<'a>,
}

fn logarithmic(k: usize) -> bool {
    !matches!(k, index::T_V1 | index::T_V2 | index::T_V3)
}

/// Keeps ln finite where a bound is zero.
const SMALLEST: f64 = 1e-9;

impl Coordinates<'_> {
    fn parameters(&self, u: &[f64]) -> Vec<f64> {
        let of = |(&k, &u): (&usize, &f64)| if logarithmic(k) { u.exp() } else { u };
        self.problem.free.iter().zip(u).map(of).collect()
    }

    fn coordinates(&self, all: &[f64; COUNT]) -> Vec<f64> {
        let of = |&k: &usize| if logarithmic(k) { all[k].max(SMALLEST).ln() } else { all[k] };
        self.problem.free.iter().map(of).collect()
    }

    fn corners(&self, bounds: &[[f64; 2]; COUNT]) -> [Vec<f64>; 2] {
        [0, 1].map(|end| self.coordinates(&bounds.map(|b| b[end])))
    }

    /// The scenario's bounds are checked to be a box.
    fn bounds(&self, bounds: &[[f64; 2]; COUNT]) -> Bounds {
        let [low, high] = self.corners(bounds);
        Bounds::new(low, high).unwrap_or_else(|_| Bounds::unbounded(self.problem.free.len()))
    }
}

impl Residuals for Coordinates<'_> {
    fn count(&self) -> usize {
        self.problem.count()
    }

    fn residuals(&self, u: &[f64], out: &mut [f64]) {
        self.problem.residuals(&self.parameters(u), out);
    }

    fn jacobian(&self, u: &[f64], r: &[f64], bounds: &Bounds) -> Vec<Vec<f64>> {
        let x = self.parameters(u);
        let mut columns = self.problem.jacobian(&x, r, bounds);
        for ((&k, column), x) in self.problem.free.iter().zip(&mut columns).zip(&x) {
            if logarithmic(k) {
                column.iter_mut().for_each(|c| *c *= x);
            }
        }
        columns
    }
}

/// The serde name of an outcome.
fn text_of(stop: &impl serde::Serialize) -> String {
    match serde_json::to_value(stop) {
        Ok(serde_json::Value::String(text)) => text,
        _ => "stopped".into(),
    }
}
