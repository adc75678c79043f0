//! A twin: an arm, its drive, and the effects its owner already models.
//!
//! Its torque, N.m, is what a drive must supply according to what the twin knows:
//! tau = ID(q, qd, qdd) + Ja qdd + sum of the effects whose values are known.

mod file;
mod parts;

#[cfg(test)]
mod tests;

pub use file::TwinError;
pub use parts::{DriveTable, PerJoint, read_robot};

use std::collections::BTreeMap;

use crate::effects::{Effect, Mechanism, Motion, Role, Scope, find};
use crate::robot::{Drive, Robot, inverse_dynamics_series};
use crate::series::JointSeries;

/// What is known about the arm before a recording is seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Twin {
    /// A built-in arm's name or the path of a URDF, from which `robot` was read.
    pub source: String,
    pub robot: Robot,
    pub drive: Drive,
    /// Names from the catalogue.
    pub effects: Vec<String>,
    /// Values that are known, by parameter name, one per joint (one in all for the whole arm);
    /// what is absent is fitted. A `rotor_inertia` here stands in place of the drive's.
    pub values: BTreeMap<String, Vec<f64>>,
}

impl Twin {
    /// Effects whose values are all known: part of [`Twin::torque`].
    pub fn known(&self) -> impl Iterator<Item = &'static dyn Effect> {
        self.catalogued().filter(|e| self.knows(*e))
    }

    /// Effects that lack a value for some parameter: to be fitted.
    pub fn open(&self) -> impl Iterator<Item = &'static dyn Effect> {
        self.catalogued().filter(|e| !self.knows(*e))
    }

    /// The values of an effect at one joint in the order of its parameters, where known.
    pub fn values_at(&self, effect: &dyn Effect, joint: usize) -> Option<Vec<f64>> {
        let at = if effect.about().scope == Scope::Arm { 0 } else { joint };
        let value = |name| self.values.get(name).and_then(|v| v.get(at)).copied();
        effect.about().parameters.iter().map(|p| value(p.name)).collect()
    }

    /// What the drive must supply along a motion of `self.robot`, N.m.
    pub fn torque(&self, motion: &Motion<'_>) -> JointSeries {
        let mut tau = inverse_dynamics_series(&self.robot, motion.q, motion.qd, motion.qdd);
        let laden = self.laden();
        for joint in 0..self.robot.dof() {
            let out = tau.joint_mut(joint);
            if !self.values.contains_key("rotor_inertia") {
                add_scaled(out, self.drive.rotor_inertia[joint], motion.qdd.joint(joint));
            }
            for effect in self.known() {
                let Some(values) = self.values_at(effect, joint) else { continue };
                let robot = match effect.about().scope {
                    Scope::Arm => &self.robot,
                    Scope::Joint => &laden,
                };
                add_effect(out, effect, &values, &Motion { robot, ..*motion }, joint);
            }
        }
        tau
    }

    /// The robot with what is known about the whole arm built in: its gears carry the payload, too.
    fn laden(&self) -> Robot {
        let mut mechanism = Mechanism::new(self.robot.clone());
        for effect in self.known().filter(|e| e.about().scope == Scope::Arm) {
            if let Some(values) = self.values_at(effect, 0) {
                effect.build(&values, 0, &mut mechanism);
            }
        }
        mechanism.robot
    }

    fn catalogued(&self) -> impl Iterator<Item = &'static dyn Effect> {
        self.effects.iter().filter_map(|name| find(name))
    }

    fn knows(&self, effect: &dyn Effect) -> bool {
        effect.about().parameters.iter().all(|p| self.values.contains_key(p.name))
    }
}

/// The built-in UR5 with the paper's drive; Coulomb and viscous friction to be fitted.
impl Default for Twin {
    fn default() -> Self {
        let table = &crate::robot::tables::ur5::TABLE;
        Self {
            source: table.name.into(),
            robot: table.robot(),
            drive: Drive::ur5(),
            effects: vec!["coulomb".into(), "viscous".into()],
            values: BTreeMap::new(),
        }
    }
}

fn add_effect(
    out: &mut [f64],
    effect: &dyn Effect,
    values: &[f64],
    motion: &Motion<'_>,
    joint: usize,
) {
    let parameters = effect.about().parameters;
    let linear = parameters.iter().filter(|p| p.role == Role::Linear).count();
    let columns = effect.columns(motion, joint, &values[linear..]);
    for (column, &value) in columns.iter().zip(values) {
        add_scaled(out, value, column);
    }
}

fn add_scaled(out: &mut [f64], factor: f64, column: &[f64]) {
    out.iter_mut().zip(column).for_each(|(o, c)| *o += factor * c);
}
