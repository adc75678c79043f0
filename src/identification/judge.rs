//! From parameter values to tests, intervals, and what the data cannot tell.
//!
//! Intervals follow from the Jacobian of the prediction at the optimum, the Stribeck velocity's
//! column included ([`infer`]). A parameter is identifiable unless one of these holds, and then
//! its interval is the whole range it was searched in:
//!
//! * its column depends on others';
//! * its interval is wider than the range it was searched in;
//! * it stands on a bound at which its term does not vanish;
//! * it belongs to a Stribeck curve that is not there: T_s = T_c is not rejected, so w_s has no
//!   meaning (Davies, Biometrika 74, 1987); or that nothing sampled, with w_s on a bound or hardly
//!   a sample slower than 2 w_s.

use nalgebra::DMatrix;

use super::problem::{JointProblem, Parameter};
use super::{Interval, ParameterEstimate};
use crate::statistics::{
    Cycle, Inference, Inferences, StatisticsError, infer, normal_quantile, normal_two_sided,
};

/// Confidence level of all intervals and tests: the paper's 99 %.
pub const LEVEL: f64 = 0.99;
/// Slow samples a Stribeck curve must rest on.
const FEWEST_SLOW: usize = 20;

/// What is known of a parameter besides its value.
struct Findings {
    /// Per parameter, why it is not identifiable.
    why_not: Vec<Option<String>>,
}

/// Estimates of one joint, in the order people read them; with a curve, `stribeck_excess`,
/// T_s - T_c with its own test, follows the searched parameters.
///
/// # Errors
/// If residual or Jacobian is not finite.
pub fn judge(problem: &JointProblem, x: &[f64]) -> Result<Vec<ParameterEstimate>, StatisticsError> {
    let parameters: Vec<Parameter> = problem.parameters().into_iter().cloned().collect();
    if too_few(problem) {
        return Ok(unknown(&parameters, x, &too_short(problem)));
    }
    let columns = problem.sensitivity(x);
    let residual = problem.residual(x);
    let JointProblem { slots, cycle, .. } = problem;
    let estimates = estimate(&parameters, x, &columns, &residual, slots, *cycle)?;
    let excess = match WithExcess::of(problem, x, &columns) {
        Some(w) => Some(
            estimate(&w.parameters, &w.x, &w.columns, &residual, slots, *cycle)?.swap_remove(1),
        ),
        None => None,
    };
    Ok(finish(problem, x, estimates, excess))
}

/// Fewer samples than an interval can rest on.
pub fn too_few(problem: &JointProblem) -> bool {
    problem.samples() < problem.parameters().len() + 10
}

/// Adds the excess, marks what a missing curve makes meaningless, and sorts.
pub fn finish(
    problem: &JointProblem,
    x: &[f64],
    mut estimates: Vec<ParameterEstimate>,
    excess: Option<ParameterEstimate>,
) -> Vec<ParameterEstimate> {
    if let Some(excess) = excess {
        blame_curve(problem, x, &excess, &mut estimates);
        estimates.push(excess);
    }
    estimates.sort_by_key(|e| place(&e.name));
    estimates
}

pub fn too_short(problem: &JointProblem) -> String {
    format!(
        "only {} sliding samples: let the joint move longer and faster than the standstill \
         threshold",
        problem.samples()
    )
}

/// Tests and intervals for any least-squares estimate: `columns` are d prediction / d parameter.
///
/// # Errors
/// If something is not finite.
pub fn estimate(
    parameters: &[Parameter],
    x: &[f64],
    columns: &[Vec<f64>],
    residual: &[f64],
    slots: &[usize],
    cycle: Option<Cycle>,
) -> Result<Vec<ParameterEstimate>, StatisticsError> {
    let jacobian = DMatrix::from_fn(residual.len(), columns.len(), |i, j| columns[j][i]);
    let null = vec![0.0; x.len()];
    let inferences = infer(x, &null, &jacobian, residual, slots, cycle, LEVEL)?;
    let findings = Findings::of(parameters, x, &inferences);
    let all = parameters.iter().zip(x).enumerate();
    Ok(all.map(|(i, (p, &value))| findings.row(i, p, value, &inferences)).collect())
}

