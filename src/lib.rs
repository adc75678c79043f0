//! A simulation-in-the-loop digital twin of a robot arm that says why it is wrong.
//!
//! One-way flow, left to right (see ARCHITECTURE.md):
//!
//! tables -> `robot`; `robot` + `effects` + `motion` -> `simulation` -> `recording` <- importers;
//! `recording` -> `signals` -> `identification` (with `statistics`) -> `report`, `viewer`.
//!
//! The program's jobs are one call each ([`workflow`]):
//!
//! ```
//! use armtwin::motion::{Kind, Settings};
//! use armtwin::{Twin, diagnose, identify, simulate};
//!
//! # fn main() -> Result<(), armtwin::workflow::WorkflowError> {
//! let mut twin = Twin::default(); // a UR5; or Twin::load("my_arm.toml".as_ref())?
//! twin.drive.rotor_inertia = vec![1.1, 1.1, 1.1, 0.14, 0.14, 0.14]; // kg.m2
//! let motion = Settings { kind: Kind::RandomFrequency, duration_s: 20.0, ..Settings::default() };
//! let hidden: [(&str, &[(&str, f64)]); 3] = [
//!     ("coulomb", &[("coulomb", 5.0)]),
//!     ("viscous", &[("viscous", 8.0)]),
//!     ("payload", &[("mass", 2.0)]),
//! ];
//! let arm = simulate(&twin, &motion, &hidden)?;
//! let (fit, check) = (&arm.fit.recording, &arm.check.recording);
//!
//! let friction = identify(&twin, fit, check)?; // what the twin leaves open
//! assert_eq!(friction.results[0].joints[1].parameters[0].name, "coulomb");
//! let found = diagnose(&twin, fit, check)?; // what it lacks
//! assert_eq!(found.diagnosis.causes[0].effect, "payload");
//! println!("{}", found.sentence());
//! # Ok(())
//! # }
//! ```
//!
//! Units are SI throughout (rad, rad/s, N.m, A, s, kg) unless a name says otherwise; joints count
//! from 0 in code and from 1 in everything a user reads.

#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::todo, clippy::dbg_macro)
)]

#[cfg(feature = "studies")]
pub mod case_studies;
#[cfg(feature = "cli")]
pub mod cli;
pub mod diagnosis;
pub mod effects;
pub mod excitation;
pub mod export;
pub mod external_wrench;
pub mod figure;
pub mod files;
pub mod follow;
pub mod identification;
pub mod kernels;
pub mod limits;
#[cfg(feature = "live")]
pub mod live;
pub mod motion;
#[cfg(feature = "studies")]
pub mod motor;
pub mod numbers;
pub mod plausibility;
pub mod recording;
pub mod regression;
pub mod report;
pub mod resimulation;
pub mod rigid_body;
pub mod robot;
#[cfg(feature = "live")]
pub mod rtde;
pub mod series;
pub mod servo;
pub mod signals;
pub mod simulation;
pub mod statistics;
#[cfg(feature = "studies")]
pub mod studies;
pub mod text;
#[cfg(feature = "studies")]
pub mod trials;
pub mod twin;
#[cfg(feature = "viewer")]
pub mod viewer;
pub mod watch;
pub mod workflow;

pub use recording::Recording;
pub use twin::Twin;
pub use workflow::{diagnose, identify, simulate};
