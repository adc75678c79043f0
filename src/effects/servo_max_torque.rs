//! A position servo whose torque ends earlier or later than assumed: tau = clip(K e, L) - clip(K e, (1 + m) L).
//!
//! The column is worked out at m0 and holds where the fitted m comes near it. Of a servo that is assumed to have no
//! limit, and along a motion that asks for less than either limit, nothing is told.

use super::{
    About, DriveKind, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct ServoMaxTorque;

/// Twice the supply, and twice the motor.
const MOST: f64 = 3.0;
/// What a column is worked out at is a step from what is assumed at least.
const STEP: f64 = 1e-3;

static ABOUT: About = About {
    name: "servo_max_torque",
    law: "tau = clip(K e, -L, L) - clip(K e, -(1+m) L, (1+m) L)",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "max_torque_error",
            symbol: "m",
            unit: "-",
            min: -1.0,
            max: MOST,
            typical: 0.3,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "max_torque_reference",
            symbol: "m0",
            unit: "-",
            min: -1.0,
            max: MOST,
            typical: 0.3,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "a torque or current limit in the servo's registers, another supply voltage, a motor of another winding",
    remedy: "read the limit register and the supply, and give the actuator that limit (MuJoCo: forcerange)",
    source: "Duclusaud, Passault, Padois, Ly, Extended friction models for the physics simulation of servo actuators, ICRA 2025, servo model: the duty ends at the supply",
};

impl Effect for ServoMaxTorque {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn of_drive(&self) -> DriveKind {
        DriveKind::Servo
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let none = || vec![vec![0.0; motion.samples()]];
        let Some(told) = motion.told else { return none() };
        let (limit, m) = (told.limit[joint], away(nonlinear[0]));
        if !limit.is_finite() {
            return none();
        }
        // A search may look beyond what can be: no limit is below none.
        let other = ((1.0 + m) * limit).max(0.0);
        let of = |k: usize| {
            let asked = told.asked.joint(joint)[k];
            (asked.clamp(-limit, limit) - asked.clamp(-other, other)) / m
        };
        vec![(0..motion.samples()).map(of).collect()]
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        [-0.8, -0.6, -0.4, -0.2, 0.3, 1.0].map(|m| vec![m]).to_vec()
    }

    fn settle(&self, linear: &[f64], nonlinear: &mut [f64]) {
        nonlinear[0] = away(ABOUT.parameters[1].clamp(linear[0]));
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.servo[joint].max_torque *= 1.0 + values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "1.5 of 5 N.m where 20 N.m/rad x 0.1 rad are asked for: 2 - 1.5 N.m";
        Some(Worked::along(text, 0.5, &[("max_torque_error", -0.7)], vec![[0.0; 3]]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Followed { within: 0.1 })
    }
}

/// `m`, at least a step from none.
fn away(m: f64) -> f64 {
    if m.abs() < STEP { STEP.copysign(m) } else { m }
}
