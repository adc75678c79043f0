//! The engine of the Python package `armtwin`: conversions between numpy and the engine's types, and
//! nothing that decides. The package (`package/armtwin`) is what people see.
//!
//! Every call releases the interpreter while the engine works, long work runs beside the calling thread
//! (`work`), and what panics becomes an exception (`errors`).

mod arrays;
mod errors;
mod jobs;
mod program;
mod recording;
mod simulation;
mod twin;
mod work;

/// Thin functions and handles; see the package's documentation.
#[pyo3::pymodule(gil_used = true)]
mod _engine {
    #[pymodule_export]
    use super::jobs::{Diagnosed, Identified, diagnose, identify, predict, write_text};
    #[pymodule_export]
    use super::program::main;
    #[pymodule_export]
    use super::recording::Recording;
    #[pymodule_export]
    use super::simulation::{effects, simulate, trajectory};
    #[pymodule_export]
    use super::twin::Twin;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
