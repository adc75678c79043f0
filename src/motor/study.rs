//! The existence question over many noises: is a term kept that exists, dropped that does not?
//!
//! Per noise seed every scenario is identified and every parameter tested. Counted per parameter
//! and convention: how often it is kept (p <= alpha), which for a true zero is the false-positive
//! rate (nominal 1 %), and how often the 99 % interval covers the truth.
//!
//! The descent starts at the truth: that the global optimum is found from anywhere is the
//! business of `motor::report`; here the noise's effect on the optimum is studied. A swarm starts
//! where it always does, and may stop short of the optimum: `at_minimum` counts where it did not.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::{MotorError, error_percent};
use super::experiment::Clean;
use super::fit::{Fit, Tick, least_squares_from, swarm};
use super::inference::{ALPHA, Conventions, Interval, analyse};
use super::model::{COUNT, NAMES};
use super::output_error::OutputError;
use super::report::{FARTHEST, Given, Method};
use super::scenario::{Channel, Scenario};
use crate::identification::pso;

/// The three conventions in the order they are counted.
pub const CONVENTIONS: [&str; 3] = ["robust", "asymptotic", "paper"];

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    pub scenario: usize,
    pub measured: Vec<Channel>,
    pub given: Vec<Given>,
    pub method: &'static str,
    /// Noise seeds finished, from `first_seed`.
    pub seeds: usize,
    pub first_seed: u64,
    /// Seeds whose search or analysis failed; not counted below.
    pub failed: usize,
    /// Seeds whose search ended at a minimum of its cost: elsewhere tests and intervals are void.
    pub at_minimum: usize,
    pub parameters: Vec<Counts>,
    pub runs: Vec<Run>,
}

/// One noise that could be analysed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Run {
    pub seed: u64,
    /// sqrt(mean r^2), in units of the noise: 1 is as good as the truth.
    pub cost: f64,
    pub evaluations: usize,
    pub seconds: f64,
    /// Distance from the minimum in standard errors.
    pub newton_step: f64,
    pub values: [f64; COUNT],
    #[serde(skip)]
    knowledge: Vec<Conventions>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Counts {
    pub name: &'static str,
    pub truth: f64,
    /// Tests and intervals there were (none for given parameters; no intervals where refused).
    pub tests: usize,
    pub intervals: usize,
    /// Tests with p <= alpha, and intervals that cover the truth, by convention.
    pub kept: [usize; 3],
    pub covered: [usize; 3],
    /// Error relative to the truth, %: median and largest over the noises; absent where the truth is zero.
    pub error_percent: Option<[f64; 2]>,
}

/// End of a search: all that a study needs of it, and most of its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Search {
    pub values: [f64; COUNT],
    pub cost: f64,
    pub evaluations: usize,
    pub seconds: f64,
}

/// Searches that were made before, by another run of the same study.
pub trait Archive: Sync {
    fn find(&self, scenario: &Scenario, method: Method, seed: u64) -> Option<Search>;
    fn keep(&self, scenario: &Scenario, method: Method, seed: u64, search: &Search);
}

/// Remembers nothing.
impl Archive for () {
    fn find(&self, _: &Scenario, _: Method, _: u64) -> Option<Search> {
        None
    }

    fn keep(&self, _: &Scenario, _: Method, _: u64, _: &Search) {}
}

/// Runs `seeds` noises of one scenario; stops early, with what is done, when `stop` is set.
pub fn study(
    scenario: &Scenario,
    method: Method,
    [first_seed, seeds]: [u64; 2],
    archive: &dyn Archive,
    stop: &AtomicBool,
    tick: Tick<'_>,
) -> Result<Study, MotorError> {
    let clean = Clean::of(&scenario.truth, &scenario.identification).map_err(MotorError::Truth)?;
    let one = |seed: u64| {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        let outcome = noise(scenario, &clean, method, seed, archive);
        tick();
        Some(outcome)
    };
    let all = first_seed..first_seed + seeds;
    let outcomes: Vec<Option<Run>> = all.into_par_iter().filter_map(one).collect();
    let done = outcomes.len();
    let runs: Vec<Run> = outcomes.into_iter().flatten().collect();
    let truth = scenario.truth.to_array();
    Ok(Study {
        scenario: scenario.number,
        measured: scenario.measured.clone(),
        given: scenario.given_values(),
        method: method.name(),
        seeds: done,
        first_seed,
        failed: done - runs.len(),
        at_minimum: runs.iter().filter(|r| r.newton_step <= FARTHEST).count(),
        parameters: (0..COUNT).map(|k| counts(&runs, k, truth[k])).collect(),
        runs,
    })
}

fn noise(
    scenario: &Scenario,
    clean: &Clean,
    method: Method,
    seed: u64,
    archive: &dyn Archive,
) -> Option<Run> {
    let record = clean.for_identification(seed);
    let problem = scenario.problem(&record);
    let before = archive.find(scenario, method, seed);
    let found = before.unwrap_or_else(|| {
        let found = search(scenario, &problem, method, seed);
        archive.keep(scenario, method, seed, &found);
        found
    });
    let knowledge = analyse(&problem, &found.values).ok()?;
    Some(Run {
        seed,
        cost: found.cost,
        evaluations: found.evaluations,
        seconds: found.seconds,
        newton_step: knowledge.newton_step,
        values: found.values,
        knowledge: knowledge.parameters.to_vec(),
    })
}

fn search(scenario: &Scenario, problem: &OutputError<'_>, method: Method, seed: u64) -> Search {
    let bounds = &scenario.bounds;
    let quiet = &|| ();
    // Noises keep all cores busy.
    let settings = pso::Settings { parallel: false, ..scenario.pso };
    let Fit { values, cost, evaluations, seconds, .. } = match method {
        Method::Nlse => least_squares_from(problem, bounds, &[scenario.truth.to_array()], quiet),
        Method::Pso => swarm(problem, bounds, &settings, seed, quiet),
    };
    Search { values, cost, evaluations, seconds }
}

fn counts(runs: &[Run], k: usize, truth: f64) -> Counts {
    let of = |run: &Run| {
        let c = &run.knowledge[k];
        [c.robust, c.asymptotic, c.paper]
    };
    let all: Vec<[Interval; 3]> = runs.iter().map(of).collect();
    let count = |convention: usize, rule: &dyn Fn(&Interval) -> bool| {
        all.iter().filter(|i| rule(&i[convention])).count()
    };
    let each = |rule: &dyn Fn(&Interval) -> bool| [0, 1, 2].map(|c| count(c, rule));
    Counts {
        name: NAMES[k],
        truth,
        tests: count(0, &|i| !i.p.is_nan()),
        intervals: count(0, &|i| !i.low.is_nan()),
        kept: each(&|i| i.p <= ALPHA),
        covered: each(&|i| i.low <= truth && truth <= i.high),
        error_percent: median_and_largest(
            runs.iter().filter_map(|r| error_percent(r.values[k], truth)).map(f64::abs).collect(),
        ),
    }
}

fn median_and_largest(mut values: Vec<f64>) -> Option<[f64; 2]> {
    values.sort_by(f64::total_cmp);
    Some([*values.get(values.len() / 2)?, *values.last()?])
}
