//! Identification and diagnosis.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use armtwin::diagnosis::{JointTraces, TWIN};
use armtwin::files::write_whole;
use armtwin::identification::{Method, Search};
use armtwin::viewer::write_rrd;
use armtwin::workflow::{self, Diagnose, Identify, KnownLoad, Reading, SignalOptions};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays::rows;
use crate::errors::{InputError, detached, of_job, wrong};
use crate::recording::Recording;
use crate::twin::Twin;
use crate::work;

fn parsed<'a, T: Deserialize<'a>>(json: &'a str) -> PyResult<T> {
    serde_json::from_str(json).map_err(wrong)
}

fn text(document: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(document).map_err(wrong)
}

/// How recordings are taken and conditioned, in every job.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Taken {
    signals: SignalOptions,
    every_row: bool,
    force: bool,
}

impl Taken {
    fn reading(&self) -> Reading {
        Reading { every_row: self.every_row, force: self.force }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct IdentifyOptions {
    terms: Vec<String>,
    with: Vec<String>,
    methods: Vec<String>,
    direct_cost: bool,
    reduce: bool,
    bounds: BTreeMap<String, [f64; 2]>,
    seed: u64,
    total_mass: Option<f64>,
    payload: Option<f64>,
    payload_centre: Option<[f64; 3]>,
    taken: Taken,
}

impl IdentifyOptions {
    fn wanted(&self) -> PyResult<Identify> {
        let method = |name: &String| match name.as_str() {
            "pso" => Ok(Method::Pso),
            "nlse" => Ok(Method::Nlse),
            "mcmc" => Ok(Method::Mcmc),
            other => {
                Err(InputError::new_err(format!("method {other}: choose from pso, nlse, mcmc")))
            }
        };
        let methods: Vec<Method> = self.methods.iter().map(method).collect::<PyResult<_>>()?;
        let cost = if self.direct_cost { Search::Direct } else { Search::Quadratic };
        let bounds = self.bounds.iter().map(|(name, range)| (name.clone(), *range)).collect();
        let wanted = Identify { bounds, ..Identify::default() };
        Ok(wanted
            .terms(self.terms.clone())
            .with(self.with.clone())
            .methods(methods)
            .cost(cost)
            .seed(self.seed)
            .reduce(self.reduce)
            .total_mass(self.total_mass)
            .signals(self.taken.signals.clone())
            .reading(self.taken.reading()))
    }
}

/// A result of [`identify`].
#[pyclass(frozen, module = "armtwin._engine")]
pub struct Identified(workflow::Identified);

#[pyfunction]
#[pyo3(signature = (twin, fit, check, loaded, options, listener))]
pub fn identify(
    twin: &Twin,
    fit: &Recording,
    check: Option<&Recording>,
    loaded: Option<&Recording>,
    options: &str,
    listener: &Bound<'_, PyAny>,
) -> PyResult<Identified> {
    let options: IdentifyOptions = parsed(options)?;
    let wanted = options.wanted()?;
    wanted.check().map_err(of_job)?;
    let load =
        options.payload.map(|mass_kg| KnownLoad { mass_kg, centre_m: options.payload_centre });
    let [fit, check, loaded] =
        [Some(fit), check, loaded].map(|recording| recording.map(|r| Arc::clone(&r.0)));
    let arm = Arc::clone(&twin.0);
    work::run(listener, move |watch| {
        let mut arm = armtwin::workflow::Arm::clone(&arm);
        arm.scaled = loaded.is_none();
        let floor_hz = wanted.signals.floor_hz();
        let take = |recording: &Arc<armtwin::Recording>| {
            let borrowed = std::borrow::Cow::Owned(armtwin::Recording::clone(recording));
            wanted.reading.take(borrowed, &arm, floor_hz, watch)
        };
        match (&fit, &loaded, load) {
            (Some(fit), Some(run), Some(load)) => {
                let loaded = Some((take(run)?, load));
                let check = check.as_ref().map(take).transpose()?;
                wanted.on(&arm, take(fit)?, check, loaded, watch)
            }
            (Some(fit), ..) => wanted.run(&arm, fit, check.as_deref(), watch),
            (None, ..) => Err(workflow::WorkflowError::Asked("give a recording".into())),
        }
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DiagnoseOptions {
    without: Vec<String>,
    seed: u64,
    mass_error: f64,
    centre_error_m: f64,
    simulate: bool,
    taken: Taken,
}

/// A result of [`diagnose`].
#[pyclass(frozen, module = "armtwin._engine")]
pub struct Diagnosed(workflow::Diagnosed);

#[pyfunction]
#[pyo3(signature = (twin, fit, check, options, listener))]
pub fn diagnose(
    twin: &Twin,
    fit: &Recording,
    check: Option<&Recording>,
    options: &str,
    listener: &Bound<'_, PyAny>,
) -> PyResult<Diagnosed> {
    let options: DiagnoseOptions = parsed(options)?;
    let wanted = Diagnose::default()
        .without(options.without)
        .seed(options.seed)
        .mass_error(options.mass_error)
        .centre_error_m(options.centre_error_m)
        .simulated(options.simulate)
        .reading(options.taken.reading())
        .signals(options.taken.signals);
    let (arm, fit, check) = (&twin.0, &fit.0, check.map(|r| Arc::clone(&r.0)));
    work::run(listener, move |watch| {
        let mut done = wanted.run(&**arm, fit, check.as_deref(), watch)?;
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

type Prediction<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<bool>>,
);

/// Time (T,), (n, T) of predicted and recorded torque (N.m), and where joints slide.
#[pyfunction]
pub fn predict<'py>(
    py: Python<'py>,
    twin: &Twin,
    recording: &Recording,
    signals: &str,
) -> PyResult<Prediction<'py>> {
    let signals: SignalOptions = parsed(signals)?;
    let (twin, recording) = (&twin.0.twin, &recording.0);
    let found = detached(py, || workflow::predict(twin, recording, &signals).map_err(of_job))?;
    let slides = PyArray2::from_vec2(py, &found.slides).map_err(wrong)?;
    let time = PyArray1::from_vec(py, found.time);
    Ok((time, rows(py, found.torque)?, rows(py, found.measured)?, slides))
}

/// Writes a text under `path`, whole or not at all, over nothing that somebody else wrote.
#[pyfunction]
pub fn write_text(py: Python<'_>, path: PathBuf, content: String) -> PyResult<()> {
    detached(py, || {
        write_whole(&path, |out| out.write_all(content.as_bytes()))
            .map_err(|e| InputError::new_err(format!("{}: {e}", path.display())))
    })
}
