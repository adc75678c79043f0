//! Rotor inertia as seen at the joint: tau = Ja qdd, Ja = N^2 J_motor.

use super::{About, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked};
use crate::robot::DrivePart;

pub struct RotorInertia;

impl Effect for RotorInertia {
    fn about(&self) -> &'static About {
        &About {
            name: "rotor_inertia",
            law: "tau = Ja qdd",
            scope: Scope::Joint,
            parameters: &[Parameter {
                name: "rotor_inertia",
                symbol: "Ja",
                unit: "kg.m2",
                min: 0.0,
                max: 20.0,
                typical: 1.0,
                null: 0.0,
                role: Role::Linear,
            }],
            memory: 0,
            dissipates: false,
            cause: "motor and wave generator turn gear-ratio times faster than the joint",
            remedy: "add it as armature (MuJoCo armature, rapier armature) or to [drive] rotor_inertia of the twin",
            source: "Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 7.1.1; gyroscopic terms left out",
        }
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        vec![motion.qdd.joint(joint).to_vec()]
    }

    fn stands_for(&self) -> Option<DrivePart> {
        Some(DrivePart::RotorInertia)
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.armature[joint] += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        Some(Worked::torque("1.1 x (-2)", -2.2, &[("rotor_inertia", 1.1)], [0.3, 1.0, -2.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["rotor_inertia"]))
    }
}
