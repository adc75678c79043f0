//! Friction that changes with the joint's temperature: tau = (ac sign(qd) + av qd) (T - 25 degC).
//!
//! On top of Coulomb and viscous friction, which hold at 25 degC. Without recorded temperatures it
//! cannot be explained and its columns are zero.

use super::coulomb::sign;
use super::{
    About, Effect, JointLoad, JointState, Motion, Needed, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct TemperatureFriction;

static ABOUT: About = About {
    name: "temperature_friction",
    law: "tau = (ac sign(qd) + av qd) (T - 25 degC)",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "coulomb_per_kelvin",
            symbol: "ac",
            unit: "N.m/K",
            min: -5.0,
            max: 5.0,
            typical: -0.05,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "viscous_per_kelvin",
            symbol: "av",
            unit: "N.m.s/rad/K",
            min: -20.0,
            max: 20.0,
            typical: -0.1,
            null: 0.0,
            role: Role::Linear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "grease that thins as the joint warms up",
    remedy: "warm the arm up before use, or make friction depend on the joint's temperature",
    source: "Bittencourt, Wernholt, Sander-Tavallaey, Brogardh, An extended friction model to capture load and temperature effects in robot joints, IROS 2010",
};

impl Effect for TemperatureFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn needs(&self) -> Option<Needed> {
        Some(Needed::Temperature)
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let Some(temperature) = motion.temperature else {
            return vec![vec![0.0; motion.samples()]; 2];
        };
        let both = || temperature.joint(joint).iter().zip(motion.qd.joint(joint));
        let dry = both().map(|(t, &qd)| (t - REFERENCE_C) * sign(qd)).collect();
        vec![dry, both().map(|(t, qd)| (t - REFERENCE_C) * qd).collect()]
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        let warmer = state.temperature - REFERENCE_C;
        load.dry += values[0] * warmer;
        load.damping += values[1] * warmer;
    }

    fn worked(&self) -> Option<Worked> {
        let values = [("coulomb_per_kelvin", -0.05), ("viscous_per_kelvin", -0.1)];
        Some(Worked::torque("(-0.05 - 0.1 x 0.5) x (45 - 25)", -2.0, &values, [0.0, 0.5, 0.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["coulomb_per_kelvin"]))
    }
}

/// Temperature at which the other friction parameters hold, deg C.
const REFERENCE_C: f64 = 25.0;
