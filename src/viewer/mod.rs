//! The twin beside the recording in rerun: one `.rrd` with the arm twice in 3D, plots, a summary.
//!
//! Knows nothing of how the numbers came about: a [`Comparison`] goes in, a file comes out.

mod arm;
mod comparison;
mod layout;
mod palette;
mod plots;
mod scene;

#[cfg(test)]
mod tests;

pub use comparison::{Comparison, Motion, Torque};
pub use scene::write_rrd;

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
}

/// Any error of the viewer's library, in its own words.
fn log_error(error: impl std::fmt::Display) -> Error {
    Error::Log(error.to_string())
}
