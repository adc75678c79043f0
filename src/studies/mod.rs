//! Long measurements over many seeds: simulate, identify, hold against the truth.

pub mod detectability;
pub mod recovery;
