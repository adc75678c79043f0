//! Simulated recordings, motions, and what can be hidden in them.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use armtwin::effects::CATALOGUE;
use armtwin::motion::Settings;
use armtwin::twin::PerJoint;
use armtwin::workflow::{Simulate, WorkflowError};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use serde_json::json;

use crate::arrays::rows;
use crate::errors::{InputError, detached, wrong};
use crate::recording::Recording;
use crate::twin::Twin;
use crate::work;

type Hidden = BTreeMap<String, BTreeMap<String, PerJoint>>;

/// (fit, check, truth as JSON). `scenario` and `hidden` are JSON; a `file` stands in place of both and the
/// twin.
#[pyfunction]
#[pyo3(signature = (twin, scenario, hidden, file, listener))]
pub fn simulate(
    twin: Option<&Twin>,
    scenario: &str,
    hidden: &str,
    file: Option<PathBuf>,
    listener: &Bound<'_, PyAny>,
) -> PyResult<(Recording, Recording, String)> {
    let mut how = match &file {
        Some(file) => Simulate::load(file).map_err(wrong)?,
        None => Simulate { scenario: serde_json::from_str(scenario).map_err(wrong)? },
    };
    let hidden: Hidden =
        serde_json::from_str(hidden).map_err(|e| InputError::new_err(format!("effects: {e}")))?;
    for (effect, values) in hidden {
        how = how.hide_each(&effect, values).map_err(wrong)?;
    }
    let arm = twin.map(|twin| Arc::clone(&twin.0));
    let done = work::run(listener, move |watch| match (arm, file) {
        (Some(arm), _) => how.run(&arm.twin, watch),
        (None, Some(file)) => how.run_as_written(&file.display().to_string(), watch),
        (None, None) => Err(WorkflowError::Asked("name a twin or a scenario file".into())),
    })?;
    let truth = serde_json::to_string(&done.truth()).map_err(wrong)?;
    Ok((Recording::of(done.fit.recording), Recording::of(done.check.recording), truth))
}

type Sampled<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
);

/// Time (T,) and (n, T) of position, velocity and acceleration of a motion of this arm, every `dt` s.
#[pyfunction]
pub fn trajectory<'py>(
    py: Python<'py>,
    twin: &Twin,
    settings: &str,
    dt: f64,
) -> PyResult<Sampled<'py>> {
    let settings: Settings = serde_json::from_str(settings).map_err(wrong)?;
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(InputError::new_err(format!("dt = {dt}: give seconds above 0")));
    }
    let robot = &twin.0.twin.robot;
    let sampled = detached(py, || Ok(settings.trajectory(robot).map_err(wrong)?.sampled(dt)))?;
    let time = (0..sampled.q.samples()).map(|k| k as f64 * dt).collect();
    let time = PyArray1::from_vec(py, time);
    Ok((time, rows(py, sampled.q)?, rows(py, sampled.qd)?, rows(py, sampled.qdd)?))
}

/// The catalogue as JSON.
#[pyfunction]
pub fn effects() -> String {
    let all: Vec<_> = CATALOGUE
        .iter()
        .map(|effect| {
            let about = effect.about();
            json!({
                "name": about.name, "law": about.law, "cause": about.cause, "remedy": about.remedy,
                "source": about.source, "parameters": about.parameters,
            })
        })
        .collect();
    json!(all).to_string()
}
