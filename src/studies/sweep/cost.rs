//! What a method costs: the work alone, without the simulation of what it is given.

use super::arm::Bench;
use super::diagnosis;
use super::grid::{Cell, Method};
use super::identification::{problem, settings};
use super::study::Study;
use super::table::Row;
use crate::identification::identify;
use crate::studies::StudyError;

/// How much there was to do; how long it took stands with the timings.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Work {
    /// Rows of the recording.
    pub samples: usize,
    /// Rows that were fitted, summed over all joints.
    pub fitted: usize,
    /// Cost function evaluations, all joints.
    pub evaluations: usize,
}

impl Work {
    pub fn row(self) -> Row {
        vec![
            ("samples", self.samples.into()),
            ("fitted", self.fitted.into()),
            ("evaluations", self.evaluations.into()),
        ]
    }
}

/// # Errors
/// If a fit or a diagnosis fails.
pub fn rows(study: &Study, cell: &Cell, bench: &Bench) -> Result<Vec<Row>, StudyError> {
    let samples = (bench.simulated_s / bench.recording_interval()).round() as usize;
    let mut work = Work { samples, ..Work::default() };
    match cell.method {
        Method::Simulation => {}
        Method::Diagnosis => {
            diagnosis::diagnosed(study, cell, bench)?;
        }
        Method::Pso | Method::Nlse | Method::Mcmc => {
            let problem = problem(study, cell, bench)?;
            let results = identify(&problem, None, &settings(study, cell))?;
            let joints = || results.iter().flat_map(|m| &m.joints);
            work.fitted = joints().map(|j| j.samples).sum();
            work.evaluations = joints().map(|j| j.evaluations).sum();
        }
    }
    Ok(vec![work.row()])
}
