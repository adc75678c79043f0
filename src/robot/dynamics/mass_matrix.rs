//! The mass matrix by the composite rigid body algorithm, alone or with the forces beside it.

use nalgebra::DMatrix;

use super::Workspace;
use super::inverse::{forces, place};
use super::workspace::Composite;
use crate::robot::Robot;

/// M(q), symmetric, `dof` x `dof`, kg.m2: Featherstone 2008, section 6.2, table 6.2.
///
/// Rotor inertia is not in it; add it to the diagonal.
pub fn mass_matrix(robot: &Robot, ws: &mut Workspace, q: &[f64]) -> DMatrix<f64> {
    place(robot, ws, q);
    let mut m = DMatrix::zeros(robot.dof(), robot.dof());
    fill(robot, ws, &mut m);
    m
}

/// M(q) into `m` (`dof` x `dof`, as [`mass_matrix`]) and C(q, qd) qd + g(q) into `bias` (`dof` values, N.m; Featherstone
/// 2008, section 6.1): each joint is turned once for both. Does not allocate.
pub fn equation_of_motion(
    robot: &Robot,
    ws: &mut Workspace,
    [q, qd]: [&[f64]; 2],
    m: &mut DMatrix<f64>,
    bias: &mut [f64],
) {
    place(robot, ws, q);
    forces(robot, ws, qd, |_| 0.0, bias);
    fill(robot, ws, m);
}

/// M where the workspace has been placed.
fn fill(robot: &Robot, ws: &mut Workspace, m: &mut DMatrix<f64>) {
    compose(robot, ws);
    // Bodies on different branches do not feel each other.
    m.fill(0.0);
    for (i, body) in robot.bodies.iter().enumerate() {
        let mut f = ws.carried[i].turned_about(&body.joint.axis);
        m[(i, i)] = body.joint.axis.dot(&f.moment);
        let mut j = i;
        while let Some(p) = robot.bodies[j].parent {
            f = ws.x[j].transpose_force(&f);
            j = p;
            m[(i, j)] = robot.bodies[j].joint.axis.dot(&f.moment);
            m[(j, i)] = m[(i, j)];
        }
    }
}

/// I^c_i = I_i + sum over children of X^T I^c X.
fn compose(robot: &Robot, ws: &mut Workspace) {
    for (i, body) in robot.bodies.iter().enumerate() {
        ws.carried[i] = Composite::of(&body.inertia);
    }
    for (i, body) in robot.bodies.iter().enumerate().rev() {
        if let Some(p) = body.parent {
            let seen = ws.carried[i].in_parent(&ws.x[i]);
            ws.carried[p].add(&seen);
        }
    }
}
