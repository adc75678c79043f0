//! Viscous friction: tau = Fv qd.

use super::{
    About, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct Viscous;

impl Effect for Viscous {
    fn about(&self) -> &'static About {
        &About {
            name: "viscous",
            law: "tau = Fv qd",
            scope: Scope::Joint,
            parameters: &[Parameter {
                name: "viscous",
                symbol: "Fv",
                unit: "N.m.s/rad",
                min: 0.0,
                max: 60.0,
                typical: 6.0,
                null: 0.0,
                role: Role::Linear,
            }],
            memory: 0,
            dissipates: true,
            cause: "oil and grease sheared in gears, bearings and seals; back-EMF the driver does not compensate",
            remedy: "add it as joint damping (URDF damping, MuJoCo damping)",
            source: "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30(7), 1994, section 2; the paper's Eq. 1",
        }
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        vec![motion.qd.joint(joint).to_vec()]
    }

    fn act(&self, values: &[f64], _: &JointState, _: &mut [f64], load: &mut JointLoad) {
        load.damping += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        Some(Worked::torque("6 x (-0.5)", -3.0, &[("viscous", 6.0)], [0.0, -0.5, 0.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["viscous"]))
    }
}
