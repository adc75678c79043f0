//! A position servo that pulls harder or softer than assumed: tau = (1 + g) K e.
//!
//! What the assumed servo seems to give falls short of what the arm takes by -g K e.

use super::{
    About, DriveKind, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct ServoGain;

/// Registers come in powers of two, supplies within tens of percent.
const EXPECTED: f64 = 0.5;
/// Two steps of a register.
const MOST: f64 = 3.0;

static ABOUT: About = About {
    name: "servo_gain",
    law: "tau = -g K e, e the servo's position error",
    scope: Scope::Joint,
    parameters: &[Parameter {
        name: "servo_gain_error",
        symbol: "g",
        unit: "-",
        min: -1.0,
        max: MOST,
        typical: 0.2,
        null: 0.0,
        role: Role::Linear,
    }],
    memory: 0,
    dissipates: false,
    cause: "another gain register or supply voltage than assumed, a weaker magnet or a warmer winding",
    remedy: "read the gain register and the supply, and give the actuator that gain (MuJoCo: position kp)",
    source: "Duclusaud, Passault, Padois, Ly, Extended friction models for the physics simulation of servo actuators, ICRA 2025",
};

impl Effect for ServoGain {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn of_drive(&self) -> DriveKind {
        DriveKind::Servo
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let Some(told) = motion.told else { return vec![vec![0.0; motion.samples()]] };
        let both = told.pull.joint(joint).iter().zip(told.slope.joint(joint));
        vec![both.map(|(pull, slope)| if *slope > 0.0 { -pull } else { 0.0 }).collect()]
    }

    fn expected(&self, _: &crate::robot::Robot, _: usize, _: &[f64]) -> Vec<f64> {
        vec![EXPECTED]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.servo[joint].gain *= 1.0 + values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "20 % less of 20 N.m/rad x 0.1 rad";
        Some(Worked::along(text, 0.4, &[("servo_gain_error", -0.2)], vec![[0.3, 0.0, 0.0]]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Followed { within: 0.1 })
    }
}
