//! A hidden effect that is switched on while an arm works: `load_friction.joint2=0.1`.

use std::str::FromStr;

use super::Scenario;
use super::inject::JOINTS;
use crate::effects::{self, Effect, Parameter, Scope};
use crate::robot::Chain;
use crate::twin::{DriveTable, PerJoint, Twin};

/// One effect at one joint, or of the whole arm, with a value of one of its parameters.
#[derive(Clone)]
pub struct Switch {
    effect: &'static dyn Effect,
    parameter: &'static Parameter,
    /// From 0; `None` is every joint, or the whole arm.
    joint: Option<usize>,
    value: f64,
    text: String,
}

impl std::fmt::Debug for Switch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::fmt::Display for Switch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for Switch {
    type Err = String;

    /// `EFFECT[.PARAMETER][.jointN]=VALUE`; the first parameter where none is named.
    fn from_str(text: &str) -> Result<Self, String> {
        let form = "write EFFECT[.PARAMETER][.jointN]=VALUE, for example load_friction.joint2=0.1";
        let (place, value) = text.split_once('=').ok_or_else(|| format!("{text}: {form}"))?;
        let value: f64 =
            value.trim().parse().map_err(|_| format!("{value:?} is no number; {form}"))?;
        let mut parts = place.trim().split('.');
        let name = parts.next().unwrap_or_default();
        let effect = effects::find(name)
            .ok_or_else(|| format!("{name}: no such effect; choose from {}", effects::names()))?;
        let parameters = effect.about().parameters;
        let mut parameter = parameters.first().ok_or_else(|| format!("{name} has no parameter"))?;
        let mut joint = None;
        for part in parts {
            if let Some(number) = part.strip_prefix("joint") {
                let number = number.parse::<usize>().ok().filter(|n| *n > 0);
                joint =
                    Some(number.ok_or_else(|| format!("{part}: joints count from joint1"))? - 1);
            } else {
                let names: Vec<_> = parameters.iter().map(|p| p.name).collect();
                let unknown = || format!("{part}: {name} has the parameters {}", names.join(", "));
                parameter = parameters.iter().find(|p| p.name == part).ok_or_else(unknown)?;
            }
        }
        if joint.is_some() && effect.about().scope == Scope::Arm {
            return Err(format!("{name} is of the whole arm; leave the joint out"));
        }
        Ok(Self { effect, parameter, joint, value, text: text.trim().into() })
    }
}

impl Scenario {
    /// With an effect switched on for an arm of `dof` joints: a value that the scenario has is replaced,
    /// parameters that nobody gives are typical ones.
    pub fn switched(&self, switch: &Switch, dof: usize) -> Self {
        let Switch { effect, parameter, joint, value, .. } = switch;
        let about = effect.about();
        let mut scenario = self.clone();
        let table = scenario.effects.entry(about.name.into()).or_default();
        let joints = match (table.get(JOINTS), about.scope) {
            (_, Scope::Arm) => vec![0],
            (Some(PerJoint::All(one)), _) => vec![*one as usize - 1],
            (Some(PerJoint::Each(all)), _) => all.iter().map(|j| *j as usize - 1).collect(),
            (None, _) if table.is_empty() => joint.map_or_else(|| (0..dof).collect(), |j| vec![j]),
            (None, _) => (0..dof).collect(),
        };
        let mut all = joints.clone();
        all.extend(joint.filter(|j| !joints.contains(j)));
        for p in about.parameters {
            let before = table.get(p.name).map(|v| v.expand(joints.len()));
            let mut values = match before {
                Some(values) => values,
                None if p.left_out().is_some() && p.name != parameter.name => continue,
                None => vec![p.typical; joints.len()],
            };
            values.resize(all.len(), p.typical);
            if p.name == parameter.name {
                let here = |j: &usize| joint.is_none_or(|joint| joint == *j);
                values.iter_mut().zip(&all).filter(|(_, j)| here(j)).for_each(|(v, _)| *v = *value);
            }
            table.insert(p.name.into(), PerJoint::Each(values));
        }
        if about.scope != Scope::Arm {
            let numbers = all.iter().map(|j| *j as f64 + 1.0).collect();
            table.insert(JOINTS.into(), PerJoint::Each(numbers));
        }
        scenario
    }
}

impl Scenario {
    /// The arm becomes a twin's: robot, drive, and the effects whose values it knows, in place of those of
    /// the same names; the scenario's other effects stay.
    pub fn is_of(&mut self, twin: &Twin) {
        self.robot.clone_from(&twin.source);
        let Chain { base, tip, flange } = twin.chain.clone();
        (self.base, self.tip, self.flange) = (base, tip, flange);
        let each = |v: &Vec<f64>| Some(PerJoint::Each(v.clone()));
        self.drive = DriveTable {
            gear_ratio: each(&twin.drive.gear_ratio),
            torque_constant: each(&twin.drive.torque_constant),
            rotor_inertia: each(&twin.drive.rotor_inertia),
            current_limit: twin.drive.current_limit.as_ref().and_then(each),
            torque_limit: twin.drive.torque_limit.as_ref().and_then(each),
        };
        for effect in twin.known() {
            let about = effect.about();
            let values = about.parameters.iter().filter_map(|p| {
                Some((p.name.to_string(), PerJoint::Each(twin.values.get(p.name)?.clone())))
            });
            self.effects.insert(about.name.into(), values.collect());
            // Fitted values may lie a little outside.
            self.beyond_range.push(about.name.into());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn switched(scenario: &str, switch: &str) -> Result<Scenario, String> {
        let scenario = Scenario::parse(scenario, "test").unwrap();
        Ok(scenario.switched(&switch.parse()?, 6))
    }

    #[test]
    fn a_new_effect_acts_at_its_joint_with_typical_values_besides() {
        let made = switched("", "load_friction.joint2=0.1").unwrap();
        let table = &made.effects["load_friction"];
        assert_eq!(table[JOINTS], PerJoint::Each(vec![2.0]));
        assert_eq!(table["load_friction"], PerJoint::Each(vec![0.1]));
        made.work_out("test").unwrap();
        let payload = switched("", "payload.payload_mass=2").unwrap();
        assert_eq!(payload.effects["payload"]["payload_mass"], PerJoint::Each(vec![2.0]));
        payload.work_out("test").unwrap();
    }

    #[test]
    fn what_is_there_is_changed_at_that_joint_alone() {
        let friction = "[effects.coulomb]\ncoulomb = 5\n";
        let made = switched(friction, "coulomb.joint3=6.5").unwrap();
        let expected = PerJoint::Each(vec![5.0, 5.0, 6.5, 5.0, 5.0, 5.0]);
        assert_eq!(made.effects["coulomb"]["coulomb"], expected);
        let some = "[effects.coulomb]\ncoulomb = [5, 4]\njoints = [1, 2]\n";
        let made = switched(some, "coulomb.joint6=1").unwrap();
        assert_eq!(made.effects["coulomb"]["coulomb"], PerJoint::Each(vec![5.0, 4.0, 1.0]));
        made.work_out("test").unwrap();
    }

    #[test]
    fn what_is_no_switch_is_told_how_to_write_one() {
        for (text, part) in [
            ("load_friction", "for example load_friction.joint2=0.1"),
            ("friction=1", "no such effect"),
            ("coulomb.joint0=1", "count from joint1"),
            ("coulomb.level=1", "has the parameters coulomb"),
            ("payload.joint2=1", "of the whole arm"),
            ("coulomb=many", "is no number"),
        ] {
            let said = text.parse::<Switch>().unwrap_err();
            assert!(said.contains(part), "{text}: {said}");
        }
    }
}
