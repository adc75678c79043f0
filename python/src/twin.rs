//! Twins and their arms.

use std::path::PathBuf;
use std::sync::Arc;

use armtwin::effects::Motion;
use armtwin::export::{Target, export};
use armtwin::files::write_whole;
use armtwin::robot::{self, inverse_dynamics_series, mass_matrix_series, regressor_series, urdf};
use armtwin::twin::Twin as Engine;
use armtwin::workflow::{Arm, Said};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{Matrix, motion, rows};
use crate::errors::{InputError, detached, wrong};

/// What is known about an arm.
#[pyclass(frozen, module = "armtwin._engine")]
pub struct Twin(pub Arc<Arm>);

impl Twin {
    pub fn of(twin: Engine) -> Self {
        Self::said(twin, Said::Given)
    }

    fn said(twin: Engine, said: Said) -> Self {
        Self(Arc::new(Arm { twin, said, scaled: true }))
    }

    fn robot(&self) -> &robot::Robot {
        &self.0.twin.robot
    }
}

#[pymethods]
impl Twin {
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let twin = detached(py, || Engine::load(&path).map_err(wrong))?;
        Ok(Self::said(twin, Said::Twin(path)))
    }

    /// From the text of a `TWIN.toml`. `undriven`: of its drive nothing was said.
    #[staticmethod]
    fn parse(py: Python<'_>, text: String, file: PathBuf, undriven: bool) -> PyResult<Self> {
        let twin = detached(py, || Engine::parse(&text, &file).map_err(wrong))?;
        let said = if undriven { Said::Undriven(twin.source.clone()) } else { Said::Given };
        Ok(Self::said(twin, said))
    }

    /// A built-in arm by name, of whose friction nothing is known.
    #[staticmethod]
    fn builtin(py: Python<'_>, name: String) -> PyResult<Self> {
        let twin = detached(py, || Engine::of_robot(&name).map_err(wrong))?;
        Ok(Self::said(twin, Said::Robot(name)))
    }

    #[staticmethod]
    fn builtins() -> Vec<&'static str> {
        robot::BUILT_IN.iter().map(|table| table.name).collect()
    }

    /// Under another name, in another gravity (m/s2).
    fn renamed(&self, source: String, gravity: [f64; 3]) -> Self {
        let mut arm = Arm::clone(&self.0);
        arm.twin.source = source.clone();
        arm.twin.robot.gravity = gravity.into();
        if let Said::Undriven(name) = &mut arm.said {
            *name = source;
        }
        Self(Arc::new(arm))
    }

    /// Writes the twin, and its arm beside it where that is in no file.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        detached(py, || {
            let mut twin = self.0.twin.clone();
            // An arm that no URDF holds: from arrays, or from a MuJoCo model.
            if armtwin::twin::read_robot(&twin.source, &twin.chain, &path).is_err() {
                let beside = path.with_extension("urdf");
                let text = urdf::write(&twin.robot);
                write_whole(&beside, |out| out.write_all(text.as_bytes()))
                    .map_err(|e| InputError::new_err(format!("{}: {e}", beside.display())))?;
                let absolute = std::path::absolute(&beside).unwrap_or(beside);
                twin.source = absolute.display().to_string();
                twin.chain = robot::Chain::default();
            }
            twin.save(&path).map_err(wrong)
        })
    }

    fn to_toml(&self) -> String {
        self.0.twin.to_toml()
    }

    fn to_urdf(&self) -> String {
        urdf::write(&self.0.twin.robot)
    }

    /// As MJCF or URDF, with what that cannot hold.
    fn export(&self, py: Python<'_>, mjcf: bool) -> PyResult<(String, Vec<String>)> {
        let target = if mjcf { Target::Mjcf } else { Target::Urdf };
        detached(py, || {
            let exported = export(&self.0.twin, target, &self.0.twin.source);
            Ok((exported.text, exported.left.iter().map(ToString::to_string).collect()))
        })
    }

    #[getter]
    fn source(&self) -> &str {
        &self.0.twin.source
    }

    #[getter]
    fn dof(&self) -> usize {
        self.robot().dof()
    }

    #[getter]
    fn joints(&self) -> Vec<String> {
        self.robot().bodies.iter().map(|b| b.joint.name.clone()).collect()
    }

    #[getter]
    fn effects(&self) -> Vec<String> {
        self.0.twin.effects.clone()
    }

    #[getter]
    fn values(&self) -> std::collections::BTreeMap<String, Vec<f64>> {
        self.0.twin.values.clone()
    }

    #[getter]
    fn rotor_inertia(&self) -> Vec<f64> {
        self.0.twin.drive.rotor_inertia.clone()
    }

    #[getter]
    fn torque_per_ampere(&self) -> Vec<f64> {
        (0..self.dof()).map(|j| self.0.twin.drive.torque_per_ampere(j)).collect()
    }

    #[getter]
    fn mass(&self) -> f64 {
        self.robot().mass()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.twin.notes.clone()
    }

    /// (n, T): what the drive must supply, N.m.
    fn torque<'py>(
        &self,
        py: Python<'py>,
        q: Matrix<'py>,
        qd: Matrix<'py>,
        qdd: Matrix<'py>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let [q, qd, qdd] = motion(self.dof(), [("q", &q), ("qd", &qd), ("qdd", &qdd)])?;
        let twin = &self.0.twin;
        let torque =
            detached(py, || Ok(twin.torque(&Motion::new(&twin.robot, dt, &q, &qd, &qdd))))?;
        rows(py, torque)
    }

    /// (n, T): M(q) qdd + C(q, qd) qd + g(q) of the bodies alone, N.m.
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: Matrix<'py>,
        qd: Matrix<'py>,
        qdd: Matrix<'py>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let [q, qd, qdd] = motion(self.dof(), [("q", &q), ("qd", &qd), ("qdd", &qdd)])?;
        let robot = self.robot();
        rows(py, detached(py, || Ok(inverse_dynamics_series(robot, &q, &qd, &qdd)))?)
    }

    /// (T, n, n), kg.m2.
    fn mass_matrix<'py>(
        &self,
        py: Python<'py>,
        q: Matrix<'py>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let n = self.dof();
        let [q] = motion(n, [("q", &q)])?;
        let robot = self.robot();
        let values = detached(py, || Ok(mass_matrix_series(robot, &q)))?;
        PyArray1::from_vec(py, values).reshape([q.samples(), n, n])
    }

    /// (T, n, 10 n): torque is this times the bodies' inertial parameters.
    fn regressor<'py>(
        &self,
        py: Python<'py>,
        q: Matrix<'py>,
        qd: Matrix<'py>,
        qdd: Matrix<'py>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let n = self.dof();
        let [q, qd, qdd] = motion(n, [("q", &q), ("qd", &qd), ("qdd", &qdd)])?;
        let robot = self.robot();
        let values = detached(py, || Ok(regressor_series(robot, &q, &qd, &qdd)))?;
        PyArray1::from_vec(py, values).reshape([q.samples(), n, 10 * n])
    }

    /// Ten per body: mass, first moments, inertia about the joint's frame.
    fn inertial_parameters(&self) -> Vec<f64> {
        self.robot().bodies.iter().flat_map(|b| b.inertia.parameters()).collect()
    }

    /// For pickles.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        ciborium::into_writer(&*self.0, &mut bytes).map_err(wrong)?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let arm = ciborium::from_reader(bytes)
            .map_err(|e| InputError::new_err(format!("not a pickled twin: {e}")))?;
        Ok(Self(Arc::new(arm)))
    }
}
