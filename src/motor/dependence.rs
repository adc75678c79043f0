//! How much of an error of at most 5 % is the search's box.
//!
//! Along a direction the data do not determine every point costs the same, so a search ends where it
//! happened to start or where its bounds stop it. Boxes of several widths around the truth show it:
//! the cost reached stays, the identifiable combinations stay, the members' errors follow the box.

use serde::Serialize;

use super::error::{MotorError, error_percent};
use super::experiment::Clean;
use super::fit::{least_squares_from, starting_points, swarm};
use super::inference::analyse;
use super::input::Excitation;
use super::model::COUNT;
use super::output_error::OutputError;
use super::scenario::Scenario;
use crate::identification::pso;

/// One box and method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dependence {
    /// Bounds are truth / width .. truth * width.
    pub width: f64,
    pub method: &'static str,
    pub runs: usize,
    /// Smallest and largest cost reached, in units of the noise.
    pub cost: [f64; 2],
    /// Largest error of any member of an undetermined direction, %: the smallest and the largest of it
    /// over the runs.
    pub member_error: [f64; 2],
    /// Name of the best-determined combination of members.
    pub combination: String,
    pub combination_error: [f64; 2],
}

const WIDTHS: [f64; 4] = [1.05, 1.2, 2.0, 5.0];
const STARTS: usize = 5;
const SWARMS: u64 = 2;
/// Thinning of the recording and iterations of the swarm, to keep the table short work.
const THINNING: f64 = 10.0;
const ITERATIONS: usize = 50;

/// Runs both searches in every box on a thinned recording of the scenario.
pub fn dependence(scenario: &Scenario, seed: u64) -> Result<Vec<Dependence>, MotorError> {
    let thin = Excitation {
        sample_time: (THINNING * scenario.identification.sample_time)
            .min(scenario.identification.hold[0]),
        ..scenario.identification
    };
    let clean = Clean::of(&scenario.truth, &thin).map_err(MotorError::Truth)?;
    let record = clean.for_identification(seed);
    let problem = scenario.problem(&record);
    let mut table = Vec::new();
    for width in WIDTHS {
        let bounds = around(scenario, width);
        let points = starting_points(&problem, &bounds, STARTS, seed);
        let nlse = least_squares_from(&problem, &bounds, &points, &|| ());
        let ends: Vec<_> = nlse.starts.iter().map(|e| (e.cost, e.values)).collect();
        table.extend(row(scenario, &problem, width, "nlse", &ends)?);
        let settings = pso::Settings { iterations: ITERATIONS, ..scenario.pso };
        let swarms = (0..SWARMS).map(|n| swarm(&problem, &bounds, &settings, seed + n, &|| ()));
        let ends: Vec<_> = swarms.map(|f| (f.cost, f.values)).collect();
        table.extend(row(scenario, &problem, width, "pso", &ends)?);
    }
    Ok(table)
}

/// truth / width .. truth * width; what is zero keeps the scenario's bounds.
fn around(scenario: &Scenario, width: f64) -> [[f64; 2]; COUNT] {
    let truth = scenario.truth.to_array();
    std::array::from_fn(|k| match truth[k] {
        v if v > 0.0 => [v / width, v * width],
        _ => scenario.bounds[k],
    })
}

/// `None` where every direction is determined.
fn row(
    scenario: &Scenario,
    problem: &OutputError<'_>,
    width: f64,
    method: &'static str,
    ends: &[(f64, [f64; COUNT])],
) -> Result<Option<Dependence>, MotorError> {
    let truth = scenario.truth.to_array();
    let best = ends.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, best)) = best else { return Ok(None) };
    let knowledge = analyse(problem, best)?;
    let relative_width = |low: f64, high: f64, value: f64| (high - low) / value.abs();
    let Some(combination) = knowledge.combinations.iter().min_by(|a, b| {
        let [a, b] = [a, b].map(|c| relative_width(c.low, c.high, c.value));
        a.total_cmp(&b)
    }) else {
        return Ok(None);
    };
    let members: Vec<usize> = knowledge.undetermined.iter().flatten().copied().collect();
    let error =
        |values: &[f64; COUNT], k: usize| error_percent(values[k], truth[k]).map_or(0.0, f64::abs);
    let worst =
        |values: &[f64; COUNT]| members.iter().map(|&k| error(values, k)).fold(0.0, f64::max);
    let ratio = |values: &[f64; COUNT]| {
        error_percent(combination.of(values), combination.of(&truth)).map_or(0.0, f64::abs)
    };
    Ok(Some(Dependence {
        width,
        method,
        runs: ends.len(),
        cost: range(ends.iter().map(|e| e.0)),
        member_error: range(ends.iter().map(|e| worst(&e.1))),
        combination: combination.name.clone(),
        combination_error: range(ends.iter().map(|e| ratio(&e.1))),
    }))
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
}
