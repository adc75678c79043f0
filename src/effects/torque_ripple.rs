//! Torque ripple over the joint angle: tau = a sin(N q) + b cos(N q).
//!
//! A filter below N qd / (2 pi) Hz removes it.

use super::{About, Effect, JointLoad, JointState, Motion, Parameter, Role, Scope};

pub struct TorqueRipple;

static ABOUT: About = About {
    name: "torque_ripple",
    law: "tau = a sin(N q) + b cos(N q)",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "ripple_sine",
            symbol: "a",
            unit: "N.m",
            min: -5.0,
            max: 5.0,
            typical: 0.4,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "ripple_cosine",
            symbol: "b",
            unit: "N.m",
            min: -5.0,
            max: 5.0,
            typical: 0.2,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "ripple_order",
            symbol: "N",
            unit: "1/turn",
            min: 1.0,
            max: 2000.0,
            typical: 202.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "wave generator out of round (2 per motor turn), cogging, bearing of the gear",
    remedy: "add it over the joint angle; no common simulator format holds it",
    source: "Gandhi, Ghorbel, Dabney, Modeling, identification, and compensation of friction in harmonic drives, CDC 2002",
};

impl Effect for TorqueRipple {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let q = motion.q.joint(joint);
        let wave = |f: fn(f64) -> f64| q.iter().map(|q| f(nonlinear[0] * q)).collect();
        vec![wave(f64::sin), wave(f64::cos)]
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        let (sin, cos) = (values[2] * state.q).sin_cos();
        load.torque += values[0] * sin + values[1] * cos;
    }
}
