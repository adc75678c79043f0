//! Stribeck curve: tau = (Fs - Fc) sign(qd) exp(-|qd / qd_s|), on top of Coulomb friction.

use super::coulomb::sign;
use super::{About, Effect, JointLoad, JointState, Motion, Parameter, Role, Scope, starts};

pub struct Stribeck;

impl Effect for Stribeck {
    fn about(&self) -> &'static About {
        &About {
            name: "stribeck",
            law: "tau = (Fs - Fc) sign(qd) exp(-|qd / qd_s|)",
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
            ],
            memory: 0,
            dissipates: true,
            cause: "lubricant film that builds up with speed: static friction exceeds Coulomb",
            remedy: "make the dry level depend on speed; no common simulator format holds it",
            source: "Armstrong-Helouvry et al., Automatica 30(7), 1994; the paper's Eq. 1",
        }
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::spread_over(self.about().parameters, 0.01, 0.3)
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let qd_s = nonlinear[0];
        let column = |&qd: &f64| sign(qd) * (-(qd / qd_s).abs()).exp();
        vec![motion.qd.joint(joint).iter().map(column).collect()]
    }

    fn act(&self, values: &[f64], state: &JointState, _: &mut [f64], load: &mut JointLoad) {
        load.dry += values[0] * (-(state.qd / values[1]).abs()).exp();
    }
}
