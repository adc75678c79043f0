//! A force on the flange for a while or below a height: tau = -J^T F while it touches.
//!
//! F acts on the arm at the flange's origin, in base axes.

use nalgebra::Vector3;

use super::{About, ArmState, Effect, JointLoad, JointState, Motion, Parameter, Role, Scope};
use crate::robot::{Robot, flange_placement, point_jacobian};

pub struct ExternalContact;

static ABOUT: About = About {
    name: "external_contact",
    law: "tau = -J^T F,  start <= t < start + D,  z <= height",
    scope: Scope::Arm,
    parameters: &[
        Parameter {
            name: "contact_x",
            symbol: "Fx",
            unit: "N",
            min: -500.0,
            max: 500.0,
            typical: 10.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "contact_y",
            symbol: "Fy",
            unit: "N",
            min: -500.0,
            max: 500.0,
            typical: 5.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "contact_z",
            symbol: "Fz",
            unit: "N",
            min: -500.0,
            max: 500.0,
            typical: 20.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "contact_start",
            symbol: "start",
            unit: "s",
            min: 0.0,
            max: 1e5,
            typical: 0.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "contact_duration",
            symbol: "D",
            unit: "s",
            min: 0.0,
            max: 1e5,
            typical: 10.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "contact_height",
            symbol: "height",
            unit: "m",
            min: -10.0,
            max: 10.0,
            typical: 10.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "somebody pushes, a tool touches, a hose pulls: in time or in place, not everywhere",
    remedy: "leave the stretch out, or model the contact and the body that is touched",
    source: "Haddadin, De Luca, Albu-Schaffer, Robot collisions: a survey, IEEE Trans. Robotics 33(6), 2017, eq. 1",
};

impl Effect for ExternalContact {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; motion.samples()]; 3];
        let mut q = vec![0.0; motion.q.joints()];
        for k in 0..motion.samples() {
            motion.q.sample_into(k, &mut q);
            let per_force = touched(motion.robot, &q, joint, motion.time(k), nonlinear);
            columns.iter_mut().zip(per_force.iter()).for_each(|(c, tau)| c[k] = *tau);
        }
        columns
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        let ArmState { robot, time, q, .. } = state.arm;
        let per_force = touched(robot, q, state.joint, *time, &values[3..]);
        load.torque += per_force.dot(&Vector3::new(values[0], values[1], values[2]));
    }
}

/// N.m at `joint` per N along x, y, z; zero where nothing touches.
fn touched(robot: &Robot, q: &[f64], joint: usize, time: f64, gate: &[f64]) -> Vector3<f64> {
    let (start, duration, height) = (gate[0], gate[1], gate[2]);
    let in_time = (start..start + duration).contains(&time);
    if !in_time || robot.dof() == 0 || flange_placement(robot, q).translation.z > height {
        return Vector3::zeros();
    }
    let jacobian = point_jacobian(robot, q, robot.dof() - 1, &robot.flange.translation);
    -jacobian.fixed_view::<3, 1>(0, joint).into_owned()
}
