//! Stribeck curve: tau = (Fs - Fc) sign(qd) exp(-|qd / qd_s|^a), on top of Coulomb friction.
//!
//! Exponents in use: 1 (Tustin, the paper) and 2 (a Gaussian, Armstrong).

use super::coulomb::sign;
use super::{
    About, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked, starts,
};

pub struct Stribeck;

impl Effect for Stribeck {
    fn about(&self) -> &'static About {
        &About {
            name: "stribeck",
            law: "tau = (Fs - Fc) sign(qd) exp(-|qd / qd_s|^a)",
            scope: Scope::Joint,
            parameters: &[
                Parameter {
                    name: "stribeck_excess",
                    symbol: "Fs - Fc",
                    unit: "N.m",
                    min: 0.0,
                    max: 60.0,
                    typical: 2.0,
                    null: 0.0,
                    role: Role::Linear,
                },
                Parameter {
                    name: "stribeck_velocity",
                    symbol: "qd_s",
                    unit: "rad/s",
                    min: 0.005,
                    max: 0.5,
                    typical: 0.05,
                    null: f64::NAN,
                    role: Role::Nonlinear,
                },
                Parameter {
                    name: "stribeck_exponent",
                    symbol: "a",
                    unit: "-",
                    min: 1.0,
                    max: 2.0,
                    typical: 1.0,
                    null: f64::NAN,
                    role: Role::Nonlinear,
                },
            ],
            memory: 0,
            dissipates: true,
            cause: "lubricant film that builds up with speed: static friction exceeds Coulomb",
            remedy: "make the dry level depend on speed; no common simulator format holds it",
            source: "Armstrong-Helouvry et al., Automatica 30(7), 1994, section 2.1.4; a = 1: the paper's Eq. 1",
        }
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        let velocity = starts::between(0.01, 0.3, 7);
        let axes = [("stribeck_velocity", velocity), ("stribeck_exponent", vec![1.0, 2.0])];
        starts::grid(self.about().parameters, &axes)
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let column = |&qd: &f64| sign(qd) * share(qd, nonlinear[0], nonlinear[1]);
        vec![motion.qd.joint(joint).iter().map(column).collect()]
    }

    fn act(&self, values: &[f64], state: &JointState, _: &mut [f64], load: &mut JointLoad) {
        load.dry += values[0] * share(state.qd, values[1], values[2]);
    }

    fn worked(&self) -> Option<Worked> {
        let result = 2.0 * f64::exp(-4.0);
        let values =
            [("stribeck_excess", 2.0), ("stribeck_velocity", 0.05), ("stribeck_exponent", 2.0)];
        Some(Worked::torque("2 exp(-(0.1 / 0.05)^2)", result, &values, [0.0, 0.1, 0.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["stribeck_excess"]))
    }
}

/// exp(-|qd / qd_s|^a)
fn share(qd: f64, qd_s: f64, exponent: f64) -> f64 {
    (-(qd / qd_s).abs().powf(exponent)).exp()
}
