//! Identification and diagnosis.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use armtwin::Recording as Engine;
use armtwin::diagnosis::{JointTraces, TWIN};
use armtwin::files::write_whole;
use armtwin::viewer::write_rrd;
use armtwin::workflow::{self, Arm, Diagnose, Identify, KnownLoad, SignalOptions, WorkflowError};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::arrays::{Column, Rows, rows};
use crate::errors::{InputError, detached, of_job, wrong};
use crate::recording::Recording;
use crate::twin::Twin;
use crate::work;

fn parsed<T: DeserializeOwned>(json: &str) -> PyResult<T> {
    // By way of a value, whose errors speak of no line that nobody wrote.
    let value: serde_json::Value = serde_json::from_str(json).map_err(wrong)?;
    serde_json::from_value(value).map_err(wrong)
}

fn text(document: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(document).map_err(wrong)
}

/// A recording of an arm that carries a load of so many kg, its centre (m) in the flange's frame.
type Loaded<'py> = (PyRef<'py, Recording>, f64, Option<[f64; 3]>);

/// A result of [`identify`].
#[pyclass(frozen, module = "armtwin._engine")]
pub struct Identified(workflow::Identified);

/// `options` are those of [`Identify`] as JSON.
#[pyfunction]
#[pyo3(signature = (twin, fit, check, loaded, options, listener))]
pub fn identify(
    twin: &Twin,
    fit: &Recording,
    check: Option<&Recording>,
    loaded: Option<Loaded<'_>>,
    options: &str,
    listener: &Bound<'_, PyAny>,
) -> PyResult<Identified> {
    let wanted: Identify = parsed(options)?;
    wanted.check().map_err(of_job)?;
    let mut arm = Arm::clone(&twin.0);
    arm.scaled = loaded.is_none();
    let loaded = loaded
        .map(|(run, mass_kg, centre_m)| (Arc::clone(&run.0), KnownLoad { mass_kg, centre_m }));
    let (fit, check) = (&fit.0, check.map(|r| &*r.0));
    work::run(listener, move |watch| {
        let (fit, check) = wanted.reading.both(&arm, fit, check, watch)?;
        let take = |(run, load): &(Arc<Engine>, KnownLoad)| -> Result<_, WorkflowError> {
            Ok((wanted.reading.take(Cow::Owned(Engine::clone(run)), &arm, watch)?, *load))
        };
        let loaded = loaded.as_ref().map(take).transpose()?;
        wanted.on(&arm, fit, check, loaded, watch)
    })
    .map(Identified)
}

#[pymethods]
impl Identified {
    /// The contract's document.
    fn json(&self) -> PyResult<String> {
        text(&self.0.document())
    }

    /// The twin with the values found.
    fn fitted(&self, py: Python<'_>) -> PyResult<Option<Twin>> {
        detached(py, || Ok(self.0.fitted().map_err(wrong)?.map(|(twin, _)| Twin::of(twin))))
    }

    fn html(&self, py: Python<'_>) -> PyResult<String> {
        detached(py, || self.0.html().map_err(of_job))
    }
}

/// A result of [`diagnose`].
#[pyclass(frozen, module = "armtwin._engine")]
pub struct Diagnosed(workflow::Diagnosed);

/// `options` are those of [`Diagnose`] as JSON.
#[pyfunction]
#[pyo3(signature = (twin, fit, check, options, listener))]
pub fn diagnose(
    twin: &Twin,
    fit: &Recording,
    check: Option<&Recording>,
    options: &str,
    listener: &Bound<'_, PyAny>,
) -> PyResult<Diagnosed> {
    let wanted: Diagnose = parsed(options)?;
    let (arm, fit, check) = (&*twin.0, &fit.0, check.map(|r| &*r.0));
    work::run(listener, move |watch| {
        let mut done = wanted.run(arm, fit, check, watch)?;
        let next = &mut done.diagnosis.next_experiment;
        *next = next.replace(TWIN, " --twin twin.toml");
        Ok(done)
    })
    .map(Diagnosed)
}

/// One joint of the check recording, sample by sample.
type Trace<'py> = (usize, [Bound<'py, PyArray1<f64>>; 4]);

#[pymethods]
impl Diagnosed {
    /// The contract's document.
    fn json(&self) -> PyResult<String> {
        text(&self.0.document())
    }

    #[getter]
    fn sentence(&self) -> String {
        self.0.sentence()
    }

    #[getter]
    fn twin(&self) -> Twin {
        Twin::of(self.0.twin.clone())
    }

    #[getter]
    fn mended(&self) -> Twin {
        Twin::of(self.0.mended.clone())
    }

    /// (joint from 1, [time s, recorded torque, gap before, gap after in N.m]).
    fn traces<'py>(&self, py: Python<'py>) -> Vec<Trace<'py>> {
        let array = |values: &[f64]| PyArray1::from_slice(py, values);
        let one = |t: &JointTraces| {
            (t.joint, [array(&t.time), array(&t.torque), array(&t.before), array(&t.after)])
        };
        self.0.traces.joints.iter().map(one).collect()
    }

    fn html(&self, py: Python<'_>) -> PyResult<String> {
        detached(py, || Ok(self.0.html()))
    }

    /// Writes the scene for the viewer.
    fn rerun(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        detached(py, || write_rrd(&self.0.scene(), &path).map_err(wrong))
    }
}

/// Time (T,), (n, T) of predicted and recorded torque (N.m), and where joints slide.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn predict<'py>(
    py: Python<'py>,
    twin: &Twin,
    recording: &Recording,
    signals: &str,
) -> PyResult<(Column<'py>, [Rows<'py>; 2], Bound<'py, PyArray2<bool>>)> {
    let signals: SignalOptions = parsed(signals)?;
    let (twin, recording) = (&twin.0.twin, &recording.0);
    let found = detached(py, || workflow::predict(twin, recording, &signals).map_err(of_job))?;
    let slides = PyArray2::from_vec2(py, &found.slides).map_err(wrong)?;
    let torque = [rows(py, found.torque)?, rows(py, found.measured)?];
    Ok((PyArray1::from_vec(py, found.time), torque, slides))
}

/// Writes a text under `path`, whole or not at all, over nothing that somebody else wrote.
#[pyfunction]
pub fn write_text(py: Python<'_>, path: PathBuf, content: String) -> PyResult<()> {
    detached(py, || {
        write_whole(&path, |out| out.write_all(content.as_bytes()))
            .map_err(|e| InputError::new_err(format!("{}: {e}", path.display())))
    })
}
