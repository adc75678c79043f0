//! The twin beside the recording in rerun: one `.rrd` with the arms in 3D, plots, a summary.
//!
//! Knows nothing of how the numbers came about: a [`Comparison`] of one twin or the [`Mending`] of
//! one goes in, a file comes out. [`live`] sends the same to a viewer while they are worked out.

mod album;
mod arm;
mod blueprint;
mod comparison;
mod layout;
pub mod live;
mod mending;
mod palette;
mod plots;
mod scene;

#[cfg(test)]
mod tests;

pub use album::Album;
pub use comparison::{Comparison, Motion, Torque};
pub use mending::{JointMending, Mending};
pub use scene::{Shown, write_rrd};

/// Why no file was written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("{what} has {joints} joints and {samples} samples, expected {dof} and {times}")]
    Shape { what: &'static str, joints: usize, samples: usize, dof: usize, times: usize },
    #[error("nothing to show: the comparison holds no samples")]
    Empty,
    #[error("the viewer's library refused the data: {0}")]
    Log(String),
    #[error("cannot write {path}: {source}")]
    Write { path: String, source: std::io::Error },
    #[error("no viewer listens at {address} ({source})")]
    Unreachable { address: String, source: std::io::Error },
    #[error("cannot serve at {address}: {source}")]
    Serve { address: String, source: std::io::Error },
    #[error("the viewer went away: {0}")]
    Gone(String),
    #[error("the viewer has not taken everything within {0} s")]
    Stuck(u64),
}

/// Any error of the viewer's library, in its own words.
fn log_error(error: impl std::fmt::Display) -> Error {
    Error::Log(error.to_string())
}
