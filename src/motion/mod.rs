//! Excitation and validation trajectories within the limits of the arm.
//!
//! [`Settings`] (a scenario's `[motion]` table) and a robot make a [`Trajectory`]: joint position,
//! velocity and acceleration as closed-form functions of time, with continuous jerk, at rest at
//! both ends. The same settings and seed give the same trajectory to the last bit.
//! A new kind of motion is one function that fills a [`path::Path`] and one line in [`Kind`].

mod envelope;
mod mixed;
mod path;
mod peaks;
mod plateaus;
mod point_to_point;
mod series;
mod settings;
mod spline;
mod trajectory;
mod waves;

#[cfg(test)]
mod tests;

pub use envelope::Envelope;
pub use series::Series;
pub use settings::{Kind, MotionError, Settings};
pub use spline::Spline;
pub use trajectory::{Sampled, Trajectory};
