//! The torque that holds the arm still.

use super::{Workspace, base_acceleration, project_forces};
use crate::robot::Robot;
use crate::robot::spatial::Transform;

/// g(q) = inverse dynamics at rest; the gradient of the potential energy. N.m into `tau`.
pub fn gravity_torque(robot: &Robot, ws: &mut Workspace, q: &[f64], tau: &mut [f64]) {
    let a0 = base_acceleration(robot);
    for (i, body) in robot.bodies.iter().enumerate() {
        ws.x[i] = Transform::of_joint(&body.joint, q[i]);
        ws.a[i] = ws.x[i].motion(body.parent.map_or(&a0, |p| &ws.a[p]));
        ws.f[i] = body.inertia.apply(&ws.a[i]);
    }
    project_forces(robot, &ws.x, &mut ws.f, tau);
}
