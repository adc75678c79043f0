//! A position servo that brakes more (or less) than assumed while it is powered: tau = B qd.
//!
//! The motor's own voltage does it. While the servo is powered it looks like viscous friction: what speaks for it
//! is friction that would have to push, or a servo that was switched off for a while.

use super::{
    About, DriveKind, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct ServoDamping;

static ABOUT: About = About {
    name: "servo_damping",
    law: "tau = B qd while powered",
    scope: Scope::Joint,
    parameters: &[Parameter {
        name: "servo_damping",
        symbol: "B",
        unit: "N.m.s/rad",
        min: -10.0,
        max: 10.0,
        typical: 0.3,
        null: 0.0,
        role: Role::Linear,
    }],
    memory: 0,
    dissipates: false,
    cause: "the motor's own voltage (k^2/R through the gear), or a derivative gain of the servo",
    remedy: "give the actuator that damping (MuJoCo: position kv), the joint its friction without it",
    source: "Duclusaud, Passault, Padois, Ly, Extended friction models for the physics simulation of servo actuators, ICRA 2025",
};

impl Effect for ServoDamping {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn of_drive(&self) -> DriveKind {
        DriveKind::Servo
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let Some(told) = motion.told else { return vec![vec![0.0; motion.samples()]] };
        let both = told.powered.joint(joint).iter().zip(motion.qd.joint(joint));
        vec![both.map(|(on, qd)| on * qd).collect()]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.servo[joint].damping += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "0.5 x -2 rad/s, switched on for the last second";
        Some(Worked::along(text, -1.0, &[("servo_damping", 0.5)], vec![[0.0, -2.0, 0.0]; 60]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Followed { within: 0.1 })
    }
}
