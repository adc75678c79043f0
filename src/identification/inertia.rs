//! The links' inertial parameters, fitted together with what a joint has of its own.
//!
//! The base parameters enter an arm's problem as parameters that all joints share. What the data say of
//! them, once friction, rotors and offsets of every joint are projected out (Frisch and Waugh), then
//! becomes the links that are most probable beside the model's.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::arm_problem::ArmProblem;
use super::assemble::reduce;
use super::error::IdentificationError;
use super::judge::{self, LEVEL};
use super::problem::{JointProblem, Parameter};
use super::terms::Terms;
use super::{Found, MethodResult, ParameterEstimate, shared};
use crate::effects::expected_of_arm;
use crate::kernels::{axpy, dot};
use crate::regression::qr::{Qr, unexplained};
use crate::rigid_body::{BaseParameters, Estimate, Information, estimate, parameters};
use crate::robot::{DrivePart, Robot, body_regressor_series};
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::statistics::{effective_samples, normal_quantile};
use crate::twin::Twin;

/// Which parameters of an arm's problem are the links'.
#[derive(Debug, Clone)]
pub struct Inertial {
    pub base: BaseParameters,
    /// Values of the base parameters in the model, and how large each could be.
    pub model: DVector<f64>,
    pub sizes: DVector<f64>,
    /// Where they begin among the shared parameters.
    first: usize,
    robot: Robot,
}

/// Base parameters are searched within this many times the size that the model's links could have.
const RANGE: f64 = 10.0;

/// Torque is known to no better than this share of itself: a simulation without noise says no more.
const LEAST_NOISE: f64 = 1e-4;

impl Inertial {
    /// Base parameters of a twin whose rotor inertias are fitted along where `terms` say so.
    pub fn of(twin: &Twin, terms: &Terms) -> Self {
        let base = BaseParameters::of(&twin.robot, terms.fits(DrivePart::RotorInertia));
        let model = base.values(&parameters::of(&twin.robot));
        let sizes = base.sizes(&twin.robot);
        Self { base, model, sizes, first: 0, robot: twin.robot.clone() }
    }

    /// Adds the base parameters to what the joints of `arm` share. Their values are those of the whole
    /// link, not what it has more than the model.
    ///
    /// # Errors
    /// If the recording cannot be filtered.
    pub fn attach(
        &mut self,
        arm: &mut ArmProblem,
        samples: &Samples,
        twin: &Twin,
    ) -> Result<(), IdentificationError> {
        let samples = &twin.correct(samples);
        self.first = arm.shared.len();
        let parameters = (0..self.base.len()).map(|i| self.parameter(i)).collect();
        share(arm, samples, parameters, &self.columns(samples, &twin.laden()))?;
        for (problem, shared) in arm.joints.iter_mut().zip(&arm.shared_columns) {
            let own = shared[self.first..].iter().zip(&self.model);
            own.for_each(|(column, value)| axpy(*value, column, &mut problem.y));
        }
        Ok(())
    }

    fn parameter(&self, i: usize) -> Parameter {
        let place = self.base.independent[i];
        let range = RANGE * self.sizes[i];
        let (name, unit) = (parameters::name(place), parameters::unit(place).into());
        Parameter { name, unit, lower: -range, upper: range }
    }

    /// Torque of every joint per unit of each base parameter, at every sample.
    fn columns(&self, samples: &Samples, robot: &Robot) -> Vec<JointSeries> {
        let links = (0..robot.dof()).into_par_iter();
        let all: Vec<[JointSeries; 10]> = links
            .map(|link| body_regressor_series(robot, &samples.q, &samples.qd, &samples.qdd, link))
            .collect();
        let of = |&i: &usize| all[i / parameters::PER_LINK][i % parameters::PER_LINK].clone();
        self.base.independent.iter().map(of).collect()
    }

    /// Takes the base parameters' rows out of a result. Those of which these data say less than the
    /// model, with an interval wider than a link of its mass and extent could have, are not identified.
    pub fn take(&self, arm: &ArmProblem, result: &mut MethodResult) -> Vec<ParameterEstimate> {
        let gram = self.with_ranges(arm, self.information(arm, &result.found)).gram;
        let inverse = gram.clone().pseudo_inverse(0.0).unwrap_or_else(|_| gram.clone());
        let mut rows: Vec<ParameterEstimate> = result.arm.drain(self.own()).collect();
        for (i, row) in rows.iter_mut().enumerate() {
            if 0.5 * (row.high - row.low) > self.sizes[i] {
                judge::give_up(row, self.why_unexcited(&gram, &inverse, i));
            }
        }
        rows
    }

    fn why_unexcited(&self, gram: &DMatrix<f64>, inverse: &DMatrix<f64>, i: usize) -> String {
        let alone = normal_quantile(1.0 - LEVEL) / gram[(i, i)].sqrt();
        if alone > self.sizes[i] {
            return "this motion hardly asks for it: even with all others known it would stay less \
                    sure than the model's"
                .into();
        }
        let correlation =
            |k: &usize| (inverse[(i, *k)] / (inverse[(i, i)] * inverse[(*k, *k)]).sqrt()).abs();
        let mut others: Vec<usize> = (0..self.base.len()).filter(|k| *k != i).collect();
        others.sort_by(|a, b| correlation(b).total_cmp(&correlation(a)));
        let names = others.iter().take(2).map(|&k| parameters::name(self.base.independent[k]));
        format!("this motion hardly tells it from {}", names.collect::<Vec<_>>().join(" and "))
    }

