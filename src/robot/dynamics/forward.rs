//! Forward dynamics by the articulated body algorithm.

use super::workspace::Articulated;
use super::{Workspace, base_acceleration};
use crate::robot::Robot;
use crate::robot::spatial::{Motion, Transform};

/// qdd = M(q)^-1 (tau - C(q, qd) qd - g(q)), Featherstone 2008, section 7.3, table 7.1.
///
/// Writes rad/s^2 into `qdd`. Does not allocate.
pub fn forward_dynamics(
    robot: &Robot,
    ws: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    tau: &[f64],
    qdd: &mut [f64],
) {
    articulate(robot, ws, q, qd, tau, |_| 0.0);
    accelerate(robot, ws, qdd);
}

/// Forward dynamics with `rotor_inertia` (kg.m2 as seen at each joint) on the diagonal of M(q).
pub fn forward_dynamics_with_rotors(
    robot: &Robot,
    ws: &mut Workspace,
    rotor_inertia: &[f64],
    q: &[f64],
    qd: &[f64],
    tau: &[f64],
    qdd: &mut [f64],
) {
    articulate(robot, ws, q, qd, tau, |i| rotor_inertia[i]);
    accelerate(robot, ws, qdd);
}

/// Velocities outwards, then articulated inertias I^A and bias forces p^A inwards.
fn articulate(
    robot: &Robot,
    ws: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    tau: &[f64],
    rotor: impl Fn(usize) -> f64,
) {
    for (i, body) in robot.bodies.iter().enumerate() {
        let x = Transform::of_joint(&body.joint, q[i]);
        let v_j = Motion::rotation(&body.joint.axis, qd[i]);
        let v = body.parent.map_or(v_j, |p| x.motion(&ws.v[p]) + v_j);
        // The velocity product c_i = v_i x S qd; the acceleration comes on top in the last pass.
        ws.a[i] = v.cross(&v_j);
        ws.i[i] = Articulated::rigid(&body.inertia);
        ws.f[i] = v.cross_force(&body.inertia.apply(&v));
        ws.v[i] = v;
        ws.x[i] = x;
    }
    for (i, body) in robot.bodies.iter().enumerate().rev() {
        let s = &body.joint.axis;
        let u_force = ws.i[i].apply(&Motion::rotation(s, 1.0));
        let d = s.dot(&u_force.moment) + rotor(i);
        let u = tau[i] - s.dot(&ws.f[i].moment);
        (ws.u_force[i], ws.d[i], ws.u[i]) = (u_force, d, u);
        if let Some(p) = body.parent {
            let inertia = ws.i[i].released(&u_force, d);
            let force = ws.f[i] + inertia.apply(&ws.a[i]) + u_force * (u / d);
            let carried = ws.x[i].transpose_force(&force);
            ws.i[p].add(&inertia.in_parent(&ws.x[i]));
            ws.f[p] += carried;
        }
    }
}

/// qdd_i = (u - U^T a') / D with a' = X a_p + c_i, outwards.
fn accelerate(robot: &Robot, ws: &mut Workspace, qdd: &mut [f64]) {
    let a0 = base_acceleration(robot);
    for (i, body) in robot.bodies.iter().enumerate() {
        let a = ws.x[i].motion(body.parent.map_or(&a0, |p| &ws.a[p])) + ws.a[i];
        qdd[i] = (ws.u[i] - a.dot(&ws.u_force[i])) / ws.d[i];
        ws.a[i] = a + Motion::rotation(&body.joint.axis, qdd[i]);
    }
}
