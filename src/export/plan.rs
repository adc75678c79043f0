//! A twin in the terms of a simulator: bodies, joint parameters, actuators; and what is left over.

use std::fmt;

use nalgebra::Vector3;
use serde::{Serialize, Serializer};

use crate::effects::{About, Effect, Mechanism, Parameter, Role, Scope};
use crate::robot::{Inertia, Placement, Robot, Servo};
use crate::twin::Twin;

pub struct Plan {
    /// With corrected links and the tilt of its base, without payload.
    pub robot: Robot,
    /// Gravity before the tilt, m/s^2: what the world has.
    pub level_gravity: Vector3<f64>,
    /// At the flange, in its frame.
    pub payload: Option<Inertia>,
    pub joints: Vec<JointPlan>,
    /// Position servos as they are, in place of motors that are told a current.
    pub servo: Option<Servo>,
    /// What no simulator's file has an element for.
    pub left: Vec<Left>,
}

/// One joint; torques in N.m at the joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPlan {
    /// N.m
    pub coulomb: f64,
    /// N.m.s/rad
    pub viscous: f64,
    /// kg.m2
    pub armature: f64,
    /// N.m/rad, about the angle in rad
    pub spring: f64,
    pub rest: f64,
    /// What the encoder shows where the joint is at zero, rad.
    pub encoder_zero: f64,
    /// N.m of the motor per A of recorded current.
    pub gain: f64,
    /// N.m that the current carries without the joint feeling it.
    pub offset: f64,
    /// Largest current, A, and torque, N.m; infinite without limit.
    pub current_limit: f64,
    pub torque_limit: f64,
}

/// Something of the twin that is not in a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Left {
    pub effect: String,
    /// From 0, in files from 1; empty for the whole arm.
    #[serde(serialize_with = "from_one")]
    pub joints: Vec<usize>,
    /// "mass = 2 kg, ..."; empty where there is nothing to say.
    pub values: String,
    pub why: String,
}

fn from_one<S: Serializer>(joints: &[usize], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(joints.iter().map(|j| j + 1))
}

impl fmt::Display for Left {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.effect)?;
        let joints: Vec<String> = self.joints.iter().map(|j| (j + 1).to_string()).collect();
        match joints.len() {
            0 => {}
            1 => write!(f, " at joint {}", joints[0])?,
            _ => write!(f, " at joints {}", joints.join(", "))?,
        }
        if !self.values.is_empty() {
            write!(f, " ({})", self.values)?;
        }
        write!(f, ": {}", self.why)
    }
}

/// Effects with a place of their own in [`Plan`]; of all others the law is left over.
const PLACED: &[&str] = &[
    "coulomb",
    "viscous",
    "rotor_inertia",
    "payload",
    "link_inertia",
    "base_tilt",
    "encoder_offset",
    "torque_constant",
    "current_offset",
    "torque_saturation",
    "cable_spring",
];

/// Effects with a place in [`Plan::servo`].
const OF_SERVOS: &[&str] = &[
    "servo_gain",
    "servo_max_torque",
    "servo_damping",
    "servo_friction",
    "servo_offset",
    "servo_delay",
    "servo_dead_band",
];

impl Plan {
    pub fn of(twin: &Twin) -> Self {
        // A payload is a body of its own.
        let mechanism = twin.mechanism(|e| e.about().name != "payload");
        let value = |name: &str, joint: usize| -> f64 {
            let known = twin.known().any(|e| e.about().parameters.iter().any(|p| p.name == name));
            let values = twin.values.get(name).filter(|_| known);
            values.and_then(|v| v.get(joint)).copied().unwrap_or(0.0)
        };
        let joint = |j: usize| {
            let gain = mechanism.torque_gain[j];
            JointPlan {
                coulomb: value("coulomb", j).max(0.0),
                viscous: value("viscous", j).max(0.0),
                armature: mechanism.armature[j],
                spring: value("cable_stiffness", j),
                rest: value("cable_rest_angle", j),
                encoder_zero: mechanism.encoder_zero[j],
                gain: twin.drive.torque_per_ampere(j) / gain,
                offset: value("current_offset", j) / gain,
                current_limit: twin.drive.current_limit.as_ref().map_or(f64::INFINITY, |l| l[j]),
                torque_limit: twin.drive.largest_torque(j).min(mechanism.torque_limit[j]),
            }
        };
        Self {
            joints: (0..twin.robot.dof()).map(joint).collect(),
            servo: twin.drive.servo.as_ref().map(|assumed| mechanism.servos(assumed)),
            robot: mechanism.robot,
            level_gravity: twin.robot.gravity,
            payload: load(twin),
            left: left(twin),
        }
    }
}

