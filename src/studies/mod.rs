//! Long measurements over many seeds: simulate, identify, hold against the truth.

pub mod alarms;
pub mod detectability;
mod error;
pub mod excitation;
pub mod links;
pub mod recovery;
mod strength;
pub mod sweep;

pub use error::StudyError;
