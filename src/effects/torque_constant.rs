//! Torque constant that is not the nominal one: tau = g tau_drive, g = K_nominal / K_true - 1.
//!
//! `tau_drive` is what is known of the drive's torque. What is fitted besides (friction) counts as
//! known once it has a value, as in a diagnosis; before it has, as in a single fit, it comes out
//! larger by the factor 1 + g. Needs a known load.

use super::{
    About, DriveKind, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};
use crate::robot::Robot;

pub struct TorqueConstant;

static ABOUT: About = About {
    name: "torque_constant",
    law: "tau = g tau_drive",
    scope: Scope::Joint,
    parameters: &[Parameter {
        name: "torque_gain_error",
        symbol: "g",
        unit: "-",
        min: -0.5,
        max: 0.5,
        typical: 0.05,
        null: 0.0,
        role: Role::Linear,
    }],
    memory: 0,
    dissipates: false,
    cause: "motor constant, gear ratio or current sensor other than in the data sheet; magnets weaken when warm",
    remedy: "calibrate the torque constant with a known load and put it into [drive]",
    source: "Gautier, Briot, Global identification of joint drive gains and dynamic parameters of robots, J. Dyn. Sys. Meas. Control 136(5), 2014",
};

impl Effect for TorqueConstant {
    fn of_drive(&self) -> DriveKind {
        DriveKind::Current
    }

    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn follows_drive(&self) -> bool {
        true
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        vec![motion.drive_torque().joint(joint).to_vec()]
    }

    fn expected(&self, _: &Robot, _: usize, _: &[f64]) -> Vec<f64> {
        vec![DATA_SHEET_ERROR]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.torque_gain[joint] *= 1.0 + values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "10 % of 3 kg x 9.81 m/s2 x 0.4 m";
        Some(Worked::torque(text, 1.1772, &[("torque_gain_error", 0.1)], [0.0; 3]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["torque_gain_error"]))
    }
}

/// What data sheets are commonly wrong by.
const DATA_SHEET_ERROR: f64 = 0.1;
