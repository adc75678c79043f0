//! One joint's problem, ready to be searched.

use std::time::Instant;

use super::error::IdentificationError;
use super::problem::JointProblem;
use super::quadratic::QuadraticCost;
use super::settings::{Search, Settings};
use super::{pso, separable};
use crate::follow::{Watch, go_on};
use crate::regression::bounds::Bounds;

/// One joint's problem with its payload taken off, ready to be searched.
pub struct Prepared {
    pub problem: JointProblem,
    pub bounds: Bounds,
    pub cost: QuadraticCost,
    /// Time to prepare the problem and its `cost`, s.
    pub seconds: f64,
}

impl Prepared {
    /// # Errors
    /// If bounds are the wrong way round.
    pub fn new(problem: JointProblem) -> Result<Self, IdentificationError> {
        let clock = Instant::now();
        let bounds = problem.bounds()?;
        let cost = QuadraticCost::new(&problem, &bounds);
        Ok(Self { problem, bounds, cost, seconds: clock.elapsed().as_secs_f64() })
    }

    /// The global optimum by separable least squares.
    pub fn separable(&self, settings: &separable::Settings) -> separable::Outcome {
        separable::minimise(&self.problem, &self.cost, &self.bounds, settings)
    }

    /// The paper's swarm.
    pub fn swarm(&self, settings: &Settings, seed: u64, watch: &dyn Watch) -> pso::Outcome {
        match settings.pso_cost {
            Search::Quadratic => {
                pso::minimise(|x| self.cost.rms(x), &self.bounds, &settings.pso, seed)
            }
            Search::Direct => {
                let shared = pso::Settings { parallel: true, ..settings.pso };
                let cost = |x: &[f64]| {
                    go_on(watch);
                    self.problem.direct_cost(x)
                };
                pso::minimise(cost, &self.bounds, &shared, seed)
            }
        }
    }
}
