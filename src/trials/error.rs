//! What can go wrong in a trial, with the file.

use std::io;
use std::path::{Path, PathBuf};

#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    #[error("{}: cannot be {action}: {source}", file.display())]
    Io { file: PathBuf, action: &'static str, source: io::Error },
    #[error("{}: {problem}", file.display())]
    File { file: PathBuf, problem: String },
    #[error(
        "{}: the seal is broken: its SHA-256 is {found}, seals.json says {sealed}; draw the cases \
         again",
        file.display()
    )]
    Broken { file: PathBuf, found: String, sealed: String },
    #[error("{0}")]
    Usage(String),
    #[error("stopped; the answers made so far are kept, the same command goes on from there")]
    Stopped,
    #[error("criteria: {0}")]
    Criteria(#[from] serde_json::Error),
    #[error(transparent)]
    Recording(#[from] crate::recording::RecordingError),
    #[error(transparent)]
    Twin(#[from] crate::twin::TwinError),
    #[error(transparent)]
    Signals(#[from] crate::signals::SignalError),
    #[error(transparent)]
    Servo(#[from] crate::servo::ServoError),
    #[error(transparent)]
    Scenario(#[from] crate::simulation::ScenarioError),
    #[error("case {case}: {source}")]
    Simulation { case: String, source: crate::simulation::SimulationError },
}

impl TrialError {
    pub(super) fn io(file: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io { file: file.into(), action, source }
    }

    pub(super) fn file(file: &Path, problem: impl ToString) -> Self {
        Self::File { file: file.into(), problem: problem.to_string() }
    }
}
