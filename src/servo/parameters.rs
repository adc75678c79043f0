//! What of a twin is fitted: parameters of the catalogue's effects, joint by joint.

use super::ServoError;
use crate::effects::{Effect, Parameter, Role, Scope, complete, find};
use crate::robot::DrivePart;
use crate::twin::Twin;

/// A parameter that is fitted.
#[derive(Clone, Copy)]
pub struct Free {
    pub effect: &'static dyn Effect,
    pub parameter: &'static Parameter,
    /// From 0; `None` for one of the whole arm.
    pub joint: Option<usize>,
    pub start: f64,
    pub min: f64,
    pub max: f64,
}

/// A servo's loop swings so fast, Hz: the inertia a search begins with follows from that and its gain.
const LOOP_HZ: f64 = 10.0;
/// No rotor is lighter, kg.m2 at the joint; a joint without inertia cannot be stepped.
const LIGHTEST: f64 = 1e-6;
/// No servo keeps less of its assumed gain, and ten times more is a slip of units.
const LEAST_GAIN: f64 = -0.95;
const MOST_GAIN: f64 = 10.0;

/// Parameters of these effects at all joints, references and exponents left as they are; the search begins
/// at what the twin says, else where the effect vanishes.
///
/// # Errors
/// If there is no such effect, or it cannot be fitted this way.
pub fn free_parameters(twin: &Twin, effects: &[String]) -> Result<Vec<Free>, ServoError> {
    let mut all = Vec::new();
    for name in effects {
        let wrong =
            |problem: &str| ServoError::Term { name: name.clone(), problem: problem.into() };
        let effect = find(name).ok_or_else(|| wrong("no such effect; see armtwin effects"))?;
        let about = effect.about();
        if effect.gives_way() {
            return Err(ServoError::Elastic { effect: name.clone() });
        }
        let joints: Vec<Option<usize>> = match about.scope {
            Scope::Arm => vec![None],
            _ => (0..twin.robot.dof()).map(Some).collect(),
        };
        let searched =
            |p: &&Parameter| !p.is_reference() && !p.is_detail() && !p.name.ends_with("_exponent");
        for joint in joints {
            for parameter in about.parameters.iter().filter(searched) {
                let start = start(twin, effect, parameter, joint.unwrap_or(0));
                let (min, max) = bounds(effect, parameter);
                all.push(Free { effect, parameter, joint, start: start.clamp(min, max), min, max });
            }
        }
    }
    Ok(all)
}

fn bounds(effect: &dyn Effect, p: &Parameter) -> (f64, f64) {
    match (effect.stands_for(), p.name) {
        (Some(DrivePart::RotorInertia), _) => (LIGHTEST, p.max),
        (_, "servo_gain_error") => (LEAST_GAIN, MOST_GAIN),
        _ => (p.min, p.max),
    }
}

fn start(twin: &Twin, effect: &dyn Effect, p: &Parameter, joint: usize) -> f64 {
    if let Some(given) = twin.values.get(p.name).and_then(|v| v.get(joint)) {
        return *given;
    }
    if let Some(DrivePart::RotorInertia) = effect.stands_for() {
        let known = effect.in_drive(&twin.drive, joint);
        let gain = twin.drive.servo.as_ref().map_or(0.0, |s| s.gain[joint]);
        let guess = gain / (std::f64::consts::TAU * LOOP_HZ).powi(2);
        return if known > 0.0 { known } else { guess };
    }
    if p.role == Role::Linear && p.null.is_finite() { p.null } else { p.typical }
}

/// `twin` with these values.
pub fn with_values(twin: &Twin, free: &[Free], x: &[f64]) -> Twin {
    let mut twin = twin.clone();
    for (f, &value) in free.iter().zip(x) {
        let about = f.effect.about();
        let count = if f.joint.is_some() { twin.robot.dof() } else { 1 };
        let usual =
            if f.parameter.null.is_finite() { f.parameter.null } else { f.parameter.typical };
        let values =
            twin.values.entry(f.parameter.name.into()).or_insert_with(|| vec![usual; count]);
        values[f.joint.unwrap_or(0)] = value;
        if !twin.effects.iter().any(|e| e == about.name) {
            twin.effects.push(about.name.into());
        }
    }
    complete_references(&mut twin, free);
    twin
}

/// References follow from what was fitted.
fn complete_references(twin: &mut Twin, free: &[Free]) {
    for f in free {
        let about = f.effect.about();
        let joint = f.joint.unwrap_or(0);
        let value = |name: &str| twin.values.get(name).and_then(|v| v.get(joint)).copied();
        let searched = |p: &Parameter| !p.is_reference();
        let given = |name: &'static str| {
            about
                .parameters
                .iter()
                .find(|p| p.name == name)
                .filter(|p| searched(p))
                .and_then(|_| value(name))
        };
        let Ok(all) = complete(f.effect, given) else { continue };
        let count = if f.joint.is_some() { twin.robot.dof() } else { 1 };
        for (p, v) in about.parameters.iter().zip(all).filter(|(p, _)| p.is_reference()) {
            let values = twin.values.entry(p.name.into()).or_insert_with(|| vec![p.typical; count]);
            values[joint] = v;
        }
    }
}
