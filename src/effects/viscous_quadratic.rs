//! Quadratic viscous friction: tau = F2 qd |qd|.

use super::{
    About, Curve, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct ViscousQuadratic;

impl Effect for ViscousQuadratic {
    fn about(&self) -> &'static About {
        &About {
            name: "viscous_quadratic",
            law: "tau = F2 qd |qd|",
            scope: Scope::Joint,
            parameters: &[Parameter {
                name: "viscous_quadratic",
                symbol: "F2",
                unit: "N.m.s2/rad2",
                min: -20.0,
                max: 20.0,
                typical: 1.0,
                null: 0.0,
                role: Role::Linear,
            }],
            memory: 0,
            dissipates: false,
            cause: "oil churning (F2 > 0), or viscous friction that grows less than linearly with speed (F2 < 0)",
            remedy: "make the damping depend on speed, Fv + F2 |qd|; no common simulator format holds it",
            source: "the paper's Eq. 1, third term of the viscous friction; sign as fitted",
        }
    }

    fn law_of(&self) -> Option<Curve> {
        Some(Curve::Viscous)
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        vec![motion.qd.joint(joint).iter().map(|&qd| qd * qd.abs()).collect()]
    }

    fn act(&self, values: &[f64], state: &JointState, _: &mut [f64], load: &mut JointLoad) {
        load.damping += values[0] * state.qd.abs();
    }

    fn worked(&self) -> Option<Worked> {
        Some(Worked::torque(
            "2 x (-0.5) |-0.5|",
            -0.5,
            &[("viscous_quadratic", 2.0)],
            [0.0, -0.5, 0.0],
        ))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["viscous_quadratic"]))
    }
}
