//! Do the links come back from a model that has them wrong?
//!
//! Per seed: another excitation, other sensor noise, other errors of the model; simulated in rapier.
//! The base parameters' intervals are held against the truth, and the torque of a second motion,
//! predicted with the links found, against that of the exact model fitted to the same recording.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::StudyError;
use super::recovery::{blank_twin, conditioning};
use crate::identification::{
    ArmProblem, BoundsByName, Inertial, LinkFit, Method, MethodResult, Settings, Terms, assemble,
    identify,
};
use crate::rigid_body::{is_possible, parameters};
use crate::robot::{Inertia, Robot};
use crate::signals::{Samples, condition};
use crate::simulation::{Command, Scenario, Simulation};
use crate::twin::Twin;

/// How a model can be wrong about its links.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wrong {
    /// Every mass 30 % too large or too small, by the toss of a coin.
    ThirtyPercent,
    /// 2 kg in every link, as in a well-known model.
    TwoKilograms,
}

pub const WRONG: [Wrong; 2] = [Wrong::ThirtyPercent, Wrong::TwoKilograms];

/// What one model came to with one seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    pub seed: u64,
    pub wrong: Wrong,
    /// Base parameters that the recording tells, and how many of their intervals hold the truth.
    pub told: usize,
    pub held: usize,
    /// Number of all base parameters.
    pub rank: usize,
    /// Root mean square over all joints of what is left on the second motion, each joint relative to
    /// what the exact model leaves there: the wrong model, least squares, the links found.
    pub model: f64,
    pub least_squares: f64,
    pub links: f64,
    /// Are all links possible?
    pub possible: bool,
    /// How far links are from the model's that the data call for.
    pub spread: f64,
}

impl Wrong {
    fn model(self, truth: &Robot, seed: u64) -> Robot {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut model = truth.clone();
        for body in &mut model.bodies {
            let factor = match self {
                Self::ThirtyPercent if rng.random::<bool>() => 1.3,
                Self::ThirtyPercent => 0.7,
                Self::TwoKilograms => 2.0 / body.inertia.mass,
            };
            let Inertia { mass, com, about_com } = body.inertia;
            body.inertia = Inertia { mass: factor * mass, com, about_com: about_com * factor };
        }
        model
    }
}

/// Both models on `scenario`'s recordings with `seed` for noise, motion and errors.
///
/// # Errors
/// If the scenario does not work out, the simulation diverges, or a fit fails.
pub fn trial(scenario: &Scenario, file: &str, seed: u64) -> Result<Vec<Trial>, StudyError> {
    let mut scenario = scenario.clone();
    scenario.seed = seed;
    scenario.motion.seed = seed;
    let made = scenario.work_out(file)?;
    let twin = blank_twin(&made);
    let mut simulation = Simulation::new(&made.setup)?;
    let mut record = |motion: &dyn Command, stream| -> Result<Samples, StudyError> {
        let run = simulation.run(motion, seed, stream, &mut |_| true)?;
        Ok(condition(&run.recording, &twin.drive, twin.robot.dof(), &conditioning())?)
    };
    let samples = [record(&made.fit, 0)?, record(&made.check, 1)?];
    let exact = left(&least_squares(&problems(&twin, &samples)?)?);
    let each = WRONG.into_iter().map(|wrong| of_model(&twin, wrong, seed, &samples, &exact));
    each.collect()
}

