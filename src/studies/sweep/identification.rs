//! Identification of the arm: every parameter beside its truth, by every convention.

use super::arm::Bench;
use super::grid::{Cell, Method};
use super::study::Study;
use super::table::{Row, Value};
use crate::identification::{
    ArmProblem, BoundsByName, Dropped, Interval, LEVEL, Method as Search, MethodResult, Settings,
    Terms, assemble, identify, reduce,
};
use crate::signals::condition;
use crate::studies::StudyError;
use crate::studies::recovery::{Recovered, conditioning, recovered};

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// From 1 at the base; 0 for a motor.
    pub joint: usize,
    pub parameter: String,
    pub truth: f64,
    pub value: f64,
    /// Robust, asymptotic, the paper's: low, high, p. Of Markov chains the first is the posterior's.
    pub intervals: [[f64; 3]; 3],
    /// Does the tool stand by the intervals?
    pub given: bool,
    /// Does the term exist, as the tool says after looking at all?
    pub kept: bool,
    pub cost: f64,
    pub evaluations: usize,
}

impl Default for Found {
    fn default() -> Self {
        let nan = f64::NAN;
        Self {
            joint: 0,
            parameter: String::new(),
            truth: nan,
            value: nan,
            intervals: [[nan; 3]; 3],
            given: false,
            kept: false,
            cost: nan,
            evaluations: 0,
        }
    }
}

impl Found {
    pub fn row(self) -> Row {
        let [robust, asymptotic, paper] = self.intervals;
        vec![
            ("joint", self.joint.into()),
            ("parameter", Value::Text(self.parameter)),
            ("truth", self.truth.into()),
            ("value", self.value.into()),
            ("low", robust[0].into()),
            ("high", robust[1].into()),
            ("p", robust[2].into()),
            ("asymptotic_low", asymptotic[0].into()),
            ("asymptotic_high", asymptotic[1].into()),
            ("asymptotic_p", asymptotic[2].into()),
            ("paper_low", paper[0].into()),
            ("paper_high", paper[1].into()),
            ("paper_p", paper[2].into()),
            ("given", self.given.into()),
            ("kept", self.kept.into()),
            ("cost", self.cost.into()),
            ("evaluations", self.evaluations.into()),
        ]
    }
}

/// Fits the recording of `cell` by its method.
///
/// # Errors
/// If a fit fails.
pub fn arm(study: &Study, cell: &Cell, bench: &Bench) -> Result<Vec<Row>, StudyError> {
    let mut problem = problem(study, cell, bench)?;
    let settings = settings(study, cell);
    let results = identify(&problem, None, &settings)?;
    let dropped = match cell.method {
        Method::Nlse => Some(reduce(&mut problem, None, &settings.nlse)?),
        _ => None,
    };
    let all = recovered(&results, &bench.made);
    Ok(all.iter().map(|r| found(r, &results, dropped.as_deref()).row()).collect())
}

/// The cell's recording as a problem: its terms, its joints.
///
/// # Errors
/// If the recording cannot be conditioned or nothing slides.
pub fn problem(study: &Study, cell: &Cell, bench: &Bench) -> Result<ArmProblem, StudyError> {
    let recording = bench.recordings(cell)?.swap_remove(0);
    let twin = bench.twin(false);
    let samples = condition(&recording, &twin.drive, twin.robot.dof(), &conditioning())?;
    let terms = &study.terms[..cell.terms.unwrap_or(study.terms.len())];
    let terms = Terms::named(terms.iter().map(String::as_str))?;
    let mut problem = assemble(&samples, &twin, &terms, &BoundsByName::new())?;
    let joints = cell.joints.unwrap_or(problem.joints.len());
    problem.joints.truncate(joints);
    problem.shared_columns.truncate(joints);
    Ok(problem)
}

pub fn settings(study: &Study, cell: &Cell) -> Settings {
    let method = match cell.method {
        Method::Pso => Search::Pso,
        Method::Mcmc => Search::Mcmc,
        _ => Search::Nlse,
    };
    let mut settings = Settings {
        methods: vec![method],
        seed: cell.seed,
        pso: study.pso,
        mcmc: study.mcmc,
        ..Settings::default()
    };
    if let Some(particles) = cell.particles {
        settings.pso.particles_per_parameter = particles;
    }
    settings
}

fn found(r: &Recovered, results: &[MethodResult], dropped: Option<&[Dropped]>) -> Found {
    let e = &r.estimate;
    let joint = results.iter().flat_map(|m| &m.joints).find(|j| j.joint == r.joint);
    let other = |i: &Interval| [i.low, i.high, i.p];
    let kept = match dropped {
        Some(all) => !all.iter().any(|d| d.joint == r.joint && belongs(&e.name, &d.term)),
        None => e.identifiable && e.p <= 1.0 - LEVEL,
    };
    Found {
        joint: r.joint,
        parameter: e.name.clone(),
        truth: r.truth,
        value: e.value,
        intervals: [[e.low, e.high, e.p], other(&e.asymptotic), other(&e.paper)],
        given: e.identifiable,
        kept,
        cost: joint.map_or(f64::NAN, |j| j.cost),
        evaluations: joint.map_or(0, |j| j.evaluations),
    }
}

/// The Stribeck term has three parameters.
fn belongs(parameter: &str, term: &str) -> bool {
    let curve = ["static", "stribeck_excess", "stribeck_velocity"];
    parameter == term || term == "stribeck" && curve.contains(&parameter)
}
