//! Identification of the DC motor.

use super::grid::{Cell, Method};
use super::identification::Found;
use super::study::Study;
use super::table::Row;
use crate::motor::experiment::Clean;
use crate::motor::fit::{Fit, least_squares, swarm};
use crate::motor::inference::{ALPHA, Interval, Knowledge, analyse};
use crate::motor::model::{COUNT, NAMES};
use crate::motor::output_error::OutputError;
use crate::motor::posterior::posterior;
use crate::motor::report::MotorError;
use crate::motor::scenario::Scenario;
use crate::studies::StudyError;

/// Standard errors from the minimum within which intervals are taken to hold, as `armtwin motor`.
const FARTHEST: f64 = 0.5;

pub struct Bench {
    pub scenario: Scenario,
    clean: Clean,
}

impl Bench {
    /// Every seed has another voltage and other noise.
    ///
    /// # Errors
    /// If `[motor]` is no scenario or its motor cannot be simulated.
    pub fn new(study: &Study, cell: &Cell) -> Result<Self, StudyError> {
        let mut scenario = study.motor()?;
        let excitation = &mut scenario.identification;
        excitation.seed = cell.seed;
        if let Some(duration_s) = cell.duration_s {
            excitation.duration = duration_s;
        }
        if let Some(rate_hz) = cell.rate_hz {
            excitation.sample_time = 1.0 / rate_hz;
        }
        scenario.check()?;
        let clean =
            Clean::of(&scenario.truth, &scenario.identification).map_err(MotorError::Truth)?;
        Ok(Self { scenario, clean })
    }
}

/// # Errors
/// If no motor within the bounds can be simulated.
pub fn rows(study: &Study, cell: &Cell, bench: &Bench) -> Result<Vec<Row>, StudyError> {
    let scenario = &bench.scenario;
    let clean = match cell.snr_db {
        Some(snr) => bench.clean.at(snr.db()),
        None => bench.clean.clone(),
    };
    let record = clean.for_identification(cell.seed);
    let problem = scenario.problem(&record);
    let fit = search(scenario, &problem, cell);
    if !fit.cost.is_finite() {
        return Err(MotorError::NothingFits.into());
    }
    let known = analyse(&problem, &fit.values).map_err(MotorError::Statistics)?;
    let truth = scenario.truth.to_array();
    let mut all: Vec<Found> = Vec::new();
    for &k in &problem.free {
        all.push(found(scenario, &fit, &known, truth[k], k));
    }
    if cell.method == Method::Mcmc {
        let drawn =
            posterior(&problem, &scenario.bounds, &fit.values, &known, &study.mcmc, cell.seed);
        for (found, &k) in all.iter_mut().zip(&problem.free) {
            found.value = drawn.values[k];
            found.intervals[0] = [drawn.intervals[k][0], drawn.intervals[k][1], drawn.p[k]];
            found.given = drawn.converged && known.identifiable[k];
            found.kept = found.given && drawn.p[k] <= ALPHA;
            found.evaluations += drawn.evaluations;
        }
    }
    Ok(all.into_iter().map(Found::row).collect())
}

/// Chains start from least squares.
fn search(scenario: &Scenario, problem: &OutputError<'_>, cell: &Cell) -> Fit {
    let (bounds, quiet) = (&scenario.bounds, &|| ());
    match cell.method {
        Method::Pso => {
            let mut settings = scenario.pso;
            if let Some(particles) = cell.particles {
                settings.particles_per_parameter = particles;
            }
            swarm(problem, bounds, &settings, cell.seed, quiet)
        }
        _ => least_squares(problem, bounds, scenario.nlse.starts, cell.seed, quiet),
    }
}

fn found(scenario: &Scenario, fit: &Fit, known: &Knowledge, truth: f64, k: usize) -> Found {
    let value = fit.values[k];
    let [low, high]: [f64; 2] = scenario.bounds[k];
    let near = 1e-6 * (high - low);
    let at_bound = value <= low + near || value >= high - near;
    let c = known.parameters[k];
    let of = |i: Interval| [i.low, i.high, i.p];
    let given = known.identifiable[k] && !at_bound && known.newton_step <= FARTHEST;
    Found {
        joint: 0,
        parameter: NAMES[k % COUNT].into(),
        truth,
        value,
        intervals: [of(c.robust), of(c.asymptotic), of(c.paper)],
        given,
        kept: given && c.robust.p <= ALPHA,
        cost: fit.cost,
        evaluations: fit.evaluations,
    }
}
