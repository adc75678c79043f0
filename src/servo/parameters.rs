//! What of a twin is fitted: parameters of the catalogue's effects, joint by joint.

use std::ops::Range;

use super::ServoError;
use crate::effects::{Effect, Parameter, Role, Scope, Size, complete, find};
use crate::robot::{DrivePart, Robot};
use crate::twin::Twin;

/// A parameter that is fitted.
#[derive(Clone, Copy)]
pub struct Free {
    pub effect: &'static dyn Effect,
    pub parameter: &'static Parameter,
    /// From 0; `None` for one value of the whole arm, which is that of every joint where the effect is of joints.
    pub joint: Option<usize>,
    pub start: f64,
    pub min: f64,
    pub max: f64,
    /// Where it is expected.
    pub expected: f64,
    /// How far from there, a standard deviation; infinite where nothing is expected.
    pub spread: f64,
}

impl Free {
    /// This parameter where it is expected to be off by as much as such effects are on such an arm, or by as much as it is
    /// where that is more: what a recording does not tell stays where it was. What goes with another value of the
    /// effect, as the moments of a load go with its mass, goes with that of `twin`.
    pub fn near_start(self, twin: &Twin) -> Self {
        let about = self.effect.about();
        let joint = self.joint.unwrap_or(0);
        let place = about.parameters.iter().position(|p| p.name == self.parameter.name);
        let expected = self.effect.expected(&twin.robot, joint, &references(twin, &self));
        let expected = place.and_then(|i| expected.get(i).copied()).filter(|s| s.is_finite());
        let usual = match self.parameter.on(&Size::of(&twin.robot)).typical.abs() {
            0.0 => self.max - self.min,
            typical => typical,
        };
        Self { spread: expected.unwrap_or(usual.max(self.start.abs())), ..self }
    }

    /// Is a value at an end of the range that is searched?
    pub(super) fn is_bound(&self, value: f64) -> bool {
        let reach = 1e-6 * (self.max - self.min).min(1.0);
        value - self.min <= reach || self.max - value <= reach
    }

    /// What a twin has of it, in the parameter's unit.
    pub(super) fn value_in(&self, twin: &Twin) -> f64 {
        stated(twin, self.effect, self.parameter.name, self.joint.unwrap_or(0))
    }

    /// By how much a value is another where a difference is taken, a `share` of it, inside its range.
    pub(super) fn step(&self, value: f64, most: f64, share: f64) -> f64 {
        let size = share * value.abs().max(SMALL * self.usual().min(1.0));
        if value + size > most { -size } else { size }
    }

    /// How many values a twin has of it, and which of them this one is.
    fn places(&self, robot: &Robot) -> (usize, Range<usize>) {
        match (self.effect.about().scope, self.joint) {
            (Scope::Arm, _) => (1, 0..1),
            (_, None) => (robot.dof(), 0..robot.dof()),
            (_, Some(j)) => (robot.dof(), j..j + 1),
        }
    }

    /// Its usual size; what is usually none may still be something, for its range is not empty.
    pub fn usual(&self) -> f64 {
        match self.parameter.typical.abs() {
            0.0 => self.max - self.min,
            typical => typical,
        }
    }
}

/// Steps of differences, as shares of the value, or of what the parameter usually is where it is small: of what a step of the arm gives,
/// and of what a simulation gives. Teeth meet a step sooner or later, so that errors go up and down by what is no slope.
pub(super) const FINE: f64 = 1e-5;
pub(super) const COARSE: f64 = 1e-2;
const SMALL: f64 = 0.05;
/// A servo's loop swings so fast, Hz: the inertia a search begins with follows from that and its gain.
const LOOP_HZ: f64 = 10.0;
/// No rotor is lighter, kg.m2 at the joint; a joint without inertia cannot be stepped.
const LIGHTEST: f64 = 1e-6;
/// No servo keeps less of its assumed gain or torque, and ten times more gain is a slip of units.
const LEAST_GAIN: f64 = -0.95;
const MOST_GAIN: f64 = 10.0;
/// What others are read as a share of is never nothing, nor does a search begin there: a load without mass has no
/// centre. Shares of the end of its range.
const LEAST_SHARE: f64 = 1e-4;
const FIRST_SHARE: f64 = 1e-2;

