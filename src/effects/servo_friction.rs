//! Friction of a servo's gear that grows with the torque of its motor: tau = mu sign(qd) |tau_motor|.
//!
//! What a gear loses it loses of what the motor gives it. Against a load, at full duty, that is more than
//! `load_friction` takes of the load itself: a servo with mu stalls under (1 - mu) of its motor's torque.

use super::coulomb::sign;
use super::{
    About, DriveKind, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct ServoFriction;

static ABOUT: About = About {
    name: "servo_friction",
    law: "tau = mu sign(qd) |tau_motor|, tau_motor the servo's pull",
    scope: Scope::Joint,
    parameters: &[Parameter {
        name: "servo_friction",
        symbol: "mu",
        unit: "-",
        min: 0.0,
        max: 0.9,
        typical: 0.2,
        null: 0.0,
        role: Role::Linear,
    }],
    memory: 0,
    dissipates: true,
    cause: "spur gears of small servos: their teeth press with the motor's torque, and slide",
    remedy: "add mu |motor torque| to the dry friction in every step; no simulator format holds it",
    source: "Duclusaud, Passault, Padois, Ly, Extended friction models for the physics simulation of servo actuators, ICRA 2025, load-dependent friction (motor side)",
};

impl Effect for ServoFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn of_drive(&self) -> DriveKind {
        DriveKind::Servo
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let Some(told) = motion.told else { return vec![vec![0.0; motion.samples()]] };
        let both = told.pull.joint(joint).iter().zip(motion.qd.joint(joint));
        vec![both.map(|(pull, &qd)| sign(qd) * pull.abs()).collect()]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.servo[joint].friction += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "back at 0.3 rad/s: 0.25 x 20 N.m/rad x 0.1 rad";
        Some(Worked::torque(text, -0.5, &[("servo_friction", 0.25)], [0.0, -0.3, 0.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Followed { within: 0.1 })
    }
}
