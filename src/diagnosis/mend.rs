//! The mended twin: what it lacked, and the friction that was fitted with it, written into it.

use std::collections::{BTreeMap, BTreeSet};

use super::{Cause, Change, Value};
use crate::effects::{self, CATALOGUE, Effect, Parameter, Role, Scope};
use crate::twin::Twin;

/// `twin` with the `fitted` values of what it left open and with the `causes` in it.
///
/// A cause at one joint gets values at every joint: elsewhere those at which it vanishes. Rotor
/// inertia goes to the drive: a fitted one replaces the drive's. What enters linearly is added to
/// what is there (a drive's rotor, a link's fitted mass).
pub fn mend(twin: &Twin, fitted: &BTreeMap<String, Vec<f64>>, causes: &[Cause]) -> Twin {
    let changes: Vec<Change> = causes.iter().map(Change::from).collect();
    changed(twin, fitted, &changes)
}

/// The twin with values found and with changes that are no causes yet.
pub fn changed(twin: &Twin, fitted: &BTreeMap<String, Vec<f64>>, changes: &[Change]) -> Twin {
    let mut mended = twin.clone();
    for (name, values) in fitted.iter().filter(|(_, v)| v.iter().all(|v| v.is_finite())) {
        mended.values.insert(name.clone(), values.clone());
        list(&mut mended, name);
    }
    for change in changes {
        add(&mut mended, change);
    }
    mended.settle_drive();
    keep_physical(&mut mended);
    mended
}

/// The effect that a fitted parameter belongs to is one of the twin's.
fn list(twin: &mut Twin, parameter: &str) {
    let has = |e: &&&dyn Effect| e.about().parameters.iter().any(|p| p.name == parameter);
    let Some(effect) = CATALOGUE.iter().find(has) else { return };
    if !twin.effects.iter().any(|e| e == effect.about().name) {
        twin.effects.push(effect.about().name.into());
    }
}

fn add(twin: &mut Twin, change: &Change) {
    let Some(effect) = effects::find(&change.effect) else { return };
    let about = effect.about();
    let dof = twin.robot.dof();
    let count = if about.scope == Scope::Arm { 1 } else { dof };
    let at: Vec<usize> = match about.scope {
        Scope::Arm => vec![0],
        _ if change.joints.is_empty() => (0..dof).collect(),
        _ => places(change).into_iter().filter(|j| *j < dof).collect(),
    };
    // References follow from the other values where they are not given.
    for p in about.parameters.iter().filter(|p| !p.is_reference()) {
        let is_first = p.name == about.parameters[0].name;
        let has = |j: usize| if is_first { effect.in_drive(&twin.drive, j) } else { 0.0 };
        let without = |j: usize| has(j) + absent(p);
        let values = twin.values.entry(p.name.into());
        let values = values.or_insert_with(|| (0..count).map(without).collect());
        for (j, value) in values.iter_mut().enumerate().filter(|(j, _)| at.contains(j)) {
            let here = |v: &&Value| v.joint.is_none_or(|joint| joint == j + 1);
            let of_change = |v: &&Value| v.name == p.name && v.value.is_finite() && here(v);
            let Some(found) = change.parameters.iter().find(of_change) else { continue };
            let adds = p.role == Role::Linear && !change.replaces;
            *value = if adds { *value + found.value } else { found.value };
        }
    }
    if !twin.effects.iter().any(|e| e == about.name) {
        twin.effects.push(about.name.into());
    }
}

/// Joints, from 0, that a change has values for.
fn places(change: &Change) -> Vec<usize> {
    let own: BTreeSet<usize> = change.parameters.iter().filter_map(|v| v.joint).collect();
    let named = change.joints.iter().copied().filter(|_| own.is_empty());
    own.iter().copied().chain(named).map(|j| j - 1).collect()
}

/// Where an effect does not act; nonlinear parameters have no such value, any will do.
fn absent(p: &Parameter) -> f64 {
    match p.null {
        null if null.is_finite() => null,
        null if null.is_infinite() => p.max,
        _ => p.typical,
    }
}

