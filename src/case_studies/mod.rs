//! The paper's case studies beside ours: its tables, its figures, and its claim that a particle
//! swarm beats least squares.
//!
//! Simulated and recorded arms are identified alike; only this room sees both the truth that was
//! injected and what was found.

pub mod boxes;
pub mod figures;
pub mod motor;
pub mod motor_figures;
mod motor_versus;
mod numbers;
pub mod page;
pub mod paper;
pub mod ur5;
pub mod versus;
mod versus_tables;
