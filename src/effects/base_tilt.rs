//! A base that is not level: gravity seen from the base turns by rx about x and ry about y.
//!
//! The columns are linear in small angles (0.4 % off at 5 deg).

use nalgebra::{Rotation3, Vector3};

use super::{About, Effect, Mechanism, Motion, Parameter, Role, Scope};
use crate::robot::{Robot, inverse_dynamics_series};
use crate::series::JointSeries;

pub struct BaseTilt;

static ABOUT: About = About {
    name: "base_tilt",
    law: "tau = d g(q)/d gravity (gravity x [rx, ry, 0])",
    scope: Scope::Arm,
    parameters: &[
        Parameter {
            name: "tilt_x",
            symbol: "rx",
            unit: "rad",
            min: -0.3,
            max: 0.3,
            typical: 0.03,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "tilt_y",
            symbol: "ry",
            unit: "rad",
            min: -0.3,
            max: 0.3,
            typical: 0.02,
            null: 0.0,
            role: Role::Linear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "a stand or table that is not level, or a mounting angle the twin has wrong",
    remedy: "level the base, or turn the gravity vector of the simulator",
    source: "Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 7.3.2: gravity enters as base acceleration",
};

impl Effect for BaseTilt {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let still = JointSeries::zeros(motion.q.joints(), motion.samples());
        let per_angle = |axis: Vector3<f64>| {
            let gravity = motion.robot.gravity.cross(&axis);
            let pulled = Robot { gravity, ..motion.robot.clone() };
            let torque = inverse_dynamics_series(&pulled, motion.q, &still, &still);
            torque.joint(joint).to_vec()
        };
        vec![per_angle(Vector3::x()), per_angle(Vector3::y())]
    }

    fn build(&self, values: &[f64], _: usize, mechanism: &mut Mechanism) {
        let tilt = Rotation3::new(Vector3::new(values[0], values[1], 0.0));
        mechanism.robot.gravity = tilt.inverse() * mechanism.robot.gravity;
    }
}
