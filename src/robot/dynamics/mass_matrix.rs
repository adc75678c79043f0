//! The mass matrix by the composite rigid body algorithm.

use nalgebra::DMatrix;

use super::Workspace;
use super::workspace::Articulated;
use crate::robot::Robot;
use crate::robot::spatial::{Motion, Transform};

/// M(q), symmetric, `dof` x `dof`, kg.m2: Featherstone 2008, section 6.2, table 6.2.
///
/// Rotor inertia is not in it; add it to the diagonal.
pub fn mass_matrix(robot: &Robot, ws: &mut Workspace, q: &[f64]) -> DMatrix<f64> {
    composite_inertias(robot, ws, q);
    let mut m = DMatrix::zeros(robot.dof(), robot.dof());
    for (i, body) in robot.bodies.iter().enumerate() {
        let mut f = ws.i[i].apply(&Motion::rotation(&body.joint.axis, 1.0));
        m[(i, i)] = body.joint.axis.dot(&f.moment);
        let mut j = i;
        while let Some(p) = robot.bodies[j].parent {
            f = ws.x[j].transpose_force(&f);
            j = p;
            m[(i, j)] = robot.bodies[j].joint.axis.dot(&f.moment);
            m[(j, i)] = m[(i, j)];
        }
    }
    m
}

/// I^c_i = I_i + sum over children of X^T I^c X.
fn composite_inertias(robot: &Robot, ws: &mut Workspace, q: &[f64]) {
    for (i, body) in robot.bodies.iter().enumerate() {
        ws.x[i] = Transform::of_joint(&body.joint, q[i]);
        ws.i[i] = Articulated::rigid(&body.inertia);
    }
    for (i, body) in robot.bodies.iter().enumerate().rev() {
        if let Some(p) = body.parent {
            let carried = ws.i[i].in_parent(&ws.x[i]);
            ws.i[p].add(&carried);
        }
    }
}
