//! Cubic viscous friction: tau = F3 qd^3.

use super::{
    About, Curve, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct ViscousCubic;

impl Effect for ViscousCubic {
    fn about(&self) -> &'static About {
        &About {
            name: "viscous_cubic",
            law: "tau = F3 qd^3",
            scope: Scope::Joint,
            parameters: &[Parameter {
                name: "viscous_cubic",
                symbol: "F3",
                unit: "N.m.s3/rad3",
                min: -20.0,
                max: 20.0,
                typical: 0.5,
                null: 0.0,
                role: Role::Linear,
            }],
            memory: 0,
            dissipates: false,
            cause: "curvature of viscous friction over speed: lubricant that thins (F3 < 0) or churns (F3 > 0)",
            remedy: "make the damping depend on speed, Fv + F3 qd^2; no common simulator format holds it",
            source: "the paper's Eq. 1, last term of the viscous friction; sign as fitted",
        }
    }

    fn law_of(&self) -> Option<Curve> {
        Some(Curve::Viscous)
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        vec![motion.qd.joint(joint).iter().map(|&qd| qd * qd * qd).collect()]
    }

    fn act(&self, values: &[f64], state: &JointState, _: &mut [f64], load: &mut JointLoad) {
        load.damping += values[0] * state.qd * state.qd;
    }

    fn worked(&self) -> Option<Worked> {
        Some(Worked::torque("4 x (-0.5)^3", -0.5, &[("viscous_cubic", 4.0)], [0.0, -0.5, 0.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["viscous_cubic"]))
    }
}
