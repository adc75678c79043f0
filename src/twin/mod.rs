//! A twin: an arm, its drive, and the effects its owner already models.
//!
//! Its torque, N.m, is what a drive must supply according to what the twin knows:
//! tau = ID(q, qd, qdd) + Ja qdd + sum of the effects whose values are known.

mod correct;
mod file;
mod named;
mod of_drive;
mod parts;
mod possible;

#[cfg(test)]
mod tests;

pub use file::TwinError;
pub use parts::{DriveTable, PerJoint, ServoTable, read_robot};

use std::collections::BTreeMap;

use crate::effects::{
    CATALOGUE, DriveKind, Effect, Mechanism, Motion, Parameter, Role, Scope, complete, find,
};
use crate::robot::{Chain, Drive, Robot, inverse_dynamics_series};
use crate::series::JointSeries;

/// What is known about the arm before a recording is seen.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Twin {
    /// A built-in arm's name or the path of a URDF, from which `robot` was read.
    pub source: String,
    /// Which part of that robot is the arm.
    pub chain: Chain,
    pub robot: Robot,
    /// What was assumed where the URDF does not say.
    pub notes: Vec<String>,
    pub drive: Drive,
    /// Names from the catalogue.
    pub effects: Vec<String>,
    /// Values that are known, by parameter name, one per joint (one in all for the whole arm);
    /// what is absent is fitted. What the drive has a place for stands here in place of the drive's.
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

    /// Can an arm with such drives have the effect?
    pub fn can_have(&self, effect: &dyn Effect) -> bool {
        match effect.of_drive() {
            DriveKind::Any => true,
            DriveKind::Current => self.drive.servo.is_none(),
            DriveKind::Servo => self.drive.servo.is_some(),
        }
    }

    /// The values of an effect at one joint in the order of its parameters, where known.
    pub fn values_at(&self, effect: &dyn Effect, joint: usize) -> Option<Vec<f64>> {
        let at = if effect.about().scope == Scope::Arm { 0 } else { joint };
        let value = |name: &str| self.values.get(name).and_then(|v| v.get(at)).copied();
        complete(effect, value).ok()
    }

    /// The nonlinear parameters of an open effect at one joint: as far as the twin states them, else
    /// typical.
    pub fn nonlinear_at(&self, effect: &dyn Effect, joint: usize) -> Vec<f64> {
        let about = effect.about();
        let at = if about.scope == Scope::Arm { 0 } else { joint };
        let stated = |name: &str| self.values.get(name).and_then(|v| v.get(at)).copied();
        let nonlinear = about.parameters.iter().filter(|p| p.role == Role::Nonlinear);
        nonlinear.map(|p| stated(p.name).unwrap_or(p.typical)).collect()
    }

    /// What the drive must supply along a motion of `self.robot`, N.m.
    pub fn torque(&self, motion: &Motion<'_>) -> JointSeries {
        let mut tau = inverse_dynamics_series(&self.robot, motion.q, motion.qd, motion.qdd);
        for (joint, inertia) in self.bare_drive().rotor_inertia.into_iter().enumerate() {
            add_scaled(tau.joint_mut(joint), inertia, motion.qdd.joint(joint));
        }
        let laden = self.laden();
        let mut so_far = Mechanism::new(self.robot.clone());
        // In the order of the catalogue: what scales the drive's torque comes after what makes it,
        // and a base tilts with the loads on it.
        for effect in CATALOGUE.iter().copied().filter(|e| self.knows_of(*e)) {
            let robot = match effect.about().scope {
                Scope::Arm | Scope::Link => so_far.robot.clone(),
                Scope::Joint => laden.clone(),
            };
            let known = tau.clone();
            for (joint, values) in self.acting(effect) {
                let motion = Motion {
                    robot: &robot,
                    known: Some(&known),
                    giving: &so_far.transmission,
                    rigid: None,
                    ..*motion
                };
                add(effect, joint, &values, &motion, &mut tau);
                effect.build(&values, joint, &mut so_far);
            }
        }
        tau
    }

    /// The joints of an effect whose values are known, with these; one joint for the whole arm.
    fn acting(&self, effect: &dyn Effect) -> Vec<(usize, Vec<f64>)> {
        let joints = if effect.about().scope == Scope::Arm { 1 } else { self.robot.dof() };
        (0..joints).filter_map(|j| Some((j, self.values_at(effect, j)?))).collect()
    }

    /// The robot with the links and loads that are known built in: what its gears carry.
    pub fn laden(&self) -> Robot {
        self.mechanism(|_| true).robot
    }

    /// The arm with the drive's rotors and with all that is known and asked for by `which` built in,
    /// in the order of the catalogue.
    pub fn mechanism(&self, which: impl Fn(&dyn Effect) -> bool) -> Mechanism {
        let mut mechanism =
            Mechanism::with_armature(self.robot.clone(), self.bare_drive().rotor_inertia);
        let known = CATALOGUE.iter().copied().filter(|e| self.knows_of(*e));
        for effect in known.filter(|e| which(*e)) {
            self.build(effect, &mut mechanism);
        }
        mechanism
    }

    /// What an effect whose values are known changes of the mechanism.
    fn build(&self, effect: &dyn Effect, mechanism: &mut Mechanism) {
        for (joint, values) in self.acting(effect) {
            effect.build(&values, joint, mechanism);
        }
    }

    fn knows_of(&self, effect: &dyn Effect) -> bool {
        self.effects.iter().any(|name| name == effect.about().name) && self.knows(effect)
    }

    /// Effects that the twin holds, as the catalogue has them.
    pub fn catalogued(&self) -> impl Iterator<Item = &'static dyn Effect> {
        self.effects.iter().filter_map(|name| find(name))
    }

    fn knows(&self, effect: &dyn Effect) -> bool {
        let given = |p: &Parameter| p.left_out().is_some() || self.values.contains_key(p.name);
        effect.about().parameters.iter().all(given)
    }
}

