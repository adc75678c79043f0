//! The twin moved again as a recording was: along its command, or by its torque.
//!
//! Closed loop: computed torque leads the twin along the recorded command; what its position and
//! torque differ by from the recorded ones is the simulation gap, controller included. Open loop: the
//! recorded torque drives the twin for a moment from a recorded state; no controller is in it.

mod arm;
mod closed_loop;
mod command;
mod errors;
mod open_loop;

pub use arm::injections;
pub use closed_loop::{Replayed, closed_loop};
pub use command::command;
pub use errors::{Errors, errors};
pub use open_loop::{WINDOW_S, open_loop};

use crate::signals::SignalError;
use crate::simulation::{ClockError, PlantError, SimulationError};

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ResimulationError {
    #[error(transparent)]
    Signals(#[from] SignalError),
    #[error(transparent)]
    Clock(#[from] ClockError),
    #[error(transparent)]
    Plant(#[from] PlantError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error("the {0} motion holds numbers that are not finite: it cannot be followed")]
    Motion(&'static str),
    #[error("no stretch of {seconds} s without a gap: nothing to drive by the recorded torque")]
    NoWindow { seconds: f64 },
}

#[cfg(test)]
mod tests;
