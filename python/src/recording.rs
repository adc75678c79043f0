//! Recordings.

use std::path::PathBuf;
use std::sync::Arc;

use armtwin::Recording as Engine;
use armtwin::recording::{self, Channel, WriteOptions};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{Matrix, rows, series};
use crate::errors::{InputError, detached, wrong};

/// Named columns on one time column.
#[pyclass(frozen, module = "armtwin._engine")]
pub struct Recording(pub Arc<Engine>);

impl Recording {
    pub fn of(engine: Engine) -> Self {
        Self(Arc::new(engine))
    }
}

#[pymethods]
impl Recording {
    /// From signals of all joints, (T, n) each, and single columns, (T,) each.
    #[staticmethod]
    fn from_arrays(
        py: Python<'_>,
        time: PyReadonlyArray1<'_, f64>,
        signals: Vec<(String, Matrix<'_>)>,
        columns: Vec<(String, PyReadonlyArray1<'_, f64>)>,
        source: String,
    ) -> PyResult<Self> {
        let time: Vec<f64> = time.as_array().to_vec();
        let mut channels = Vec::new();
        for (stem, values) in signals {
            let all = series(&values);
            let of_joint =
                |j| Channel { name: format!("{stem}_{j}"), values: all.joint(j).to_vec() };
            channels.extend((0..all.joints()).map(of_joint));
        }
        let of_column = |(name, values): (String, PyReadonlyArray1<'_, f64>)| Channel {
            name,
            values: values.as_array().to_vec(),
        };
        channels.extend(columns.into_iter().map(of_column));
        detached(py, || Engine::from_columns(time, channels, &source).map(Self::of).map_err(wrong))
    }

    #[staticmethod]
    #[pyo3(signature = (path, columns=None))]
    fn read(py: Python<'_>, path: PathBuf, columns: Option<PathBuf>) -> PyResult<Self> {
        detached(py, || recording::read(&path, columns.as_deref()).map(Self::of).map_err(wrong))
    }

    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let options = WriteOptions::default();
        detached(py, || recording::write(&self.0, &path, &options).map_err(wrong))
    }

    /// The stretch between two times, s from the first row.
    #[pyo3(signature = (start=None, end=None))]
    fn between(&self, start: Option<f64>, end: Option<f64>) -> Self {
        Self::of(self.0.between(start, end))
    }

    /// With the joints of all signals in another order.
    fn reordered(&self, order: Vec<usize>) -> PyResult<Self> {
        let mut sorted = order.clone();
        sorted.sort_unstable();
        if sorted.iter().enumerate().any(|(k, j)| k != *j) {
            return Err(InputError::new_err("order: give every joint once"));
        }
        let mut engine = Engine::clone(&self.0);
        for stem in self.0.stems() {
            let whole = (0..order.len()).all(|j| self.0.channel(&format!("{stem}_{j}")).is_some());
            for (new, old) in order.iter().enumerate().filter(|_| whole) {
                let values = self.0.channel(&format!("{stem}_{old}")).map(<[f64]>::to_vec);
                let name = format!("{stem}_{new}");
                let place = engine.channels.iter_mut().find(|c| c.name == name);
                if let (Some(channel), Some(values)) = (place, values) {
                    channel.values = values;
                }
            }
        }
        Ok(Self::of(engine))
    }

    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.time)
    }

    fn __len__(&self) -> usize {
        self.0.time.len()
    }

    /// (n, T) of a signal; `None` without it.
    fn joints<'py>(
        &self,
        py: Python<'py>,
        stem: &str,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.0.joints(stem).map(|all| rows(py, all)).transpose()
    }

    fn column<'py>(&self, py: Python<'py>, name: &str) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.channel(name).map(|values| PyArray1::from_slice(py, values))
    }

    fn columns(&self) -> Vec<String> {
        self.0.channels.iter().map(|c| c.name.clone()).collect()
    }

    fn stems(&self) -> Vec<String> {
        self.0.stems()
    }

    fn joint_count(&self) -> usize {
        self.0.joint_count("actual_q")
    }

    #[getter]
    fn source(&self) -> &str {
        &self.0.provenance.source
    }

    #[getter]
    fn format(&self) -> &str {
        &self.0.provenance.format
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.provenance.notes.clone()
    }
}
