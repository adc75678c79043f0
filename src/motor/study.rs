//! The existence question over many noises: is a term kept that exists, dropped that does not?
//!
//! Per noise seed every scenario is identified and every parameter tested. Counted per parameter
//! and convention: how often it is kept (p <= alpha), which for a true zero is the false-positive
//! rate (nominal 1 %), and how often the 99 % interval covers the truth.
//!
//! The descent starts at the truth: that the global optimum is found from anywhere is the
//! business of `motor::report`; here the noise's effect on the optimum is studied.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use super::experiment::Clean;
use super::fit::{Fit, Tick, least_squares_from, swarm};
use super::inference::{ALPHA, Interval, Knowledge, analyse};
use super::model::{COUNT, NAMES};
use super::render::Grid;
use super::report::{Method, MotorError};
use super::scenario::{Channel, Scenario};

/// The three conventions in the order they are counted.
pub const CONVENTIONS: [&str; 3] = ["robust", "asymptotic", "paper"];

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    pub scenario: usize,
    pub measured: Vec<Channel>,
    pub method: &'static str,
    /// Noise seeds finished, from `first_seed`.
    pub seeds: usize,
    pub first_seed: u64,
    /// Seeds whose search or analysis failed; not counted below.
    pub failed: usize,
    pub parameters: Vec<Counts>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Counts {
    pub name: &'static str,
    pub truth: f64,
    /// Tests and intervals there were (none for given parameters; no intervals where refused).
    pub tests: usize,
    pub intervals: usize,
    /// By convention: p <= alpha, and intervals that cover the truth.
    pub kept: [usize; 3],
    pub covered: [usize; 3],
}

/// Runs `seeds` noises of one scenario; stops early, with what is done, when `stop` is set.
pub fn study(
    scenario: &Scenario,
    method: Method,
    first_seed: u64,
    seeds: usize,
    stop: &AtomicBool,
    tick: Tick<'_>,
) -> Result<Study, MotorError> {
    let clean = Clean::of(&scenario.truth, &scenario.identification).map_err(MotorError::Truth)?;
    let one = |n: usize| {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        let outcome = noise(scenario, &clean, method, first_seed + n as u64);
        tick();
        Some(outcome)
    };
    // A swarm keeps all cores busy by itself.
    let outcomes: Vec<Option<Knowledge>> = match method {
        Method::Nlse => (0..seeds).into_par_iter().filter_map(one).collect(),
        Method::Pso => (0..seeds).filter_map(one).collect(),
    };
    let known: Vec<&Knowledge> = outcomes.iter().flatten().collect();
    let truth = scenario.truth.to_array();
    Ok(Study {
        scenario: scenario.number,
        measured: scenario.measured.clone(),
        method: match method {
            Method::Nlse => "nlse",
            Method::Pso => "pso",
        },
        seeds: outcomes.len(),
        first_seed,
        failed: outcomes.len() - known.len(),
        parameters: (0..COUNT).map(|k| counts(&known, k, truth[k])).collect(),
    })
}

fn noise(scenario: &Scenario, clean: &Clean, method: Method, seed: u64) -> Option<Knowledge> {
    let record = clean.for_identification(seed);
    let problem = scenario.problem(&record);
    let bounds = &scenario.bounds;
    let quiet = &|| ();
    let Fit { values, .. } = match method {
        Method::Nlse => least_squares_from(&problem, bounds, &[scenario.truth.to_array()], quiet),
        Method::Pso => swarm(&problem, bounds, &scenario.pso, seed, quiet),
    };
    analyse(&problem, &values).ok()
}

fn counts(known: &[&Knowledge], k: usize, truth: f64) -> Counts {
    let of = |knowledge: &Knowledge| {
        let c = &knowledge.parameters[k];
        [c.robust, c.asymptotic, c.paper]
    };
    let all: Vec<[Interval; 3]> = known.iter().map(|k| of(k)).collect();
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
    }
}

/// Kept and covered, per parameter and convention, as shares in percent.
pub fn grid(study: &Study) -> Grid {
    let share = |count: usize, of: usize| match of {
        0 => "-".into(),
        _ => format!("{:.1}", 100.0 * count as f64 / of as f64),
    };
    let row = |c: &Counts| {
        let exists = if c.truth == 0.0 { "no" } else { "yes" };
        let mut row = vec![c.name.to_string(), exists.to_string()];
        row.extend(c.kept.map(|n| share(n, c.tests)));
        row.extend(c.covered.map(|n| share(n, c.intervals)));
        row
    };
    let measured: Vec<&str> = study
        .measured
        .iter()
        .map(|c| if *c == Channel::Omega { "omega" } else { "current" })
        .collect();
    Grid {
        title: format!(
            "Scenario {}, {}, measured {}, {} noise seeds from {} ({} failed): kept % (nominal 100 \
             where the term exists, 1 where not) and coverage % (nominal 99)",
            study.scenario,
            study.method,
            measured.join(" and "),
            study.seeds,
            study.first_seed,
            study.failed
        ),
        header: vec![
            "parameter",
            "exists",
            "kept: robust",
            "asymptotic",
            "paper's",
            "covered: robust",
            "asymptotic",
            "paper's",
        ],
        left: 2,
        rows: study.parameters.iter().map(row).collect(),
    }
}