impl Findings {
    fn of(parameters: &[Parameter], x: &[f64], inferences: &Inferences) -> Self {
        let mut why_not = vec![None; parameters.len()];
        for direction in inferences.design.undetermined() {
            for &i in &direction.parameters {
                why_not[i] = Some(entangled(parameters, &direction.parameters, i));
            }
        }
        for (i, p) in parameters.iter().enumerate() {
            let wide = 2.0 * (inferences.robust[i].high - x[i]) > p.upper - p.lower;
            let stuck = reached(p, x[i]) && nearest_bound(p, x[i]) != 0.0;
            let reason = if stuck {
                Some(format!("it stands on its bound {}", nearest_bound(p, x[i])))
            } else if wide {
                Some("its uncertainty exceeds the range it was searched in".into())
            } else {
                None
            };
            why_not[i] = why_not[i].take().or(reason);
        }
        Self { why_not }
    }

    fn row(&self, i: usize, p: &Parameter, value: f64, all: &Inferences) -> ParameterEstimate {
        let at_bound = reached(p, value);
        let robust = &all.robust[i];
        let mut row = ParameterEstimate {
            name: p.name.clone(),
            unit: p.unit.clone(),
            value,
            low: robust.low,
            high: robust.high,
            statistic: robust.statistic,
            p: robust.p,
            asymptotic: interval(&all.asymptotic[i]),
            paper: interval(&all.paper[i]),
            bounds: [p.lower, p.upper],
            at_bound,
            identifiable: true,
            why_not: None,
            posterior: None,
        };
        if let Some(why) = &self.why_not[i] {
            give_up(&mut row, why.clone());
        } else if at_bound {
            row.low = row.low.max(p.lower);
            row.high = row.high.min(p.upper);
        }
        row
    }
}

fn interval(i: &Inference) -> Interval {
    Interval { low: i.low, high: i.high, statistic: i.statistic, p: i.p }
}

/// Nothing is known but the range that was searched.
pub fn give_up(row: &mut ParameterEstimate, why: String) {
    let [low, high] = row.bounds;
    let all = Interval { low, high, statistic: 0.0, p: 1.0 };
    (row.low, row.high, row.statistic, row.p) = (low, high, 0.0, 1.0);
    (row.asymptotic, row.paper) = (all, all);
    row.identifiable = false;
    row.why_not = Some(why);
}

/// A row of a value that is as good as normal with this standard error.
pub fn set(row: &mut ParameterEstimate, value: f64, standard_error: f64) {
    let half = normal_quantile(1.0 - LEVEL) * standard_error;
    (row.value, row.low, row.high) = (value, value - half, value + half);
    row.statistic = value / standard_error;
    row.p = normal_two_sided(row.statistic).p;
}

/// Estimates of which the data say nothing.
pub fn unknown(parameters: &[Parameter], x: &[f64], why: &str) -> Vec<ParameterEstimate> {
    let row = |(p, &value): (&Parameter, &f64)| {
        let nothing = Interval { low: p.lower, high: p.upper, statistic: 0.0, p: 1.0 };
        let mut row = ParameterEstimate {
            name: p.name.clone(),
            unit: p.unit.clone(),
            value,
            low: p.lower,
            high: p.upper,
            statistic: 0.0,
            p: 1.0,
            asymptotic: nothing,
            paper: nothing,
            bounds: [p.lower, p.upper],
            at_bound: reached(p, value),
            identifiable: true,
            why_not: None,
            posterior: None,
        };
        give_up(&mut row, why.into());
        row
    };
    parameters.iter().zip(x).map(row).collect()
}

