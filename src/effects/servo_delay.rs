//! A command that reaches the servo late: tau = K (c(t) - c(t - d)).
//!
//! The column is worked out at d0 and holds where the fitted delay comes near it.

use super::{
    About, DriveKind, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked, starts,
};

pub struct ServoDelay;

static ABOUT: About = About {
    name: "servo_delay",
    law: "tau = K (c(t) - c(t - d)), c the command",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "servo_delay",
            symbol: "d",
            unit: "s",
            min: 0.0,
            max: 0.2,
            typical: 0.02,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "delay_reference",
            symbol: "d0",
            unit: "s",
            min: 1e-9,
            max: 0.2,
            typical: 0.02,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "the bus that commands travel on, a servo that smooths its target, or clocks that differ",
    remedy: "hold commands back by d in the simulated servo, or send them earlier",
    source: "Duclusaud, Passault, Padois, Ly, Extended friction models for the physics simulation of servo actuators, ICRA 2025",
};

impl Effect for ServoDelay {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn of_drive(&self) -> DriveKind {
        DriveKind::Servo
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let Some(told) = motion.told else { return vec![vec![0.0; motion.samples()]] };
        let d = nonlinear[0];
        let [sent, late] = [0.0, d].map(|delay| told.arrived(joint, delay));
        let moved = sent.iter().zip(&late).map(|(c, late)| (c - late) / d);
        vec![told.slope.joint(joint).iter().zip(moved).map(|(slope, c)| slope * c).collect()]
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::between(2e-3, 0.1, 5).into_iter().map(|d| vec![d]).collect()
    }

    fn settle(&self, linear: &[f64], nonlinear: &mut [f64]) {
        nonlinear[0] = ABOUT.parameters[1].clamp(linear[0]);
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.servo[joint].delay += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "10 ms of a command that rises by 0.5 rad/s: 20 N.m/rad x 0.005 rad";
        Some(Worked::along(text, 0.1, &[("servo_delay", 0.01)], vec![[0.0; 3]; 2]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Followed { within: 0.1 })
    }
}
