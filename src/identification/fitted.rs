//! The twin with what was found in it.

use super::arm_problem::ArmProblem;
use super::assemble::with_shared;
use super::error::IdentificationError;
use super::prepared::Prepared;
use super::problem::{Column, JointProblem};
use super::terms::Terms;
use super::{MethodResult, separable, shared};
use crate::effects::{self, Role};
use crate::twin::Twin;

/// `twin` with the values of `result` for everything in `terms`.
///
/// Fitted rotor inertia replaces the drive's. A term that was dropped at some joints is at its null
/// value there; one that was dropped at all is no effect of the twin. A Stribeck curve with T_s < T_c is not physical and
/// not kept: that joint is fitted again without it, so that its other values belong together.
///
/// # Errors
/// If bounds are wrong.
pub fn fitted_twin(
    twin: &Twin,
    terms: &Terms,
    arm: &ArmProblem,
    result: &MethodResult,
) -> Result<Twin, IdentificationError> {
    let mut fitted = with_shared(twin, terms, &arm.shared, &result.found.shared);
    let joints = shared::take_off(arm, &result.found.shared);
    for (j, (problem, x)) in joints.iter().zip(&result.found.joints).enumerate() {
        for (name, value) in physical(problem, x)? {
            let name = if name == "offset" { "current_offset" } else { name.as_str() };
            match fitted.held_by_drive(name) {
                Some(values) => values[j] = value,
                None => set(&mut fitted, name, j, joints.len(), value),
            }
        }
    }
    for (effect, _, parameter) in
        effects::of_drive().filter(|(e, ..)| terms.contains(e.about().name))
    {
        fitted.effects.retain(|name| name != effect.about().name);
        fitted.values.remove(parameter);
    }
    let of_drive = |name: &str| effects::of_drive().any(|(e, ..)| e.about().name == name);
    for name in terms.names().into_iter().filter(|name| !of_drive(name)) {
        let found = fill_gaps(&mut fitted, name);
        let known = fitted.effects.iter().any(|e| e == name);
        match (found, known) {
            (true, false) => fitted.effects.push(name.into()),
            (false, true) => fitted.effects.retain(|e| e != name),
            _ => {}
        }
    }
    fitted.keep_possible();
    Ok(fitted)
}

fn set(twin: &mut Twin, name: &str, joint: usize, joints: usize, value: f64) {
    let values = twin.values.entry(name.into()).or_default();
    values.resize(joints, f64::NAN);
    values[joint] = value;
}

/// Gives an effect's parameters their null value (nonlinear ones, which have none, their typical
/// one) at the joints it was dropped from. False, and no values, if it acts at no joint.
fn fill_gaps(twin: &mut Twin, effect: &str) -> bool {
    let parameters = effects::find(effect).map_or(&[][..], |e| e.about().parameters);
    let mut found = false;
    for p in parameters {
        let absent = if p.role == Role::Linear { p.null } else { p.typical };
        if let Some(values) = twin.values.get_mut(p.name) {
            found |= p.role == Role::Linear && values.iter().any(|v| v.is_finite());
            values.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = absent);
        }
    }
    if !found {
        parameters.iter().for_each(|p| drop(twin.values.remove(p.name)));
    }
    found
}

/// Name and value of what a joint's twin is given.
fn physical(problem: &JointProblem, x: &[f64]) -> Result<Vec<(String, f64)>, IdentificationError> {
    let Some(curve) = &problem.curve else { return Ok(named(problem, x)) };
    let (excess, velocity) = (x[1] - x[0], x[x.len() - 1]);
    if excess >= 0.0 {
        let mut all = named(problem, x);
        all.retain(|(name, _)| name != "static");
        all.push(("stribeck_excess".into(), excess));
        return Ok(all);
    }
    let mut straight = problem.clone();
    let coulomb = Column::linear(curve.coulomb.clone(), curve.sign.clone());
    straight.columns.insert(0, coulomb);
    straight.curve = None;
    let prepared = Prepared::new(straight)?;
    let x = prepared.separable(&separable::Settings::default()).x;
    let mut all = named(&prepared.problem, &x);
    all.push(("stribeck_excess".into(), 0.0));
    all.push(("stribeck_velocity".into(), velocity));
    Ok(all)
}

fn named(problem: &JointProblem, x: &[f64]) -> Vec<(String, f64)> {
    problem.parameters().iter().map(|p| p.name.clone()).zip(x.iter().copied()).collect()
}
