//! One joint's regression problem: which friction makes the rigid twin's torque the measured one?
//!
//! y = F(tau - tau_rigid) = sum of F(columns) x parameters + noise, with the same zero-phase
//! low-pass F for torque and regressors alike, then masked to sliding samples and decimated.
//!
//! The friction law is the paper's Eq. 1, w the joint velocity, s = sign(w):
//!
//! T_f = T_c s + (T_s - T_c) exp(-|w / w_s|) s + T_v1 w + T_v2 s w^2 + T_v3 w^3
//!
//! linear in all but w_s.

use std::fmt;
use std::sync::Arc;

use super::Goodness;
use super::levenberg_marquardt::Residuals;
use crate::kernels::{axpy, dot, stribeck};
use crate::regression::bounds::{Bounds, BoundsError};
use crate::statistics::{self, Cycle};

/// A parameter that is searched for.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Parameter {
    pub name: String,
    pub unit: String,
    pub lower: f64,
    pub upper: f64,
}

/// A regressor whose parameter enters linearly: N.m per unit at every kept sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    pub parameter: Parameter,
    pub values: Vec<f64>,
    /// The linear parameters that a nonlinear one's slope hangs on; empty for a linear parameter.
    pub slope_of: Arc<[&'static str]>,
    /// Where a slope was worked out: `y` holds this times `values` on top of the torque; zero for a
    /// linear parameter.
    pub centre: f64,
}

impl Column {
    /// Column of a parameter that enters linearly.
    pub fn linear(parameter: Parameter, values: Vec<f64>) -> Self {
        Self { parameter, values, slope_of: Arc::default(), centre: 0.0 }
    }
}

/// From columns at every sample to the kept samples: filter, mask, decimate. Linear.
pub type Reduce = Arc<dyn Fn(Vec<Vec<f64>>) -> Vec<Vec<f64>> + Send + Sync>;

/// Coulomb friction with a Stribeck curve, the part of Eq. 1 that w_s bends.
#[derive(Clone)]
pub struct Curve {
    pub coulomb: Parameter,
    /// The level at vanishing speed, T_s.
    pub static_level: Parameter,
    /// w_s, rad/s
    pub velocity: Parameter,
    /// 1 in the paper.
    pub exponent: f64,
    /// Joint velocity at every sample, rad/s.
    pub speed: Vec<f64>,
    pub reduce: Reduce,
    /// F(s) at the kept samples.
    pub sign: Vec<f64>,
}

/// `y` against columns, for one joint.
#[derive(Debug, Clone)]
pub struct JointProblem {
    /// From 1 at the base.
    pub joint: usize,
    /// Time between neighbours in a run, s.
    pub dt: f64,
    /// Measured torque F(tau), N.m.
    pub measured: Vec<f64>,
    /// What the rigid twin leaves unexplained of it, N.m.
    pub y: Vec<f64>,
    pub columns: Vec<Column>,
    pub curve: Option<Curve>,
    /// |velocity| at the kept samples, rad/s.
    pub speed: Vec<f64>,
    /// When each sample was taken, in steps of `dt`: masked samples leave gaps.
    pub slots: Vec<usize>,
    /// Where the motion comes again.
    pub cycle: Option<Cycle>,
}

impl Curve {
    /// Column F(s exp(-|w / w_s|^a)) at the kept samples.
    pub fn column(&self, velocity: f64) -> Vec<f64> {
        self.columns(&[velocity]).remove(0)
    }

    /// Columns at several w_s: filters run fastest on many columns.
    pub fn columns(&self, velocities: &[f64]) -> Vec<Vec<f64>> {
        (self.reduce)(velocities.iter().map(|&v| self.raw(v)).collect())
    }

    /// s exp(-|w / w_s|^a) at every sample.
    fn raw(&self, velocity: f64) -> Vec<f64> {
        let mut raw = vec![0.0; self.speed.len()];
        stribeck(&self.speed, velocity, self.exponent, &mut raw);
        raw
    }

    /// Column and F(s a |w / w_s|^a / w_s exp(-|w / w_s|^a)), its derivative with respect to w_s.
    fn with_derivative(&self, velocity: f64) -> [Vec<f64>; 2] {
        let raw = self.raw(velocity);
        let slope = self.exponent / velocity;
        let bend = |(e, w): (&f64, &f64)| e * slope * (w / velocity).abs().powf(self.exponent);
        let bend = raw.iter().zip(&self.speed).map(bend).collect();
        let mut both = (self.reduce)(vec![raw, bend]).into_iter();
        std::array::from_fn(|_| both.next().unwrap_or_default())
    }
}