/// A twin's file refuses a negative value of what cannot be negative (friction of a joint that
/// hardly moves may come out so).
fn keep_physical(twin: &mut Twin) {
    let all = twin.effects.iter().filter_map(|name| effects::find(name));
    for p in all.flat_map(|e| e.about().parameters).filter(|p| p.min >= 0.0) {
        let values = twin.values.get_mut(p.name).into_iter().flatten();
        values.for_each(|v| *v = v.max(p.min));
    }
    twin.drive.rotor_inertia.iter_mut().for_each(|inertia| *inertia = inertia.max(0.0));
    twin.keep_possible();
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::diagnosis::Checked;

    fn cause(effect: &str, joints: &[usize], values: &[(&str, f64)]) -> Cause {
        let value = |&(name, value): &(&str, f64)| Value {
            name: name.into(),
            joint: None,
            unit: String::new(),
            value,
            low: value,
            high: value,
            at_bound: false,
        };
        Cause {
            effect: effect.into(),
            joints: joints.into(),
            probability: 1.0,
            equivalent: Vec::new(),
            parameters: values.iter().map(value).collect(),
            shrink: Checked::default(),
            replaces: None,
            recording: None,
            found_without_check: true,
            cause: String::new(),
            remedy: String::new(),
        }
    }

    fn fitted() -> BTreeMap<String, Vec<f64>> {
        let friction = vec![6.0, 7.0, 5.0, 1.5, 1.2, -0.1];
        BTreeMap::from([("coulomb".into(), friction), ("viscous".into(), vec![3.0; 6])])
    }

    #[test]
    fn a_mended_twin_holds_what_was_found_and_comes_back_from_its_file() {
        let causes = [
            cause("stribeck", &[2], &[("stribeck_excess", 4.0), ("stribeck_velocity", 0.03)]),
            cause("payload", &[], &[("payload_mass", 2.0), ("payload_moment_z", 0.14)]),
            cause("rotor_inertia", &[3], &[("rotor_inertia", 0.2)]),
            cause("rotor_inertia", &[5], &[("rotor_inertia", -0.4)]),
        ];
        let mut twin = Twin::default();
        twin.drive.rotor_inertia = vec![1.0; 6];
        let mended = mend(&twin, &fitted(), &causes);
        assert_eq!(mended.values["stribeck_excess"], [0.0, 4.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(mended.values["stribeck_velocity"][1], 0.03);
        assert_eq!(mended.values["payload_mass"], [2.0]);
        assert_eq!(mended.values["payload_moment_x"], [0.0]);
        assert_eq!(mended.drive.rotor_inertia, [1.0, 1.0, 1.2, 1.0, 0.6, 1.0]);
        assert_eq!(mended.values["coulomb"][5], 0.0, "friction does not push");
        assert_eq!(mended.open().count(), 0);
        let again = Twin::parse(&mended.to_toml(), Path::new("twin.toml")).unwrap();
        assert_eq!(again, mended);
    }

    /// The second of two causes of one kind does not undo the first.
    #[test]
    fn one_effect_at_two_joints() {
        let at = |joint, excess| {
            cause("stribeck", &[joint], &[("stribeck_excess", excess), ("stribeck_velocity", 0.05)])
        };
        let mended = mend(&Twin::default(), &fitted(), &[at(1, 2.0), at(4, 0.5)]);
        assert_eq!(mended.values["stribeck_excess"], [2.0, 0.0, 0.0, 0.5, 0.0, 0.0]);
        assert_eq!(mended.effects, ["coulomb", "viscous", "stribeck"]);
    }

    /// Every effect of the catalogue, at one joint, makes a twin whose file is accepted.
    #[test]
    fn any_cause_can_be_written() {
        for effect in effects::CATALOGUE {
            let about = effect.about();
            let values: Vec<_> = about.parameters.iter().map(|p| (p.name, p.typical)).collect();
            let joints: &[usize] = if about.scope == Scope::Arm { &[] } else { &[3] };
            let mended = mend(&Twin::default(), &fitted(), &[cause(about.name, joints, &values)]);
            let again = Twin::parse(&mended.to_toml(), Path::new("twin.toml"));
            assert_eq!(again.unwrap(), mended, "{}", about.name);
        }
    }

    #[test]
    fn a_fitted_rotor_inertia_stands_in_the_drive() {
        let twin = Twin { effects: vec!["rotor_inertia".into()], ..Twin::default() };
        let found = BTreeMap::from([("rotor_inertia".into(), vec![0.5; 6])]);
        let mended = mend(&twin, &found, &[]);
        assert_eq!(mended.drive.rotor_inertia, [0.5; 6]);
        assert!(mended.effects.is_empty() && mended.values.is_empty());
    }
}
