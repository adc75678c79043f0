//! Constant torque: tau = c, whatever the motion.

use super::{
    About, DriveKind, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope,
    Worked,
};

pub struct CurrentOffset;

impl Effect for CurrentOffset {
    fn of_drive(&self) -> DriveKind {
        DriveKind::Current
    }

    fn about(&self) -> &'static About {
        &About {
            name: "current_offset",
            law: "tau = c",
            scope: Scope::Joint,
            parameters: &[Parameter {
                name: "current_offset",
                symbol: "c",
                unit: "N.m",
                min: -20.0,
                max: 20.0,
                typical: 1.0,
                null: 0.0,
                role: Role::Linear,
            }],
            memory: 0,
            dissipates: false,
            cause: "zero error of the current sensor, or a spring-like preload of seals and cables",
            remedy: "calibrate the sensor at rest without load, or subtract the constant from the recorded torque",
            source: "Swevers et al., IEEE Trans. Robotics and Automation 13(5), 1997, offset in the torque model",
        }
    }

    fn columns(&self, motion: &Motion<'_>, _: usize, _: &[f64]) -> Vec<Vec<f64>> {
        vec![vec![1.0; motion.samples()]]
    }

    fn act(&self, values: &[f64], _: &JointState, _: &mut [f64], load: &mut JointLoad) {
        load.torque += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        Some(Worked::torque(
            "-0.7, whatever the motion",
            -0.7,
            &[("current_offset", -0.7)],
            [1.0; 3],
        ))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["current_offset"]))
    }
}
