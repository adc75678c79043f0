//! A position servo that does nothing about errors within a band: tau = K (e - dead_zone(e, w)).
//!
//! The column is worked out at w0 and holds where the fitted width comes near it.

use super::{
    About, DriveKind, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked, starts,
};

pub struct ServoDeadBand;

static ABOUT: About = About {
    name: "servo_dead_band",
    law: "tau = K clip(e, -w, w), e the servo's position error",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "servo_dead_band",
            symbol: "w",
            unit: "rad",
            min: 0.0,
            max: 0.2,
            typical: 0.01,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "dead_band_reference",
            symbol: "w0",
            unit: "rad",
            min: 1e-12,
            max: 0.2,
            typical: 0.01,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "a dead-zone register, or a duty too small to turn the motor at all",
    remedy: "set the register to zero, or take w off the position error in the simulated servo",
    source: "Duclusaud, Passault, Padois, Ly, Extended friction models for the physics simulation of servo actuators, ICRA 2025",
};

impl Effect for ServoDeadBand {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn of_drive(&self) -> DriveKind {
        DriveKind::Servo
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let Some(told) = motion.told else { return vec![vec![0.0; motion.samples()]] };
        let w = nonlinear[0];
        let both = told.slope.joint(joint).iter().zip(told.error.joint(joint));
        vec![both.map(|(slope, e)| slope * e.clamp(-w, w) / w).collect()]
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::between(2e-3, 0.05, 5).into_iter().map(|w| vec![w]).collect()
    }

    fn settle(&self, linear: &[f64], nonlinear: &mut [f64]) {
        nonlinear[0] = ABOUT.parameters[1].clamp(linear[0]);
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.servo[joint].dead_band += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "0.03 of 0.1 rad do nothing: 20 N.m/rad x 0.03 rad";
        Some(Worked::along(text, 0.6, &[("servo_dead_band", 0.03)], vec![[0.0; 3]]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Followed { within: 0.1 })
    }
}
