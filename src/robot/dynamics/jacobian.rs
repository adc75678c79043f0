//! The geometric Jacobian of a point fixed on a body.

use nalgebra::{Matrix6xX, Vector3};

use super::body_placements;
use crate::robot::Robot;

/// J(q) with [velocity of the point; angular velocity of the body] = J qd, in base axes;
/// 6 x `dof`, rows 0-2 m/rad, rows 3-5 1. `point` is given in the body's frame, m.
///
/// tau = J^T [force; moment] is the joint torque that balances a load -[force; moment] there.
pub fn point_jacobian(
    robot: &Robot,
    q: &[f64],
    body: usize,
    point: &Vector3<f64>,
) -> Matrix6xX<f64> {
    let placements = body_placements(robot, q);
    let point = placements[body].point(point);
    let mut jacobian = Matrix6xX::zeros(robot.dof());
    let mut next = Some(body);
    while let Some(j) = next {
        let axis = placements[j].rotation * robot.bodies[j].joint.axis.into_inner();
        let linear = axis.cross(&(point - placements[j].translation));
        jacobian.fixed_view_mut::<3, 1>(0, j).copy_from(&linear);
        jacobian.fixed_view_mut::<3, 1>(3, j).copy_from(&axis);
        next = robot.bodies[j].parent;
    }
    jacobian
}
