//! Effects whose nonlinear parameters were found by a search: fitted along from there.
//!
//! Near the values (a, b) of its linear and nonlinear parameters an effect's torque is
//! f + sum_i df/da_i (a_i - a0_i) + sum_k df/db_k (b_k - b0_k), f = sum_i a_i c_i(b), references
//! among b following a. Where there are none df/da_i is c_i. The slopes are columns like others
//! once df/db_k b0_k is added to the torque and what is left, f - sum_i df/da_i a0_i (nothing where
//! there are no references), taken off it: one Gauss-Newton step, which also gives b_k its interval.

use std::sync::Arc;

use super::arm_problem::searched;
use super::problem::Parameter;
use crate::effects::{self, Effect, Role, Scope, Size};
use crate::kernels::axpy;
use crate::twin::Twin;

/// Relative step of the difference that stands for a derivative.
const STEP: f64 = 3e-4;
/// Relative step where columns follow a reference: those of a slack joint jump with the blow that sends a
/// link back, and what they do over a small step says nothing of what they do over a wide one.
const WIDE_STEP: f64 = 0.2;
/// A parameter is taken for no smaller.
const SMALLEST: f64 = 1e-6;
/// Bounds are the value found divided and multiplied by this, within the catalogue's: the slope
/// says nothing of what is further away.
const RANGE: f64 = 3.0;

/// An effect at one joint, at values found by a search.
#[derive(Clone)]
pub struct Located {
    pub effect: &'static dyn Effect,
    /// Joint from 0; 0 for an effect of the whole arm.
    pub joint: usize,
    pub linear: Vec<f64>,
    pub nonlinear: Vec<f64>,
    /// Which of `nonlinear` were searched for; none where the effect does not show.
    pub open: Vec<usize>,
    /// Where the search began: how many values it had to choose from.
    pub starts: usize,
}

/// d torque / d a parameter.
pub struct Slope {
    pub parameter: Parameter,
    pub series: Vec<f64>,
    /// Where it was worked out; zero for a linear parameter.
    pub centre: f64,
    /// The linear parameters that a nonlinear one hangs on; empty for a linear one.
    pub of: Arc<[&'static str]>,
}

/// An effect's torque near the values that were located.
pub struct Tangent {
    pub slopes: Vec<Slope>,
    /// Torque where all the linear parameters are zero, N.m.
    pub rest: Vec<f64>,
}

impl Located {
    pub(super) fn of_role(&self, role: Role) -> impl Iterator<Item = &'static effects::Parameter> {
        self.effect.about().parameters.iter().filter(move |p| p.role == role)
    }

    /// Do its columns follow what is fitted?
    pub(super) fn follows(&self) -> bool {
        self.of_role(Role::Nonlinear).any(|p| p.is_reference())
    }

    /// Was it found at this joint?
    pub fn shows(&self) -> bool {
        self.linear.iter().any(|a| *a != 0.0)
    }

    /// On an arm of this size; `columns` gives the linear parameters' columns for nonlinear values.
    pub fn tangent(&self, size: &Size, columns: impl Fn(&[f64]) -> Vec<Vec<f64>>) -> Tangent {
        let (linear, nonlinear) = (&self.linear[..], &self.nonlinear[..]);
        let torque = |a: &[f64], b: &[f64]| {
            let mut b = b.to_vec();
            self.effect.settle(a, &mut b);
            let mut sum = Vec::new();
            for (column, a) in columns(&b).iter().zip(a) {
                sum.resize(column.len(), 0.0);
                axpy(*a, column, &mut sum);
            }
            sum
        };
        let mut rest = torque(linear, nonlinear);
        let share = if self.follows() { WIDE_STEP } else { STEP };
        let mut slopes = Vec::new();
        for (k, p) in self.of_role(Role::Linear).enumerate() {
            let series = derivative(linear, k, share, |a| torque(a, nonlinear));
            slopes.push(Slope {
                parameter: searched(p, size),
                series,
                centre: 0.0,
                of: Arc::default(),
            });
            axpy(-linear[k], &slopes[k].series, &mut rest);
        }
        let of: Arc<[&'static str]> = self.of_role(Role::Linear).map(|p| p.name).collect();
        let parameters: Vec<_> = self.of_role(Role::Nonlinear).collect();
        for &k in &self.open {
            let series = derivative(nonlinear, k, share, |b| torque(linear, b));
            let centre = nonlinear[k];
            let parameter = around(&parameters[k].on(size), centre);
            slopes.push(Slope { parameter, series, centre, of: of.clone() });
        }
        Tangent { slopes, rest }
    }
}

/// df/dx_k by a central difference over this share of x_k either way.
fn derivative(x: &[f64], k: usize, share: f64, f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let step = share * x[k].abs().max(SMALLEST);
    let at = |to: f64| {
        let mut moved = x.to_vec();
        moved[k] += to;
        f(&moved)
    };
    let (above, below) = (at(step), at(-step));
    above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * step)).collect()
}

/// A parameter of the catalogue, bounded around a value.
fn around(p: &effects::Parameter, centre: f64) -> Parameter {
    let (lower, upper) = match p.min >= 0.0 {
        true => (p.min.max(centre / RANGE), p.max.min(centre * RANGE)),
        false => (p.min, p.max),
    };
    Parameter { name: p.name.into(), unit: p.unit.into(), lower, upper }
}

impl Located {
    /// Names of the parameters that were searched for.
    pub fn searched(&self) -> Vec<&'static str> {
        let all: Vec<_> = self.of_role(Role::Nonlinear).map(|p| p.name).collect();
        self.open.iter().map(|&k| all[k]).collect()
    }
}

/// `twin` with the nonlinear values of what was located.
pub fn with_located(twin: &Twin, located: &[Located]) -> Twin {
    let mut twin = twin.clone();
    for l in located {
        let joints = if l.effect.about().scope == Scope::Arm { 1 } else { twin.robot.dof() };
        for (p, value) in l.of_role(Role::Nonlinear).zip(&l.nonlinear) {
            let values = twin.values.entry(p.name.into()).or_insert_with(|| vec![*value; joints]);
            values[l.joint] = *value;
        }
    }
    twin
}

#[cfg(test)]
#[path = "located_tests.rs"]
mod tests;
