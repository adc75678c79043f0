//! The twin with what was found in it.

use super::arm::Prepared;
use super::assemble::ArmProblem;
use super::error::IdentificationError;
use super::problem::{Column, JointProblem};
use super::terms::Terms;
use super::{MethodResult, separable, shared};
use crate::twin::Twin;

/// `twin` with the values of `result` for everything in `terms`.
///
/// Fitted rotor inertia replaces the drive's. A Stribeck curve with T_s < T_c is not physical and
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
    let mut fitted = twin.clone();
    let joints = shared::take_off(arm, &result.found.shared);
    for (j, (problem, x)) in joints.iter().zip(&result.found.joints).enumerate() {
        for (name, value) in physical(problem, x)? {
            match name.as_str() {
                "rotor_inertia" => fitted.drive.rotor_inertia[j] = value,
                "offset" => set(&mut fitted, "current_offset", j, joints.len(), value),
                other => set(&mut fitted, other, j, joints.len(), value),
            }
        }
    }
    for (p, value) in arm.shared.iter().zip(&result.found.shared) {
        fitted.values.insert(p.name.clone(), vec![*value]);
    }
    let names = terms.names().into_iter().filter(|n| *n != "rotor_inertia");
    for name in names {
        if !fitted.effects.iter().any(|e| e == name) {
            fitted.effects.push(name.into());
        }
    }
    if terms.contains("rotor_inertia") {
        fitted.effects.retain(|e| e != "rotor_inertia");
        fitted.values.remove("rotor_inertia");
    }
    Ok(fitted)
}

fn set(twin: &mut Twin, name: &str, joint: usize, joints: usize, value: f64) {
    let values = twin.values.entry(name.into()).or_default();
    values.resize(joints, 0.0);
    values[joint] = value;
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
    let coulomb = Column { parameter: curve.coulomb.clone(), values: curve.sign.clone() };
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
