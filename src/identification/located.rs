//! Effects whose nonlinear parameters were found by a search: fitted along from there.
//!
//! Near the values (a, b) of its linear and nonlinear parameters an effect's torque is
//! f + sum_i df/da_i (a_i - a0_i) + sum_k df/db_k (b_k - b0_k), f = sum_i a_i c_i(b), references
//! among b following a. Where there are none df/da_i is c_i. The slopes are columns like others
//! once df/db_k b0_k is added to the torque and what is left, f - sum_i df/da_i a0_i (nothing where
//! there are no references), taken off it: one Gauss-Newton step, which also gives b_k its interval.

use std::sync::Arc;

use super::assemble::{ArmProblem, BoundsByName, assemble_around, at_joint, searched};
use super::error::IdentificationError;
use super::problem::Parameter;
use super::terms::Terms;
use super::{Found, Method, Settings, identify, separable};
use crate::effects::{self, Effect, Role, Scope};
use crate::kernels::axpy;
use crate::signals::Samples;
use crate::twin::Twin;

/// Relative step of the difference that stands for a derivative.
const STEP: f64 = 3e-4;
/// Relative step where columns follow a reference: those of a slack joint jump with the blow that sends a
/// link back, and what they do over a small step says nothing of what they do over a wide one.
const WIDE_STEP: f64 = 0.2;
/// A parameter is taken for no smaller.
const SMALLEST: f64 = 1e-6;
/// A step of Gauss-Newton is cut to this factor.
const FARTHEST: f64 = 1.5;
/// Relative steps that count as none.
const SETTLED: f64 = 1e-3;
const ROUNDS: usize = 6;
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
    fn of_role(&self, role: Role) -> impl Iterator<Item = &'static effects::Parameter> {
        self.effect.about().parameters.iter().filter(move |p| p.role == role)
    }

    /// Do its columns follow what is fitted?
    fn follows(&self) -> bool {
        self.of_role(Role::Nonlinear).any(|p| p.is_reference())
    }

    /// Was it found at this joint?
    pub fn shows(&self) -> bool {
        self.linear.iter().any(|a| *a != 0.0)
    }

    /// `columns` gives the linear parameters' columns for nonlinear values.
    pub fn tangent(&self, columns: impl Fn(&[f64]) -> Vec<Vec<f64>>) -> Tangent {
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
            slopes.push(Slope { parameter: searched(p), series, centre: 0.0, of: Arc::default() });
            axpy(-linear[k], &slopes[k].series, &mut rest);
        }
        let of: Arc<[&'static str]> = self.of_role(Role::Linear).map(|p| p.name).collect();
        let parameters: Vec<_> = self.of_role(Role::Nonlinear).collect();
        for &k in &self.open {
            let series = derivative(nonlinear, k, share, |b| torque(linear, b));
            let centre = nonlinear[k];
            let parameter = around(parameters[k], centre);
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

/// Gauss-Newton steps from what was located, by least squares on all parameters together, until
/// they settle: (twin with the nonlinear values, what was located there).
///
/// # Errors
/// As [`super::assemble`].
pub fn settle(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    mut located: Vec<Located>,
    nlse: &separable::Settings,
) -> Result<(Twin, Vec<Located>), IdentificationError> {
    let settings = Settings { methods: vec![Method::Nlse], nlse: *nlse, ..Settings::default() };
    for _ in 0..ROUNDS {
        let known = with_located(twin, &located);
        let arm = assemble_around(samples, &known, terms, &BoundsByName::new(), &located)?;
        let found = identify(&arm, None, &settings)?.swap_remove(0).found;
        let steps: Vec<f64> = located.iter_mut().map(|l| step(l, &arm, &found)).collect();
        if steps.iter().all(|s| *s < SETTLED) {
            break;
        }
    }
    Ok((with_located(twin, &located), located))
}

/// Takes over what was found; the largest relative change of a nonlinear parameter.
fn step(located: &mut Located, arm: &ArmProblem, found: &Found) -> f64 {
    let value = |name: &str| match located.effect.about().scope {
        Scope::Joint => {
            let k = arm.joints[located.joint].index(name)?;
            found.joints[located.joint].get(k).copied()
        }
        scope => {
            let own = at_joint(name, located.joint);
            let name = if scope == Scope::Link { own.as_str() } else { name };
            let k = arm.shared.iter().position(|p| p.name == name)?;
            found.shared.get(k).copied()
        }
    };
    let linear: Vec<Option<f64>> = located.of_role(Role::Linear).map(|p| value(p.name)).collect();
    let nonlinear: Vec<_> = located.of_role(Role::Nonlinear).map(|p| (p, value(p.name))).collect();
    // What follows a reference is no more linear than the rest.
    let follows = located.follows();
    for (own, new) in located.linear.iter_mut().zip(linear) {
        let Some(new) = new else { continue };
        *own = if follows { cut(*own, new) } else { new };
    }
    let mut largest = 0.0f64;
    for (own, (p, new)) in located.nonlinear.iter_mut().zip(nonlinear) {
        let Some(new) = new else { continue };
        let new = p.clamp(cut(*own, new));
        largest = largest.max((new / *own - 1.0).abs());
        *own = new;
    }
    let linear = located.linear.clone();
    located.effect.settle(&linear, &mut located.nonlinear);
    largest
}

/// No further than by the factor a step may take.
fn cut(from: f64, to: f64) -> f64 {
    let (a, b) = (from / FARTHEST, from * FARTHEST);
    to.clamp(a.min(b), a.max(b))
}

#[cfg(test)]
#[path = "located_tests.rs"]
mod tests;
