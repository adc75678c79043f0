//! An elastic joint: the link winds up against the motor by c tau_load, c = 1/K.
//!
//! Positions are the motor's. To first order in the compliance c, for motion well below the joint's
//! resonance, the links follow q - c tau_load with all derivatives; felt by all joints. Hardening,
//! damping and hysteresis are injected; the columns leave them out.

use super::{About, Effect, Mechanism, Motion, Parameter, Role, Scope, Transmission};
use crate::robot::inverse_dynamics_series;
use crate::series::JointSeries;

pub struct JointFlexibility;

static ABOUT: About = About {
    name: "joint_flexibility",
    law: "tau = ID(q - c tau_load) - ID(q),  c = 1/K",
    scope: Scope::Link,
    parameters: &[
        Parameter {
            name: "joint_compliance",
            symbol: "c = 1/K",
            unit: "rad/(N.m)",
            min: 0.0,
            max: 0.005,
            typical: 1e-4,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "joint_hardening",
            symbol: "K3",
            unit: "N.m/rad3",
            min: 0.0,
            max: 1e9,
            typical: 0.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "joint_damping",
            symbol: "D",
            unit: "N.m.s/rad",
            min: 0.0,
            max: 500.0,
            typical: 20.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "joint_hysteresis",
            symbol: "h",
            unit: "N.m",
            min: 0.0,
            max: 50.0,
            typical: 0.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "hysteresis_width",
            symbol: "w",
            unit: "rad",
            min: 1e-5,
            max: 0.05,
            typical: 0.001,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "harmonic drives, belts and torque sensors twist under load",
    remedy: "put a spring between motor and link: two coaxial joints with stiffness and armature",
    source: "Spong, Modeling and control of elastic joint robots, J. Dyn. Sys. Meas. Control 109(4), 1987, eqs. 2 and 3",
};

impl Effect for JointFlexibility {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let all = self.reach(motion, joint, nonlinear);
        all.iter().map(|series| series.joint(joint).to_vec()).collect()
    }

    fn reach(&self, motion: &Motion<'_>, from: usize, _: &[f64]) -> Vec<JointSeries> {
        let load = motion.rigid_torque();
        vec![per_wind_up(motion, from, load.joint(from))]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        if values[0] > 0.0 {
            let transmission = mechanism.transmission[joint].get_or_insert_default();
            *transmission = Transmission {
                stiffness: 1.0 / values[0],
                hardening: values[1],
                damping: values[2],
                hysteresis: values[3],
                hysteresis_width: values[4],
                ..*transmission
            };
        }
    }
}

/// N.m at every joint per unit of a small wind-up of joint `from` that goes as `shape` over time:
/// the links move by -`shape` against the motors.
pub(super) fn per_wind_up(motion: &Motion<'_>, from: usize, shape: &[f64]) -> JointSeries {
    let (rate, acceleration) =
        (first_derivative(shape, motion.dt), second_derivative(shape, motion.dt));
    let moved = |by: f64| {
        let shift = |series: &JointSeries, shape: &[f64]| {
            let mut series = series.clone();
            series.joint_mut(from).iter_mut().zip(shape).for_each(|(x, s)| *x -= by * s);
            series
        };
        inverse_dynamics_series(
            motion.robot,
            &shift(motion.q, shape),
            &shift(motion.qd, &rate),
            &shift(motion.qdd, &acceleration),
        )
    };
    let size = shape.iter().fold(0.0, |m: f64, s| m.max(s.abs())).max(f64::MIN_POSITIVE);
    let step = WIND_UP_RAD / size;
    let (more, less) = (moved(step), moved(-step));
    more.map_joints(|j, more| {
        more.iter().zip(less.joint(j)).map(|(m, l)| (m - l) / (2.0 * step)).collect()
    })
}

/// Largest wind-up of the central difference.
const WIND_UP_RAD: f64 = 1e-5;

fn first_derivative(x: &[f64], dt: f64) -> Vec<f64> {
    let at = |k: usize| x[k.min(x.len() - 1)];
    (0..x.len()).map(|k| (at(k + 1) - at(k.max(1) - 1)) / (2.0 * dt)).collect()
}

fn second_derivative(x: &[f64], dt: f64) -> Vec<f64> {
    let at = |k: usize| x[k.min(x.len() - 1)];
    (0..x.len()).map(|k| (at(k + 1) - 2.0 * at(k) + at(k.max(1) - 1)) / (dt * dt)).collect()
}