/// The built-in UR5 with the paper's drive; Coulomb and viscous friction to be fitted.
impl Default for Twin {
    fn default() -> Self {
        let table = &crate::robot::tables::ur5::TABLE;
        Self {
            source: table.name.into(),
            chain: Chain::default(),
            robot: table.robot(),
            notes: Vec::new(),
            drive: Drive::ur5(),
            effects: vec!["coulomb".into(), "viscous".into()],
            values: BTreeMap::new(),
        }
    }
}

/// Adds the torque of an effect with these values at one joint.
fn add(
    effect: &dyn Effect,
    joint: usize,
    values: &[f64],
    motion: &Motion<'_>,
    tau: &mut JointSeries,
) {
    let parameters = effect.about().parameters;
    let linear = parameters.iter().filter(|p| p.role == Role::Linear).count();
    let (linear, nonlinear) = values.split_at(linear);
    if linear.iter().all(|v| *v == 0.0) {
        return;
    }
    if effect.about().scope == Scope::Joint {
        let columns = effect.columns(motion, joint, nonlinear);
        return add_columns(tau, joint, linear, columns.iter().map(Vec::as_slice));
    }
    let reach = effect.reach(motion, joint, nonlinear);
    for at in 0..tau.joints() {
        add_columns(tau, at, linear, reach.iter().map(|series| series.joint(at)));
    }
}

fn add_columns<'a>(
    tau: &mut JointSeries,
    joint: usize,
    values: &[f64],
    columns: impl Iterator<Item = &'a [f64]>,
) {
    for (column, &value) in columns.zip(values) {
        add_scaled(tau.joint_mut(joint), value, column);
    }
}

fn add_scaled(out: &mut [f64], factor: f64, column: &[f64]) {
    out.iter_mut().zip(column).for_each(|(o, c)| *o += factor * c);
}
