//! What can go wrong in a study.

use std::io;
use std::path::Path;

use crate::diagnosis::DiagnosisError;
use crate::figure::FigureError;
use crate::identification::IdentificationError;
use crate::motor::report::MotorError;
use crate::motor::scenario::ScenarioError as MotorScenarioError;
use crate::signals::SignalError;
use crate::simulation::{ScenarioError, SimulationError};

#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Signals(#[from] SignalError),
    #[error(transparent)]
    Identification(#[from] IdentificationError),
    #[error(transparent)]
    Diagnosis(#[from] DiagnosisError),
    #[error(transparent)]
    Watch(#[from] crate::watch::WatchError),
    #[error(transparent)]
    Motor(#[from] MotorError),
    #[error(transparent)]
    Figure(#[from] FigureError),
    #[error("[motor] {0}")]
    MotorScenario(#[from] MotorScenarioError),
    #[error("the scenario has no table [effects.{0}]: it cannot be made weaker or stronger")]
    Absent(String),
    /// A file or folder: what is wrong with it and what to do.
    #[error("{file}: {problem}")]
    File { file: String, problem: String },
    /// A problem of a table in memory, with no file.
    #[error("{0}")]
    Table(String),
}

impl StudyError {
    pub(super) fn file(file: &Path, problem: impl std::fmt::Display) -> Self {
        Self::File { file: file.display().to_string(), problem: problem.to_string() }
    }

    /// For `map_err` on what is done to `file`.
    pub(super) fn io(file: &Path, done: &'static str) -> impl FnOnce(io::Error) -> Self {
        let file = file.to_path_buf();
        move |e| Self::file(&file, format!("cannot be {done}: {e}"))
    }
}
