//! Do the identified parameters come back, and do the intervals keep their promise?
//!
//! Per seed: another excitation, other sensor noise, the same hidden parameters; simulated in
//! rapier, identified by separable least squares after [`reduce`]. Coverage is the share of
//! intervals that hold the true value, nominally the level of the intervals.

use std::collections::BTreeMap;

use serde::Serialize;

use super::StudyError;
use crate::effects::of_drive;
use crate::identification::{
    BoundsByName, Dropped, Method, MethodResult, ParameterEstimate, Settings, Terms, assemble,
    identify, reduce,
};
use crate::signals::{Conditioning, condition};
use crate::simulation::{Experiment, Injection, Scenario, Simulation};
use crate::twin::Twin;

/// One parameter of one joint in one seed's recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recovered {
    pub truth: f64,
    pub estimate: ParameterEstimate,
    pub joint: usize,
}

impl Recovered {
    /// (value - truth) / |truth|; `None` where the truth is zero.
    pub fn relative_error(&self) -> Option<f64> {
        (self.truth != 0.0).then(|| (self.estimate.value - self.truth) / self.truth.abs())
    }

    pub fn within(&self, low: f64, high: f64) -> bool {
        low <= self.truth && self.truth <= high
    }
}

/// What one seed came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    pub seed: u64,
    /// Eq. 1, rotor inertia and offset, all terms.
    pub full: Vec<Recovered>,
    /// What `reduce` left of it.
    pub reduced: Vec<Recovered>,
    pub dropped: Vec<Dropped>,
}

/// How recordings of this simulated arm are conditioned: its sensors' noise is white up to half
/// the sampling rate, so the torque may keep more of its spectrum than a real arm's.
pub fn conditioning() -> Conditioning {
    Conditioning { torque_cutoff_hz: 20.0, ..Conditioning::default() }
}

/// Simulates `scenario`'s fit recording with `seed` for noise and motion, and identifies it.
///
/// # Errors
/// If the scenario does not work out, the simulation diverges, or a fit fails.
pub fn trial(scenario: &Scenario, file: &str, seed: u64) -> Result<Trial, StudyError> {
    let mut scenario = scenario.clone();
    scenario.seed = seed;
    scenario.motion.seed = seed;
    let made = scenario.work_out(file)?;
    let run = Simulation::new(&made.setup)?.run(&made.fit, seed, 0, &mut |_| true)?;
    let twin = blank_twin(&made);
    let samples = condition(&run.recording, &twin.drive, twin.robot.dof(), &conditioning())?;
    let mut arm = assemble(&samples, &twin, &Terms::usual()?, &BoundsByName::new())?;
    let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
    let full = recovered(&identify(&arm, None, &settings)?, &made);
    let dropped = reduce(&mut arm, None, &settings.nlse)?;
    let reduced = recovered(&identify(&arm, None, &settings)?, &made);
    Ok(Trial { seed, full, reduced, dropped })
}

/// The arm of the experiment, its friction and rotors unknown.
pub fn blank_twin(made: &Experiment) -> Twin {
    let mut twin = Twin {
        robot: made.setup.robot.clone(),
        drive: made.setup.drive.clone(),
        ..Twin::default()
    };
    twin.drive.rotor_inertia.fill(0.0);
    twin
}

/// Every estimate beside what the experiment hides.
pub fn recovered(results: &[MethodResult], made: &Experiment) -> Vec<Recovered> {
    let truth = truths(made);
    let joints = results.iter().flat_map(|m| &m.joints);
    let rows = joints.flat_map(|j| j.parameters.iter().map(move |p| (j.joint, p)));
    rows.filter_map(|(joint, estimate)| {
        let truth = *truth.get(&estimate.name)?.get(joint - 1)?;
        Some(Recovered { truth, estimate: estimate.clone(), joint })
    })
    .collect()
}

