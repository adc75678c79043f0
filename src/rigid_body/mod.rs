//! The inertial parameters of all links: which combinations a motion determines, and which values are
//! those of a body that can exist.

mod base;
pub mod parameters;
mod posterior;
mod pseudo_inertia;

pub use base::BaseParameters;
pub use posterior::{Estimate, Information, estimate, estimate_within};
pub use pseudo_inertia::{is_possible, made_possible, possible};