/// What a twin carries at its flange, in the flange's frame.
fn load(twin: &Twin) -> Option<Inertia> {
    let mut bare = Mechanism::new(Robot { flange: Placement::identity(), ..twin.robot.clone() });
    bare.robot.bodies.iter_mut().for_each(|b| b.inertia = Inertia::zero());
    let effect = twin.known().find(|e| e.about().name == "payload")?;
    effect.build(&twin.values_at(effect, 0)?, 0, &mut bare);
    let carrier = bare.robot.carrier()?;
    bare.robot.bodies.get(carrier).map(|b| b.inertia).filter(|i| i.mass > 0.0)
}

fn left(twin: &Twin) -> Vec<Left> {
    let mut all: Vec<Left> = twin.open().map(open).collect();
    for effect in twin.known() {
        let about = effect.about();
        let joints = acting(twin, effect);
        if joints.is_empty() {
            continue;
        }
        let of_arm = about.scope == Scope::Arm;
        let entry = |values, why: &str| Left {
            effect: about.name.into(),
            joints: if of_arm { Vec::new() } else { joints.clone() },
            values,
            why: why.into(),
        };
        let of_servo = twin.drive.servo.is_some() && OF_SERVOS.contains(&about.name);
        if !PLACED.contains(&about.name) && !of_servo {
            let why = format!("no element for {}", about.law);
            all.push(entry(values(twin, about, &joints, |_| true), &why));
        } else if about.name == "cable_spring" && bends(twin) {
            let hysteresis =
                |p: &Parameter| p.name == "cable_hysteresis" || p.name.contains("slip");
            let values = values(twin, about, &joints, hysteresis);
            all.push(entry(values, "its hysteresis has no element, the spring is kept"));
        }
    }
    all
}

fn bends(twin: &Twin) -> bool {
    twin.values.get("cable_hysteresis").is_some_and(|h| h.iter().any(|h| *h != 0.0))
}

fn open(effect: &dyn Effect) -> Left {
    Left {
        effect: effect.about().name.into(),
        joints: Vec::new(),
        values: String::new(),
        why: "the twin has no values for it; fit them (identify or diagnose)".into(),
    }
}

/// Joints (from 0) at which an effect does something; `[0]` for one on the whole arm.
fn acting(twin: &Twin, effect: &dyn Effect) -> Vec<usize> {
    let about = effect.about();
    let linear = about.parameters.iter().any(|p| p.role == Role::Linear);
    let decides = |p: &Parameter| p.role == Role::Linear || (!linear && !p.null.is_nan());
    let acts = |p: &Parameter, value: f64| match p.null.is_infinite() {
        true => value < p.max,
        false => decides(p) && value != p.null,
    };
    let count = if about.scope == Scope::Arm { 1 } else { twin.robot.dof() };
    let at = |j: &usize| {
        let values = twin.values_at(effect, *j).unwrap_or_default();
        about.parameters.iter().zip(values).any(|(p, value)| acts(p, value))
    };
    (0..count).filter(at).collect()
}

fn values(twin: &Twin, about: &About, joints: &[usize], of: impl Fn(&Parameter) -> bool) -> String {
    let shown = about.parameters.iter().filter(|p| !p.is_reference() && of(p));
    let each = shown.filter_map(|p| {
        let all = twin.values.get(p.name)?;
        let here: Vec<String> =
            joints.iter().filter_map(|j| all.get(*j)).map(|v| format!("{v:.4}")).collect();
        Some(format!("{} = {} {}", p.name, here.join(", "), p.unit))
    });
    each.collect::<Vec<_>>().join("; ")
}