/// Parameters of these effects at all joints, references and what a search has left as they are; the search begins
/// at what the twin says, else where the effect vanishes.
///
/// # Errors
/// If there is no such effect, or it cannot be fitted this way.
pub fn free_parameters(twin: &Twin, effects: &[String]) -> Result<Vec<Free>, ServoError> {
    let (mut all, size) = (Vec::new(), Size::of(&twin.robot).laden());
    for name in effects {
        let wrong =
            |problem: &str| ServoError::Term { name: name.clone(), problem: problem.into() };
        let effect = find(name).ok_or_else(|| wrong("no such effect; see armtwin effects"))?;
        let about = effect.about();
        let joints: Vec<Option<usize>> = match about.scope {
            Scope::Arm => vec![None],
            _ => (0..twin.robot.dof()).map(Some).collect(),
        };
        let is_kept = |p: &Parameter| p.is_reference() || effect.kept().contains(&p.name);
        let searched = |p: &&Parameter| !p.is_detail() && !is_kept(p);
        for joint in joints {
            for parameter in about.parameters.iter().filter(searched) {
                // Bodies and what joins them grow with the arm; any servo may sit at a joint.
                let of_servo = about.scope == Scope::Joint;
                let own = if of_servo { *parameter } else { parameter.on(&size) };
                let start = start(twin, effect, &own, joint.unwrap_or(0));
                let (min, max) = bounds(twin, effect, &own, joint.unwrap_or(0));
                let start = start.clamp(min, max);
                let (expected, spread) = (start, f64::INFINITY);
                all.push(Free { effect, parameter, joint, start, min, max, expected, spread });
            }
        }
    }
    begin_near(&mut all, twin.robot.reach());
    Ok(all)
}

/// A load found along another motion than the arm's own may be far off the flange: no search begins there.
fn begin_near(all: &mut [Free], reach: f64) {
    let starts: Vec<(&str, Option<usize>, f64)> =
        all.iter().map(|f| (f.parameter.name, f.joint, f.start)).collect();
    for f in all {
        let over = f.effect.readable().iter().find(|r| r.of == f.parameter.name).map(|r| r.over);
        let start = starts.iter().find(|(name, joint, _)| Some(*name) == over && *joint == f.joint);
        if let Some((.., over)) = start.filter(|(.., over)| *over > 0.0) {
            f.start = f.start.clamp(-reach * over, reach * over);
            f.expected = f.start;
        }
    }
}

fn bounds(twin: &Twin, effect: &dyn Effect, p: &Parameter, joint: usize) -> (f64, f64) {
    match (effect.stands_for(), p.name) {
        (Some(DrivePart::RotorInertia), _) => (LIGHTEST, p.max),
        (_, "servo_gain_error") => (LEAST_GAIN, MOST_GAIN),
        (_, "max_torque_error") => (LEAST_GAIN, p.max),
        // A motor brakes itself; none drives itself on.
        (_, "servo_damping") => {
            let assumed = twin.drive.servo.as_ref().map_or(0.0, |s| s.damping[joint]);
            (p.min.max(-assumed), p.max)
        }
        _ if carries_others(effect, p) => (LEAST_SHARE * p.max, p.max),
        _ => (p.min, p.max),
    }
}

/// Are other parameters of the effect read as a share of this one?
fn carries_others(effect: &dyn Effect, p: &Parameter) -> bool {
    effect.readable().iter().any(|ratio| ratio.over == p.name) && p.min == 0.0
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
    match p.role {
        _ if carries_others(effect, p) => FIRST_SHARE * p.max,
        Role::Linear if p.null.is_finite() => p.null,
        _ => p.typical,
    }
}

