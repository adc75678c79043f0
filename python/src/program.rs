//! The program `armtwin`, inside the interpreter.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line; the exit code. Wrong usage ends the process, as it does that of the program.
#[pyfunction]
pub fn main(py: Python<'_>, argv: Vec<OsString>) -> u8 {
    py.detach(|| armtwin::cli::main_of(argv))
}
