//! The rigid arm: tables -> URDF -> [`Robot`], its dynamics, and the drive that moves it.

mod drive;
mod model;

pub use drive::Drive;
pub use model::{Body, Inertia, Joint, Limits, Placement, Robot};
