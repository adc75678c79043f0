//! A base that is not level: gravity seen from the base turns by rx about x and ry about y.
//!
//! The columns are worked out at a reference tilt and exact there (fit again with that of the fit).

use nalgebra::{Rotation3, Vector3};

use super::{About, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked};
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
            min: -0.5,
            max: 0.5,
            typical: 0.03,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "tilt_y",
            symbol: "ry",
            unit: "rad",
            min: -0.5,
            max: 0.5,
            typical: 0.02,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter::reference("tilt_x_reference", "rx0", "rad", 0.5),
        Parameter::reference("tilt_y_reference", "ry0", "rad", 0.5),
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

    fn reach(&self, motion: &Motion<'_>, _: usize, nonlinear: &[f64]) -> Vec<JointSeries> {
        let [x, y] = *nonlinear else { return vec![] };
        let still = JointSeries::zeros(motion.q.joints(), motion.samples());
        let per_angle = |axis: Vector3<f64>| {
            let gravity = turned(motion.robot.gravity, Vector3::new(x, y, 0.0), axis);
            let pulled = Robot { gravity, ..motion.robot.clone() };
            inverse_dynamics_series(&pulled, motion.q, &still, &still)
        };
        vec![per_angle(Vector3::x()), per_angle(Vector3::y())]
    }

    fn build(&self, values: &[f64], _: usize, mechanism: &mut Mechanism) {
        let tilt = Rotation3::new(Vector3::new(values[0], values[1], 0.0));
        mechanism.robot.gravity = tilt.inverse() * mechanism.robot.gravity;
    }

    fn worked(&self) -> Option<Worked> {
        let text = "3 kg x 9.81 m/s2 x 0.4 m sin(0.1), upright before it tilts";
        let at = [std::f64::consts::FRAC_PI_2, 0.0, 0.0];
        Some(Worked::torque(text, 11.772 * f64::sin(0.1), &[("tilt_y", 0.1)], at))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["tilt_x"]))
    }
}

/// By how much gravity turns in the base per rad about `axis`, near the tilt r0: Rodrigues' formula
/// R^T g - g = sin(a)/a g x r + (1 - cos a)/a^2 r x (r x g) with one r at r0.
fn turned(g: Vector3<f64>, r0: Vector3<f64>, axis: Vector3<f64>) -> Vector3<f64> {
    let angle = r0.norm().max(1e-9);
    let half = (0.5 * angle).sin() / (0.5 * angle);
    g.cross(&axis) * (angle.sin() / angle) + r0.cross(&axis.cross(&g)) * (0.5 * half * half)
}
