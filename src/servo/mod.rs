//! Arms of position servos, of which command and position are recorded and no torque: the twin is led
//! along the recorded command, and its position is compared with the recorded one.
//!
//! [`Plant`] steps the few joints of such an arm with dry friction as a constraint; rapier remains what it
//! is held against. [`replay`] leads a twin along a recording. [`identify`] fits what a twin leaves open by
//! output error over stretches that begin in measured states, with the simulation's tangent for its columns;
//! [`PositionGap`] says what is left. [`linearised`] hands what a simulation leaves of recorded positions to the
//! diagnosis, beside its sensitivities.

mod arm;
mod choice;
mod diagnose;
mod error;
mod fit;
mod folds;
mod following;
mod gap;
mod judge;
mod linear;
mod loss;
mod parameters;
mod plant;
mod problem;
mod refit;
mod replay;
mod scatter;
mod screen;
mod sift;
mod sizes;
mod step;
mod stick;
mod tangent;
#[cfg(test)]
mod tests;
mod time_offset;
mod track;
mod wound;
mod yardstick;

pub use diagnose::{Found, diagnose};
pub use error::ServoError;
pub use fit::{Estimate, Fitted, Settings, identify};
pub use following::{AsSent, Following};
pub use gap::{JointPosition, PositionGap};
pub use linear::linearised;
pub use parameters::{Free, free_parameters};
pub use plant::{Plant, Yield};
pub use refit::open_fitted;
pub use replay::replay;
pub use track::Track;
