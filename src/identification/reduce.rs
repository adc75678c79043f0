//! Which terms of the law exist: backward elimination by the robust test.
//!
//! Starting from the full law, the optional term whose existence the data show least (largest
//! robust p; what cannot be told at all counts as 1) is taken out and the rest fitted again, until
//! every term left is significant: of all terms that are absent from a joint, one is kept in 1 % of
//! the cases (Bonferroni's inequality over the optional terms). Terms that cannot be told apart (quadratic and cubic viscous
//! friction over a short range of speeds) thus do not hide each other: one of them goes first.
//! Coulomb friction always stays. Intervals of what is left are conditional on this choice; their
//! coverage is measured, not assumed (docs/recovery.md).

use rayon::prelude::*;
use serde::Serialize;

use super::ParameterEstimate;
use super::arm_problem::ArmProblem;
use super::error::IdentificationError;
use super::judge::{self, LEVEL};
use super::prepared::Prepared;
use super::problem::{Column, JointProblem};
use super::{separable, shared};
use crate::kernels::axpy;

/// A term that was taken out of one joint's law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dropped {
    /// From 1 at the base.
    pub joint: usize,
    /// `stribeck`, or the parameter's name.
    pub term: String,
    /// p-value of the robust test when the term was dropped.
    pub p: f64,
    /// Why, if not for its p alone.
    pub why: Option<String>,
}

/// The Stribeck term goes as a whole: excess and velocity.
const STRIBECK: &str = "stribeck";

/// Takes the terms out of `fit` (and `check`, which is assembled alike) that `fit` does not show.
///
/// # Errors
/// If bounds are wrong or a residual is not finite.
pub fn reduce(
    fit: &mut ArmProblem,
    check: Option<&mut ArmProblem>,
    settings: &separable::Settings,
) -> Result<Vec<Dropped>, IdentificationError> {
    let common = shared::solve(fit, settings)?;
    let left = shared::take_off(fit, &common);
    let dropped: Vec<Vec<Dropped>> = left
        .into_par_iter()
        .map(|joint| eliminate(joint, settings))
        .collect::<Result<_, IdentificationError>>()?;
    let dropped: Vec<Dropped> = dropped.into_iter().flatten().collect();
    std::iter::once(fit).chain(check).for_each(|arm| take_out_all(arm, &dropped));
    Ok(dropped)
}

/// Takes terms out of the joints' laws that another recording did not show.
pub fn take_out_all(arm: &mut ArmProblem, dropped: &[Dropped]) {
    dropped.iter().for_each(|d| take_out(&mut arm.joints[d.joint - 1], &d.term));
}

fn eliminate(
    mut problem: JointProblem,
    settings: &separable::Settings,
) -> Result<Vec<Dropped>, IdentificationError> {
    let mut dropped = Vec::new();
    let threshold = (1.0 - LEVEL) / optional(&problem).max(1) as f64;
    while let Some(next) = weakest(&problem, threshold, settings)? {
        take_out(&mut problem, &next.term);
        dropped.push(next);
    }
    Ok(dropped)
}

/// How many terms may go: all but Coulomb friction.
fn optional(problem: &JointProblem) -> usize {
    let columns = problem.columns.iter().filter(|c| c.parameter.name != "coulomb").count();
    columns + usize::from(problem.curve.is_some())
}

/// The optional term the data show least, if its p exceeds `threshold`.
fn weakest(
    problem: &JointProblem,
    threshold: f64,
    settings: &separable::Settings,
) -> Result<Option<Dropped>, IdentificationError> {
    let prepared = Prepared::new(problem.clone())?;
    let x = prepared.separable(settings).x;
    let estimates = judge::judge(problem, &x)?;
    let terms = estimates.iter().filter_map(|e| doubt(problem, e, &estimates));
    let weak = terms.filter(|d| d.p > threshold);
    Ok(weak.max_by(|a, b| a.p.total_cmp(&b.p).then(place(&b.term).cmp(&place(&a.term)))))
}

/// Which of several terms that cannot be told at all goes first.
fn place(term: &str) -> usize {
    const ORDER: [&str; 3] = [STRIBECK, "viscous_cubic", "viscous_quadratic"];
    ORDER.iter().position(|o| *o == term).unwrap_or(ORDER.len())
}

/// How much the data doubt the term that `estimate` belongs to; `None` for one that stays.
fn doubt(
    problem: &JointProblem,
    estimate: &ParameterEstimate,
    all: &[ParameterEstimate],
) -> Option<Dropped> {
    let (term, p, why) = match estimate.name.as_str() {
        "coulomb" | "static" | "stribeck_velocity" => return None,
        name if is_slope(problem, name) => return None,
        // A lower power stays as long as a higher one (Nelder, J. R. Stat. Soc. A 140, 1977).
        "viscous" if higher_power(problem) => return None,
        "stribeck_excess" => stribeck_doubt(estimate, all),
        name => (name, estimate.p, estimate.why_not.clone()),
    };
    Some(Dropped { joint: problem.joint, term: term.into(), p, why })
}

fn higher_power(problem: &JointProblem) -> bool {
    let names = problem.columns.iter().map(|c| c.parameter.name.as_str());
    names.into_iter().any(|n| ["viscous_quadratic", "viscous_cubic"].contains(&n))
}

/// A Stribeck term needs a dip (a positive excess) and a velocity of its own.
fn stribeck_doubt(
    excess: &ParameterEstimate,
    all: &[ParameterEstimate],
) -> (&'static str, f64, Option<String>) {
    let velocity = all.iter().find(|e| e.name == "stribeck_velocity");
    match velocity {
        _ if excess.value <= 0.0 => {
            (STRIBECK, 1.0, Some("T_s below T_c is no Stribeck dip".into()))
        }
        Some(v) if !v.identifiable => (STRIBECK, 1.0, v.why_not.clone()),
        _ => (STRIBECK, excess.p, None),
    }
}

/// Takes a term out; without its Stribeck term a curve is plain Coulomb friction.
fn take_out(problem: &mut JointProblem, term: &str) {
    if term != STRIBECK {
        problem.columns.retain(|c| c.parameter.name != term);
        drop_idle_slopes(problem);
    } else if let Some(curve) = problem.curve.take() {
        problem.columns.insert(0, Column::linear(curve.coulomb, curve.sign));
    }
}

/// A nonlinear parameter goes with the last of the linear ones it hangs on.
fn drop_idle_slopes(problem: &mut JointProblem) {
    let names = problem.columns.iter().map(|c| c.parameter.name.clone());
    let left: Vec<String> = names.collect();
    let idle = |c: &&Column| {
        !c.slope_of.is_empty() && !c.slope_of.iter().any(|n| left.iter().any(|l| l == n))
    };
    let (gone, kept): (Vec<Column>, Vec<Column>) =
        std::mem::take(&mut problem.columns).into_iter().partition(|c| idle(&c));
    gone.iter().for_each(|c| axpy(-c.centre, &c.values, &mut problem.y));
    problem.columns = kept;
}

/// Does this parameter belong to a slope, which has no test of its own?
fn is_slope(problem: &JointProblem, name: &str) -> bool {
    problem.columns.iter().any(|c| c.parameter.name == name && !c.slope_of.is_empty())
}

#[cfg(test)]
#[path = "reduce_tests.rs"]
mod tests;
