//! The motion as an experiment that `armtwin simulate` runs: the twin, with typical values where it
//! leaves some to be fitted.

use std::collections::BTreeMap;

use crate::effects::{Effect, Scope, Size, find};
use crate::motion::{Kind, Settings};
use crate::simulation::Scenario;
use crate::twin::{DriveTable, PerJoint, Twin};

/// The twin with a typical value for everything that is open.
pub fn filled(twin: &Twin) -> Twin {
    let mut filled = twin.clone();
    let open: Vec<&dyn Effect> = twin.open().collect();
    let size = Size::of(&twin.robot);
    for effect in open {
        let about = effect.about();
        let count = if about.scope == Scope::Arm { 1 } else { twin.robot.dof() };
        let missing = |name: &str| !twin.values.contains_key(name);
        for p in about.parameters.iter().filter(|p| missing(p.name) && p.left_out().is_none()) {
            // A drive that is known to have some says how much.
            let drive = (0..count).map(|j| effect.in_drive(&twin.drive, j));
            let known = drive.clone().any(|x| x > 0.0);
            let values = if known { drive.collect() } else { vec![p.on(&size).typical; count] };
            filled.values.insert(p.name.into(), values);
        }
    }
    filled
}

/// `twin` as [`filled`] makes it, moved along `motion`; checked along random sines of the same limits.
pub fn scenario(twin: &Twin, motion: &Settings, seed: u64) -> Scenario {
    let each = |v: &Vec<f64>| Some(PerJoint::Each(v.clone()));
    let drive = twin.bare_drive();
    let names = || twin.effects.iter().filter_map(|name| find(name));
    let mut check = toml::Table::new();
    check.insert("kind".into(), kind_name(Kind::RandomFrequency));
    Scenario {
        robot: twin.source.clone(),
        seed,
        drive: DriveTable {
            gear_ratio: each(&twin.drive.gear_ratio),
            torque_constant: each(&twin.drive.torque_constant),
            rotor_inertia: each(&drive.rotor_inertia),
            current_limit: twin.drive.current_limit.as_ref().and_then(each),
            torque_limit: twin.drive.torque_limit.as_ref().and_then(each),
        },
        motion: motion.clone(),
        check,
        beyond_range: names().map(|e| e.about().name.to_string()).collect(),
        effects: names().map(|e| (e.about().name.to_string(), table(twin, e))).collect(),
        ..Scenario::default()
    }
}

fn kind_name(kind: Kind) -> toml::Value {
    toml::Value::try_from(kind).unwrap_or_else(|_| toml::Value::String(String::new()))
}

/// The `[effects.NAME]` table.
fn table(twin: &Twin, effect: &dyn Effect) -> BTreeMap<String, PerJoint> {
    let value =
        |name: &str| Some((name.to_string(), PerJoint::Each(twin.values.get(name)?.clone())));
    effect.about().parameters.iter().filter_map(|p| value(p.name)).collect()
}
