//! What can go wrong in a job, with the words that people get.

use crate::diagnosis::DiagnosisError;
use crate::follow::Interrupted;
use crate::identification::IdentificationError;
use crate::motion::MotionError;
use crate::recording::RecordingError;
use crate::resimulation::ResimulationError;
use crate::robot::RobotError;
use crate::servo::ServoError;
use crate::signals::SignalError;
use crate::simulation::{ScenarioError, SimulationError};
use crate::twin::TwinError;

#[derive(Debug, thiserror::Error)]
pub enum WorkflowError {
    /// Something was asked for that makes no sense.
    #[error("{0}")]
    Asked(String),
    /// A recording that is not of this arm, or of an arm whose torque nobody can tell.
    #[error("{0}")]
    Arm(String),
    /// A recording that contradicts its column names or the arm; [`Reading::force`](super::Reading) goes on
    /// with it.
    #[error("{file}: {}", doubts.join("\nand: "))]
    Doubted { file: String, doubts: Vec<String> },
    /// An error, and the recording it is about.
    #[error("{place}: {source}")]
    At { place: String, source: Box<WorkflowError> },
    #[error(transparent)]
    Recording(#[from] RecordingError),
    #[error(transparent)]
    Robot(#[from] RobotError),
    #[error(transparent)]
    Twin(#[from] TwinError),
    #[error(transparent)]
    Motion(#[from] MotionError),
    #[error(transparent)]
    Signals(#[from] SignalError),
    #[error(transparent)]
    Identification(#[from] IdentificationError),
    #[error(transparent)]
    Diagnosis(#[from] DiagnosisError),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Resimulation(#[from] ResimulationError),
    #[error(transparent)]
    Servo(#[from] ServoError),
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl WorkflowError {
    /// The error with what it is about, where its words do not say so.
    pub(super) fn at(self, place: &str) -> Self {
        match self.to_string().contains(place) || self.is_interruption() {
            true => self,
            false => Self::At { place: place.into(), source: Box::new(self) },
        }
    }

    /// Whether the work was ended by who followed it.
    pub fn is_interruption(&self) -> bool {
        match self {
            Self::At { source, .. } => source.is_interruption(),
            Self::Interrupted(_)
            | Self::Identification(IdentificationError::Interrupted(_))
            | Self::Diagnosis(DiagnosisError::Interrupted(_))
            | Self::Servo(
                ServoError::Interrupted(_) | ServoError::Diagnosis(DiagnosisError::Interrupted(_)),
            )
            | Self::Simulation(SimulationError::Stopped { .. })
            | Self::Resimulation(ResimulationError::Simulation(SimulationError::Stopped {
                ..
            })) => true,
            _ => false,
        }
    }
}