fn entangled(parameters: &[Parameter], direction: &[usize], i: usize) -> String {
    let others = direction.iter().filter(|&&k| k != i).map(|&k| parameters[k].name.as_str());
    let others: Vec<_> = others.collect();
    match others.is_empty() {
        true => "its term is zero at every sample".into(),
        false => format!("these data do not tell it from {}", others.join(", ")),
    }
}

fn reached(p: &Parameter, value: f64) -> bool {
    let near = 1e-6 * (p.upper - p.lower);
    value <= p.lower + near || value >= p.upper - near
}

fn nearest_bound(p: &Parameter, value: f64) -> f64 {
    if value - p.lower < p.upper - value { p.lower } else { p.upper }
}

/// The problem in (T_c, T_s - T_c) instead of (T_c, T_s): the second parameter is the excess.
pub struct WithExcess {
    pub parameters: Vec<Parameter>,
    pub x: Vec<f64>,
    pub columns: Vec<Vec<f64>>,
}

impl WithExcess {
    /// `None` without a curve; `columns` are those of (T_c, T_s, ..).
    pub fn of(problem: &JointProblem, x: &[f64], columns: &[Vec<f64>]) -> Option<Self> {
        problem.curve.as_ref()?;
        let mut columns = columns.to_vec();
        columns[0] = columns[0].iter().zip(&columns[1]).map(|(s, b)| s + b).collect();
        let mut values = x.to_vec();
        values[1] = x[1] - x[0];
        let mut parameters: Vec<Parameter> = problem.parameters().into_iter().cloned().collect();
        let [coulomb, level] = [parameters[0].clone(), parameters[1].clone()];
        parameters[1] = Parameter {
            name: "stribeck_excess".into(),
            lower: level.lower - coulomb.upper,
            upper: level.upper - coulomb.lower,
            ..level
        };
        Some(Self { parameters, x: values, columns })
    }
}

/// Marks static level and Stribeck velocity where there is no curve for them to describe.
fn blame_curve(
    problem: &JointProblem,
    x: &[f64],
    excess: &ParameterEstimate,
    estimates: &mut [ParameterEstimate],
) {
    let Some(curve) = &problem.curve else { return };
    let velocity = x[x.len() - 1];
    let slow = problem.speed.iter().filter(|&&w| w < 2.0 * velocity).count();
    let why = if reached(&curve.velocity, velocity) {
        Some(format!(
            "the Stribeck velocity stands on its bound {velocity:.4} rad/s: the curve is as narrow \
             or as wide as allowed, not a dip these data show"
        ))
    } else if slow < FEWEST_SLOW {
        Some(format!(
            "only {slow} sliding samples are slower than twice the Stribeck velocity \
             ({:.3} rad/s): move slowly for a while",
            2.0 * velocity
        ))
    } else if !excess.identifiable || excess.p > 1.0 - LEVEL {
        Some("T_s = T_c is not rejected: no Stribeck curve whose velocity could be told".into())
    } else {
        None
    };
    let Some(why) = why else { return };
    for row in estimates.iter_mut().filter(|e| CURVE.contains(&e.name.as_str())) {
        if row.identifiable {
            give_up(row, why.clone());
        }
    }
}

/// Parameters that mean nothing without a Stribeck curve.
const CURVE: [&str; 2] = ["static", "stribeck_velocity"];

/// The paper's law first, as printed, then the rest.
fn place(name: &str) -> usize {
    const ORDER: [&str; 9] = [
        "coulomb",
        "static",
        "stribeck_excess",
        "stribeck_velocity",
        "viscous",
        "viscous_quadratic",
        "viscous_cubic",
        "rotor_inertia",
        "offset",
    ];
    ORDER.iter().position(|o| *o == name).unwrap_or(ORDER.len())
}

#[cfg(test)]
#[path = "judge_tests.rs"]
mod tests;