impl fmt::Debug for Curve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Curve").field("velocity", &self.velocity).finish_non_exhaustive()
    }
}

/// The parameter vector is `[coulomb, static, columns .., stribeck_velocity]` with a curve, and
/// `[columns ..]` without.
impl JointProblem {
    /// How many times over rows count that leave this residual: once where the motion does not come again.
    pub fn design_effect(&self, residual: &[f64]) -> f64 {
        self.cycle.map_or(1.0, |cycle| cycle.design_effect(&self.slots, residual))
    }

    pub fn samples(&self) -> usize {
        self.y.len()
    }

    pub fn parameters(&self) -> Vec<&Parameter> {
        let columns = self.columns.iter().map(|c| &c.parameter);
        match &self.curve {
            Some(c) => [&c.coulomb, &c.static_level]
                .into_iter()
                .chain(columns)
                .chain([&c.velocity])
                .collect(),
            None => columns.collect(),
        }
    }

    pub fn parameters_mut(&mut self) -> Vec<&mut Parameter> {
        let curve = self.curve.iter_mut();
        let bent = curve.flat_map(|c| [&mut c.coulomb, &mut c.static_level, &mut c.velocity]);
        bent.chain(self.columns.iter_mut().map(|c| &mut c.parameter)).collect()
    }

    /// # Errors
    /// If the bounds of a parameter are the wrong way round.
    pub fn bounds(&self) -> Result<Bounds, BoundsError> {
        let all = self.parameters();
        for p in &all {
            crate::regression::bounds::check(&p.name, p.lower, p.upper)?;
        }
        Bounds::new(all.iter().map(|p| p.lower).collect(), all.iter().map(|p| p.upper).collect())
    }

    /// Where the parameter of this name stands in the parameter vector.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.parameters().iter().position(|p| p.name == name)
    }

    /// Friction torque and what else is fitted, N.m.
    pub fn predict(&self, x: &[f64]) -> Vec<f64> {
        let mut torque = vec![0.0; self.samples()];
        let mut rest = x;
        if let Some(curve) = &self.curve {
            let (coulomb, excess, velocity) = (x[0], x[1] - x[0], x[x.len() - 1]);
            axpy(coulomb, &curve.sign, &mut torque);
            axpy(excess, &curve.column(velocity), &mut torque);
            rest = &x[2..x.len() - 1];
        }
        for (column, value) in self.columns.iter().zip(rest) {
            axpy(*value, &column.values, &mut torque);
        }
        torque
    }

    /// Measured - predicted, N.m.
    pub fn residual(&self, x: &[f64]) -> Vec<f64> {
        let mut r = self.y.clone();
        axpy(-1.0, &self.predict(x), &mut r);
        r
    }

    /// How well the torque is predicted, the part that was known included.
    pub fn goodness(&self, x: &[f64]) -> Goodness {
        let residual = self.residual(x);
        let predicted: Vec<f64> = self.measured.iter().zip(&residual).map(|(m, r)| m - r).collect();
        let g = statistics::Goodness::of(&self.measured, &predicted);
        Goodness { r2: g.r2, r2_printed: g.r2_printed, mse_nm2: g.mse }
    }

    /// d predict / d parameter, one column each.
    pub fn sensitivity(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let columns = self.columns.iter().map(|c| c.values.clone());
        let Some(curve) = &self.curve else { return columns.collect() };
        let (excess, velocity) = (x[1] - x[0], x[x.len() - 1]);
        let [e, mut bend] = curve.with_derivative(velocity);
        let sliding = curve.sign.iter().zip(&e).map(|(s, e)| s - e).collect();
        bend.iter_mut().for_each(|b| *b *= excess);
        [sliding, e].into_iter().chain(columns).chain([bend]).collect()
    }

    /// The paper's cost (Eq. 5) from a sum of squares: J = sqrt(sum r^2 / n), N.m.
    pub fn rms(&self, sum_of_squares: f64) -> f64 {
        (sum_of_squares.max(0.0) / self.samples().max(1) as f64).sqrt()
    }

    /// J by evaluating the law at every sample; holds for any law.
    pub fn direct_cost(&self, x: &[f64]) -> f64 {
        let mut r = vec![0.0; self.samples()];
        self.residuals(x, &mut r);
        self.rms(dot(&r, &r))
    }
}

impl Residuals for JointProblem {
    fn count(&self) -> usize {
        self.samples()
    }

    /// r = predicted - measured
    fn residuals(&self, x: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&self.predict(x));
        axpy(-1.0, &self.y, out);
    }

    fn jacobian(&self, x: &[f64], _: &[f64], _: &Bounds) -> Vec<Vec<f64>> {
        self.sensitivity(x)
    }
}