/// What a twin has of an effect's parameter at a joint (from 0), in its unit; zero where it has nothing of it.
pub fn stated(twin: &Twin, effect: &dyn Effect, parameter: &str, joint: usize) -> f64 {
    let listed = twin.values.get(parameter).and_then(|v| v.get(joint)).copied();
    listed.unwrap_or_else(|| effect.in_drive(&twin.drive, joint))
}

/// `twin` with these values.
pub fn with_values(twin: &Twin, free: &[Free], x: &[f64]) -> Twin {
    let mut twin = twin.clone();
    for (f, &value) in free.iter().zip(x) {
        let about = f.effect.about();
        let (count, here) = f.places(&twin.robot);
        let usual =
            if f.parameter.null.is_finite() { f.parameter.null } else { f.parameter.typical };
        // What the drive has at the other joints stays.
        let at = |j: usize| usual + f.effect.in_drive(&twin.drive, j);
        let values = twin.values.entry(f.parameter.name.into());
        values.or_insert_with(|| (0..count).map(at).collect())[here].fill(value);
        if !twin.effects.iter().any(|e| e == about.name) {
            twin.effects.push(about.name.into());
        }
    }
    keep_near(&mut twin, free);
    complete_shapes(&mut twin, free);
    complete_references(&mut twin, free);
    twin
}

/// No load's centre is further from the flange than the arm reaches: between two steps of a search its mass may be
/// next to nothing, and its first moments not yet.
fn keep_near(twin: &mut Twin, free: &[Free]) {
    let reach = twin.robot.reach();
    for ratio in
        free.iter().flat_map(|f| f.effect.readable().iter().filter(|r| r.of == f.parameter.name))
    {
        let Some(over) = twin.values.get(ratio.over).cloned() else { continue };
        let of = twin.values.get_mut(ratio.of).into_iter().flatten();
        of.zip(over).for_each(|(of, over)| *of = of.clamp(-reach * over, reach * over));
    }
}

/// What is not fitted is usual where the twin does not have it.
fn complete_shapes(twin: &mut Twin, free: &[Free]) {
    let size = Size::of(&twin.robot);
    for f in free.iter().filter(|f| !f.effect.kept().is_empty()) {
        let (count, _) = f.places(&twin.robot);
        let kept = |p: &&Parameter| f.effect.kept().contains(&p.name);
        for p in f.effect.about().parameters.iter().filter(kept) {
            let values = twin.values.entry(p.name.into());
            values.or_insert_with(|| vec![p.on(&size).typical; count]);
        }
    }
}

/// References follow from what was fitted.
fn complete_references(twin: &mut Twin, free: &[Free]) {
    for f in free {
        let parameters = f.effect.about().parameters;
        let Some(all) = completed(twin, f) else { continue };
        let (count, here) = f.places(&twin.robot);
        for (p, v) in parameters.iter().zip(all).filter(|(p, _)| p.is_reference()) {
            let values = twin.values.entry(p.name.into()).or_insert_with(|| vec![p.typical; count]);
            values[here.clone()].fill(v);
        }
    }
}

/// What the linear parameters of an effect refer to, by its values in a twin; nothing where the twin has none of it.
fn references(twin: &Twin, f: &Free) -> Vec<f64> {
    let linear = f.effect.about().parameters.iter().filter(|p| p.role == Role::Linear).count();
    completed(twin, f).map_or(Vec::new(), |all| all[linear..].to_vec())
}

/// All values of an effect in a twin, its references as they follow from the others.
fn completed(twin: &Twin, f: &Free) -> Option<Vec<f64>> {
    let (parameters, joint) = (f.effect.about().parameters, f.joint.unwrap_or(0));
    let given = |name: &'static str| {
        let p = parameters.iter().find(|p| p.name == name)?;
        let values = twin.values.get(name).filter(|_| !p.is_reference());
        values.and_then(|v| v.get(joint)).copied()
    };
    complete(f.effect, given).ok()
}
