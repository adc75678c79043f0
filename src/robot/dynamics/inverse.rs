//! Inverse dynamics by the recursive Newton-Euler algorithm.

use super::{Workspace, base_acceleration, project_forces};
use crate::robot::Robot;
use crate::robot::spatial::{Motion, Transform};

/// tau = M(q) qdd + C(q, qd) qd + g(q), Featherstone 2008, section 5.3, table 5.1.
///
/// Writes the torque of every joint into `tau`, N.m. Does not allocate.
pub fn inverse_dynamics(
    robot: &Robot,
    ws: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    tau: &mut [f64],
) {
    place(robot, ws, q);
    forces(robot, ws, qd, |i| qdd[i], tau);
}

/// [`inverse_dynamics`] where the workspace has been placed.
pub(super) fn forces(
    robot: &Robot,
    ws: &mut Workspace,
    qd: &[f64],
    qdd: impl Fn(usize) -> f64,
    tau: &mut [f64],
) {
    accelerate(robot, ws, qd, qdd);
    for (i, body) in robot.bodies.iter().enumerate() {
        ws.f[i] = body.inertia.force(&ws.v[i], &ws.a[i]);
    }
    project_forces(robot, &ws.x, &mut ws.f, tau);
}

/// Every joint at its angle.
pub(super) fn place(robot: &Robot, ws: &mut Workspace, q: &[f64]) {
    for ((x, body), q) in ws.x.iter_mut().zip(&robot.bodies).zip(q) {
        *x = Transform::of_joint(&body.joint, *q);
    }
}

/// Velocity and acceleration of every body of a placed workspace, in its own coordinates; gravity is in them as an
/// acceleration of the base: v_i = X v_p + S qd, a_i = X a_p + S qdd + v_i x S qd.
pub(super) fn accelerate(
    robot: &Robot,
    ws: &mut Workspace,
    qd: &[f64],
    qdd: impl Fn(usize) -> f64,
) {
    let a0 = base_acceleration(robot);
    for (i, body) in robot.bodies.iter().enumerate() {
        let x = &ws.x[i];
        let (v_p, a_p) = match body.parent {
            Some(p) => (ws.v[p], ws.a[p]),
            None => (Motion::zero(), a0),
        };
        let v_j = Motion::rotation(&body.joint.axis, qd[i]);
        let v = x.motion(&v_p) + v_j;
        ws.a[i] = x.motion(&a_p) + Motion::rotation(&body.joint.axis, qdd(i)) + v.cross(&v_j);
        ws.v[i] = v;
    }
}

/// [`place`], then [`accelerate`].
pub(super) fn propagate(robot: &Robot, ws: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64]) {
    place(robot, ws, q);
    accelerate(robot, ws, qd, |i| qdd[i]);
}
