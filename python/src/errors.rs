//! Errors of the engine as exceptions of the package, with the program's words.

use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};

use armtwin::simulation::SimulationError;
use armtwin::workflow::WorkflowError;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

pyo3::import_exception!(armtwin._errors, DoubtfulRecording);
pyo3::import_exception!(armtwin._errors, EngineFault);
pyo3::import_exception!(armtwin._errors, InputError);
pyo3::import_exception!(armtwin._errors, WorkError);

/// Something that was given and cannot be used: a file, a value, a shape.
pub fn wrong(error: impl Error) -> PyErr {
    InputError::new_err(in_words(&error))
}

/// An error and its causes, but for those that the words before hold already.
fn in_words(error: &dyn Error) -> String {
    let mut said = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let words = cause.to_string();
        if !said.contains(&words) {
            said = format!("{said}: {words}");
        }
        next = cause.source();
    }
    said
}

/// The exception of a job that came to nothing.
pub fn of_job(error: WorkflowError) -> PyErr {
    if error.is_interruption() {
        return PyKeyboardInterrupt::new_err(());
    }
    let words = in_words(&error);
    match error {
        WorkflowError::Doubted { .. } => {
            DoubtfulRecording::new_err(format!("{words}\n(force=True goes on with it as it is)"))
        }
        WorkflowError::Simulation(SimulationError::Diverged { .. }) => WorkError::new_err(words),
        _ => InputError::new_err(words),
    }
}

/// What panicked, for people who can do nothing about it but tell.
pub fn fault(why: Box<dyn std::any::Any + Send>) -> PyErr {
    let words = match why.downcast::<String>() {
        Ok(text) => *text,
        Err(other) => {
            other.downcast::<&str>().map_or_else(|_| "no words".into(), |t| t.to_string())
        }
    };
    EngineFault::new_err(format!("a fault of armtwin itself, please report it: {words}"))
}

/// Runs a short call of the engine without the interpreter; a panic is an exception.
pub fn detached<T: Send>(py: Python<'_>, call: impl FnOnce() -> PyResult<T> + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(call))).unwrap_or_else(|why| Err(fault(why)))
}
