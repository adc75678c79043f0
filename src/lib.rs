//! A simulation-in-the-loop digital twin of a robot arm that says why it is wrong.
//!
//! One-way flow, left to right (see ARCHITECTURE.md):
//!
//! tables -> `robot`; `robot` + `effects` + `motion` -> `simulation` -> `recording` <- importers;
//! `recording` -> `signals` -> `identification` (with `statistics`) -> `report`, `viewer`.
//!
//! Units are SI throughout (rad, rad/s, N.m, A, s, kg) unless a name says otherwise; joints count
//! from 0 in code and from 1 in everything a user reads.

#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::todo, clippy::dbg_macro)
)]

pub mod case_studies;
pub mod cli;
pub mod diagnosis;
pub mod effects;
pub mod excitation;
pub mod export;
pub mod external_wrench;
pub mod files;
pub mod identification;
pub mod kernels;
pub mod limits;
pub mod motion;
pub mod motor;
pub mod plausibility;
pub mod recording;
pub mod regression;
pub mod report;
pub mod resimulation;
pub mod rigid_body;
pub mod robot;
pub mod series;
pub mod servo;
pub mod signals;
pub mod simulation;
pub mod statistics;
pub mod studies;
pub mod trials;
pub mod twin;
#[cfg(feature = "viewer")]
pub mod viewer;
