//! Why there is no motion for a request.

use crate::motion::MotionError;
use crate::simulation::{ScenarioError, SimulationError};

#[derive(Debug, thiserror::Error)]
pub enum ExcitationError {
    #[error("{key} = {value}: give a number {condition}")]
    Number { key: &'static str, value: f64, condition: &'static str },
    #[error("--noise has {given} values, the arm has {joints} joints: give {joints}")]
    Noise { given: usize, joints: usize },
    #[error(transparent)]
    Motion(#[from] MotionError),
    #[error("{0}")]
    NotTold(String),
    #[error(
        "no motion around this pose holds all limits: {0}; choose another middle pose (--home), \
         a smaller --range, --clearance or --radius, or move what is in the way"
    )]
    Impossible(String),
    #[error("the designed motion breaks a limit in simulation and nothing is written: {0}")]
    Broken(String),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error("in simulation, {0}")]
    Simulation(#[from] SimulationError),
}