fn of_model(
    truth: &Twin,
    wrong: Wrong,
    seed: u64,
    samples: &[Samples; 2],
    exact: &[f64],
) -> Result<Trial, StudyError> {
    let model = Twin { robot: wrong.model(&truth.robot, seed), ..truth.clone() };
    let (terms, settings) = (Terms::usual()?, Settings::default());
    let mut arms = problems(&model, samples)?;
    let mut inertial = Inertial::of(&model, &terms);
    for (arm, samples) in arms.iter_mut().zip(samples) {
        inertial.attach(arm, samples, &model)?;
    }
    let mut by_base = [least_squares(&arms)?];
    let link_fit = LinkFit {
        twin: &model,
        terms: &terms,
        located: &[],
        bounds: &BoundsByName::new(),
        settings: &settings,
        total_mass: None,
        fit: &samples[0],
        check: Some(&samples[1]),
    };
    let found = link_fit.rigid_body(&inertial, &arms[0], &mut by_base, &[])?;
    let true_values = inertial.base.values(&parameters::of(&truth.robot));
    let told = found.base.iter().zip(&true_values).filter(|(row, _)| row.identifiable);
    let held = told.clone().filter(|(row, truth)| row.low <= **truth && **truth <= row.high);
    let beside = |r: &MethodResult| relative(&left(r), exact);
    Ok(Trial {
        seed,
        wrong,
        told: told.count(),
        held: held.count(),
        rank: inertial.base.len(),
        model: beside(&found.given),
        least_squares: beside(&by_base[0]),
        links: beside(&found.fitted),
        possible: found.twin.robot.bodies.iter().all(|b| is_possible(&b.inertia)),
        spread: found.links.spread,
    })
}

/// Problems of friction, rotors and offsets, one per recording.
fn problems(twin: &Twin, samples: &[Samples; 2]) -> Result<[ArmProblem; 2], StudyError> {
    let problem = |s: &Samples| assemble(s, twin, &Terms::usual()?, &BoundsByName::new());
    Ok([problem(&samples[0])?, problem(&samples[1])?])
}

/// Least squares fitted to the first recording and held against the second.
fn least_squares(arms: &[ArmProblem; 2]) -> Result<MethodResult, StudyError> {
    let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
    Ok(identify(&arms[0], Some(&arms[1]), &settings)?.remove(0))
}

/// Root mean square residual of every joint on the second recording, N.m.
fn left(result: &MethodResult) -> Vec<f64> {
    let of = |g: &crate::identification::Goodness| g.mse_nm2.sqrt();
    result.joints.iter().map(|j| j.check.as_ref().map_or(f64::NAN, of)).collect()
}

fn relative(left: &[f64], exact: &[f64]) -> f64 {
    let squares = left.iter().zip(exact).map(|(l, e)| (l / e).powi(2));
    (squares.sum::<f64>() / exact.len() as f64).sqrt()
}

/// Summary of all seeds with one kind of model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    pub wrong: Wrong,
    pub trials: usize,
    pub rank: usize,
    /// Mean number of base parameters that are told.
    pub told: f64,
    /// Share of their intervals that hold the truth.
    pub coverage: f64,
    /// Median and largest relative residual over the trials: the wrong model, least squares, the links found.
    pub model: [f64; 2],
    pub least_squares: [f64; 2],
    pub links: [f64; 2],
    pub possible: usize,
    pub spread: f64,
}

pub fn summarise(trials: &[Trial], wrong: Wrong) -> Option<Summary> {
    let all: Vec<&Trial> = trials.iter().filter(|t| t.wrong == wrong).collect();
    let of = |value: fn(&Trial) -> f64| {
        let mut values: Vec<f64> = all.iter().map(|t| value(t)).collect();
        values.sort_by(f64::total_cmp);
        [values[values.len() / 2], values[values.len() - 1]]
    };
    let told: usize = all.iter().map(|t| t.told).sum();
    let held: usize = all.iter().map(|t| t.held).sum();
    Some(Summary {
        wrong,
        trials: all.len(),
        rank: all.first()?.rank,
        told: told as f64 / all.len() as f64,
        coverage: held as f64 / told.max(1) as f64,
        model: of(|t| t.model),
        least_squares: of(|t| t.least_squares),
        links: of(|t| t.links),
        possible: all.iter().filter(|t| t.possible).count(),
        spread: of(|t| t.spread)[0],
    })
}
