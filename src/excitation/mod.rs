//! Optimal excitation: a motion within limits that tells what is asked for as sharply as can be.
//!
//! A finite Fourier series per joint (Swevers et al., IEEE Trans. Robotics and Automation 13(5), 1997)
//! whose coefficients and middle pose an evolution strategy varies. It is D-optimal: the determinant
//! of the information about the parameters asked for is as large as it can find ([`information`]).
//! Limits of angle, speed and acceleration hold by construction ([`candidate`]); torque and
//! collisions come first in the ranking (Deb, *Computer Methods in Applied Mechanics and
//! Engineering* 186, 2000): a motion that breaks them is worse than any that does not. What is found
//! is simulated, with everything the twin knows, before anybody may have it.

mod ask;
mod baseline;
mod candidate;
mod capsules;
mod columns;
mod design;
mod error;
mod evolution;
mod geometry;
mod information;
mod limits;
mod question;
mod report;
mod request;
mod scenario;
mod simulated;
pub mod write;

#[cfg(test)]
mod tests;

pub use ask::{Ask, AskError, Term};
pub use capsules::{Capsules, Closest, Surroundings};
pub use design::{Design, design};
pub use error::ExcitationError;
pub use geometry::Cuboid;
pub use limits::{Held, Reached};
pub use report::{Baseline, Group, Report, Told, page};
pub use request::Request;