/// True values by the names `identify` uses, one per joint; what is not injected is zero.
fn truths(made: &Experiment) -> BTreeMap<String, Vec<f64>> {
    let joints = made.setup.robot.dof();
    let mut truth: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for name in ["viscous", "viscous_quadratic", "viscous_cubic", "offset"] {
        truth.insert(name.into(), vec![0.0; joints]);
    }
    truth.extend(
        of_drive().map(|(_, part, name)| (name.into(), made.setup.drive.part(part).clone())),
    );
    made.setup.effects.iter().for_each(|injection| write_down(injection, joints, &mut truth));
    let level = truth.get("coulomb").zip(truth.get("stribeck_excess"));
    if let Some((coulomb, excess)) = level {
        let sum = coulomb.iter().zip(excess).map(|(c, e)| c + e).collect();
        truth.insert("static".into(), sum);
    }
    truth
}

fn write_down(injection: &Injection, joints: usize, truth: &mut BTreeMap<String, Vec<f64>>) {
    for (k, parameter) in injection.effect.about().parameters.iter().enumerate() {
        let name = parameter.name.trim_start_matches("current_");
        let values = truth.entry(name.into()).or_insert_with(|| vec![0.0; joints]);
        for (&joint, row) in injection.joints.iter().zip(&injection.values) {
            values[joint] = row[k];
        }
    }
}

/// One parameter over all joints and seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    pub parameter: String,
    /// Estimates that were given an interval.
    pub intervals: usize,
    /// Estimates the tool refused to give one.
    pub refused: usize,
    /// Share of the intervals that hold the truth.
    pub robust: f64,
    pub asymptotic: f64,
    pub paper: f64,
    /// Median of |relative error|, where the truth is not zero.
    pub median_error: Option<f64>,
    /// Shares with a relative error of at most 5 % and at most 20 %.
    pub within: Option<[f64; 2]>,
    pub largest_error: Option<f64>,
}

/// Summaries by parameter, in the order the parameters come.
pub fn summarise<'a>(rows: impl Iterator<Item = &'a Recovered>) -> Vec<Summary> {
    let mut groups: Vec<(&str, Vec<&Recovered>)> = Vec::new();
    for row in rows {
        let name = row.estimate.name.as_str();
        match groups.iter_mut().find(|g| g.0 == name) {
            Some(group) => group.1.push(row),
            None => groups.push((name, vec![row])),
        }
    }
    groups.into_iter().map(|(name, rows)| summary(name, &rows)).collect()
}

fn summary(name: &str, rows: &[&Recovered]) -> Summary {
    let given: Vec<_> = rows.iter().filter(|r| r.estimate.identifiable).collect();
    let share = |held: &dyn Fn(&Recovered) -> bool| {
        given.iter().filter(|r| held(r)).count() as f64 / given.len().max(1) as f64
    };
    let mut errors: Vec<f64> =
        given.iter().filter_map(|r| r.relative_error()).map(f64::abs).collect();
    errors.sort_by(f64::total_cmp);
    Summary {
        parameter: name.into(),
        intervals: given.len(),
        refused: rows.len() - given.len(),
        robust: share(&|r| r.within(r.estimate.low, r.estimate.high)),
        asymptotic: share(&|r| r.within(r.estimate.asymptotic.low, r.estimate.asymptotic.high)),
        paper: share(&|r| r.within(r.estimate.paper.low, r.estimate.paper.high)),
        median_error: errors.get(errors.len() / 2).copied(),
        within: (!errors.is_empty()).then(|| [0.05, 0.2].map(|most| share_below(&errors, most))),
        largest_error: errors.last().copied(),
    }
}

fn share_below(errors: &[f64], most: f64) -> f64 {
    errors.iter().filter(|e| **e <= most).count() as f64 / errors.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_trial_holds_the_truth() {
        let text = include_str!("../../scenarios/ur5_friction.toml");
        let mut scenario = Scenario::parse(text, "ur5_friction.toml").unwrap();
        scenario.shorten(40.0);
        let trial = trial(&scenario, "ur5_friction.toml", 3).unwrap();
        let held = |r: &&Recovered| r.within(r.estimate.low, r.estimate.high);
        for rows in [&trial.full, &trial.reduced] {
            let given: Vec<_> = rows.iter().filter(|r| r.estimate.identifiable).collect();
            let share = given.iter().filter(|r| held(r)).count() as f64 / given.len() as f64;
            assert!(given.len() > 20 && share > 0.9, "{share} of {}", given.len());
        }
    }
}
