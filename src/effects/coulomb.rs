//! Coulomb friction: tau = Fc sign(qd).

use super::{
    About, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct Coulomb;

impl Effect for Coulomb {
    fn about(&self) -> &'static About {
        &About {
            name: "coulomb",
            law: "tau = Fc sign(qd)",
            scope: Scope::Joint,
            parameters: &[Parameter {
                name: "coulomb",
                symbol: "Fc",
                unit: "N.m",
                min: 0.0,
                max: 60.0,
                typical: 5.0,
                null: 0.0,
                role: Role::Linear,
            }],
            memory: 0,
            dissipates: true,
            cause: "dry friction in gears, bearings and seals",
            remedy: "add the level as dry friction (URDF friction, MuJoCo frictionloss)",
            source: "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30(7), 1994, section 2",
        }
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        vec![motion.qd.joint(joint).iter().map(|&qd| sign(qd)).collect()]
    }

    fn act(&self, values: &[f64], _: &JointState, _: &mut [f64], load: &mut JointLoad) {
        load.dry += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        Some(Worked::torque("5 sign(-0.3)", -5.0, &[("coulomb", 5.0)], [0.0, -0.3, 0.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["coulomb"]))
    }
}

/// -1, 0 or 1: zero at rest, where friction is whatever holds the joint (not `f64::signum`).
pub(super) fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}
