//! numpy arrays and the engine's series: `(T, n)` there, one joint after the other here.

use armtwin::series::JointSeries;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::InputError;

/// Float64, `(T, n)`, any strides.
pub type Matrix<'py> = PyReadonlyArray2<'py, f64>;

/// The samples of every joint; one copy.
pub fn series(array: &Matrix<'_>) -> JointSeries {
    let view = array.as_array();
    let (samples, joints) = view.dim();
    let transposed = view.t();
    let values = match transposed.as_slice() {
        Some(all) => all.to_vec(),
        None => transposed.iter().copied().collect(),
    };
    JointSeries::from_values(joints, samples, values)
}

/// Series of equal shapes for an arm of `dof` joints.
pub fn motion<const N: usize>(
    dof: usize,
    arrays: [(&str, &Matrix<'_>); N],
) -> PyResult<[JointSeries; N]> {
    let samples = arrays[0].1.shape()[0];
    for (name, array) in &arrays {
        if array.shape() != [samples, dof] {
            let (rows, columns) = (array.shape()[0], array.shape()[1]);
            return Err(InputError::new_err(format!(
                "{name} has the shape ({rows}, {columns}), ({samples}, {dof}) is needed: one row per \
                 sample, one column per joint"
            )));
        }
    }
    Ok(arrays.map(|(_, array)| series(array)))
}

/// `(n, T)`, without a copy: the transposed of what people see.
pub fn rows<'py>(py: Python<'py>, series: JointSeries) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let shape = [series.joints(), series.samples()];
    PyArray1::from_vec(py, series.into_values()).reshape(shape)
}
