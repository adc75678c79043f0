//! A position servo whose zero is not that of its command: tau = -K o.

use super::{
    About, DriveKind, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct ServoOffset;

static ABOUT: About = About {
    name: "servo_offset",
    law: "tau = -K o",
    scope: Scope::Joint,
    parameters: &[Parameter {
        name: "servo_offset",
        symbol: "o",
        unit: "rad",
        min: -0.5,
        max: 0.5,
        typical: 0.02,
        null: 0.0,
        role: Role::Linear,
    }],
    memory: 0,
    dissipates: false,
    cause: "command and position were calibrated apart, or the horn sits a tooth beside its mark",
    remedy: "calibrate again, or add o to the command in the simulation",
    source: "Duclusaud, Passault, Padois, Ly, Extended friction models for the physics simulation of servo actuators, ICRA 2025",
};

impl Effect for ServoOffset {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn of_drive(&self) -> DriveKind {
        DriveKind::Servo
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let Some(told) = motion.told else { return vec![vec![0.0; motion.samples()]] };
        vec![told.slope.joint(joint).iter().map(|slope| -slope).collect()]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.servo[joint].offset += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "-20 N.m/rad x -0.02 rad";
        Some(Worked::along(text, 0.4, &[("servo_offset", -0.02)], vec![[0.0; 3]]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Followed { within: 0.1 })
    }
}