    /// Condition number of the base parameters' columns, each in units of its size.
    pub fn condition(&self, arm: &ArmProblem, found: &Found) -> f64 {
        let gram = self.information(arm, found).gram;
        let n = self.base.len();
        let scaled = DMatrix::from_fn(n, n, |i, k| gram[(i, k)] * self.sizes[i] * self.sizes[k]);
        let eigenvalues = scaled.symmetric_eigenvalues();
        (eigenvalues.max() / eigenvalues.min().max(f64::MIN_POSITIVE)).sqrt()
    }

    /// The most probable links beside those of `robot`, `total_mass` (kg) together where that is known;
    /// `None` where a link of `robot` is impossible.
    pub fn links(
        &self,
        arm: &ArmProblem,
        found: &Found,
        robot: &Robot,
        total_mass: Option<f64>,
    ) -> Option<Estimate> {
        let information = self.with_ranges(arm, self.information(arm, found));
        estimate(robot, &self.base, &information, total_mass)
    }

    /// What the data say of the base parameters, then of everything else that the joints share.
    /// Neighbouring rows say the same where what is left is correlated: they count as many times less
    /// as their correlation time is longer.
    pub fn information(&self, arm: &ArmProblem, found: &Found) -> Information {
        let joints = shared::take_off(arm, &found.shared);
        let each = (0..joints.len()).into_par_iter().map(|j| {
            of_joint(&joints[j], &arm.joints[j], &arm.shared_columns[j], &found.joints[j])
        });
        let all: Vec<Information> = each.collect();
        let n = arm.shared.len();
        let sum = all.into_iter().fold(Information::none(n), std::ops::Add::add);
        let order: Vec<usize> = self.own().chain(self.others(n)).collect();
        Information {
            gram: sum.gram.select_rows(&order).select_columns(&order),
            pull: sum.pull.select_rows(&order),
        }
    }

    fn own(&self) -> Range<usize> {
        self.first..self.first + self.base.len()
    }

    fn others(&self, shared: usize) -> impl Iterator<Item = usize> {
        let own = self.own();
        (0..shared).filter(move |i| !own.contains(i))
    }

    /// Others are as large as can be expected of them, or else within the range they are searched in, as far
    /// as a normal density says that.
    pub fn with_ranges(&self, arm: &ArmProblem, mut said: Information) -> Information {
        for (k, i) in self.others(arm.shared.len()).enumerate() {
            let Parameter { name, lower, upper, .. } = &arm.shared[i];
            let place = self.base.len() + k;
            let size = expected_of_arm(&self.robot, name).unwrap_or(0.5 * (upper - lower));
            let precision = size.powi(-2);
            said.gram[(place, place)] += precision;
            said.pull[place] += precision * 0.5 * (lower + upper);
        }
        said
    }
}

/// Adds parameters that all joints share, with their torque (N.m per unit) at every sample.
///
/// # Errors
/// If the recording cannot be filtered.
pub fn share(
    arm: &mut ArmProblem,
    samples: &Samples,
    parameters: Vec<Parameter>,
    columns: &[JointSeries],
) -> Result<(), IdentificationError> {
    let filter = samples.torque_filter()?;
    arm.shared.extend(parameters);
    let joints = arm.joints.par_iter().zip(&mut arm.shared_columns).enumerate();
    joints.for_each(|(j, (problem, shared))| {
        let reduce = reduce(filter.clone(), &samples.rows(j));
        let felt = |c: &&JointSeries| c.joint(j).iter().any(|v| *v != 0.0);
        let some = columns.iter().filter(felt).map(|c| c.joint(j).to_vec()).collect();
        let mut reduced = reduce(some).into_iter();
        shared.extend(columns.iter().map(|column| {
            let kept = if felt(&column) { reduced.next() } else { None };
            kept.unwrap_or_else(|| vec![0.0; problem.samples()])
        }));
    });
    Ok(())
}

/// What one joint says of the shared parameters: `left` is its problem without their torque.
fn of_joint(
    left: &JointProblem,
    problem: &JointProblem,
    columns: &[Vec<f64>],
    x: &[f64],
) -> Information {
    let n = columns.len();
    let residual = left.residual(x);
    let rows = residual.len() as f64;
    let freedom = rows - x.len() as f64;
    if freedom <= 0.0 {
        return Information::none(n);
    }
    let own = Qr::new(left.sensitivity(x));
    // What the joint's own terms bend is linear about where they were found.
    let mut y = problem.y.clone();
    axpy(-1.0, &left.predict(x), &mut y);
    let y = unexplained(&own.q, y);
    let seen = columns.iter().flat_map(|c| unexplained(&own.q, c.clone()));
    let columns = DMatrix::from_iterator(residual.len(), n, seen);
    let least = LEAST_NOISE.powi(2) * dot(&left.measured, &left.measured) / rows;
    let variance = (dot(&residual, &residual) / freedom).max(least).max(f64::MIN_POSITIVE);
    let weight = effective_samples(&residual) / problem.design_effect(&residual) / rows / variance;
    let weighted = columns.transpose() * weight;
    Information { gram: &weighted * columns, pull: weighted * DVector::from_vec(y) }
}

#[cfg(test)]
#[path = "inertia_tests.rs"]
mod tests;
