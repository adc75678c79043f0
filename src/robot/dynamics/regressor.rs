//! Joint torque as a linear function of the bodies' inertial parameters.

use nalgebra::{DMatrix, Matrix3, SMatrix, Vector3};

use super::Workspace;
use super::inverse::propagate;
use crate::robot::Robot;
use crate::robot::spatial::Motion;
use crate::series::JointSeries;

type Block = SMatrix<f64, 6, 10>;

/// Y(q, qd, qdd) with tau = Y pi, `dof` x 10 `dof`: ten columns per body in the order and units
/// of [`crate::robot::Inertia::parameters`]. Atkeson, An, Hollerbach, *Int. J. Robotics Research*
/// 5(3), 1986.
pub fn regressor(
    robot: &Robot,
    ws: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
) -> DMatrix<f64> {
    propagate(robot, ws, q, qd, qdd);
    let mut y = DMatrix::zeros(robot.dof(), 10 * robot.dof());
    for body in 0..robot.dof() {
        fill(robot, ws, body, |joint, row| {
            y.fixed_view_mut::<1, 10>(joint, 10 * body).copy_from(&row);
        });
    }
    y
}

/// The ten columns of one body, `dof` x 10: how its parameters load every joint. For a payload
/// take the last body.
pub fn body_regressor(
    robot: &Robot,
    ws: &mut Workspace,
    q: &[f64],
    qd: &[f64],
    qdd: &[f64],
    body: usize,
) -> DMatrix<f64> {
    propagate(robot, ws, q, qd, qdd);
    let mut y = DMatrix::zeros(robot.dof(), 10);
    fill(robot, ws, body, |joint, row| y.fixed_view_mut::<1, 10>(joint, 0).copy_from(&row));
    y
}

/// [`body_regressor`] along a motion: for each of the ten parameters the torque of every joint
/// per unit of it.
pub fn body_regressor_series(
    robot: &Robot,
    q: &JointSeries,
    qd: &JointSeries,
    qdd: &JointSeries,
    body: usize,
) -> [JointSeries; 10] {
    let (n, samples) = (robot.dof(), q.samples());
    let mut columns: [JointSeries; 10] = std::array::from_fn(|_| JointSeries::zeros(n, samples));
    let mut ws = Workspace::new(robot);
    let mut state = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    for k in 0..samples {
        for (values, series) in state.iter_mut().zip([q, qd, qdd]) {
            series.sample_into(k, values);
        }
        propagate(robot, &mut ws, &state[0], &state[1], &state[2]);
        fill(robot, &ws, body, |joint, row| {
            for (column, value) in columns.iter_mut().zip(row.iter()) {
                column.joint_mut(joint)[k] = *value;
            }
        });
    }
    columns
}

/// Calls `put(joint, row)` for the joints between `body` and the base with S_j^T X^T A_body,
/// after [`propagate`].
fn fill(
    robot: &Robot,
    ws: &Workspace,
    body: usize,
    mut put: impl FnMut(usize, SMatrix<f64, 1, 10>),
) {
    let mut block = wrench_block(&ws.v[body], &ws.a[body]);
    let mut next = Some(body);
    while let Some(j) = next {
        put(j, robot.bodies[j].joint.axis.tr_mul(&block.fixed_rows::<3>(0)));
        next = robot.bodies[j].parent;
        if next.is_some() {
            let x = &ws.x[j];
            let force = x.e.tr_mul(&block.fixed_rows::<3>(3));
            let moment = x.e.tr_mul(&block.fixed_rows::<3>(0)) + x.r.cross_matrix() * force;
            block.fixed_rows_mut::<3>(0).copy_from(&moment);
            block.fixed_rows_mut::<3>(3).copy_from(&force);
        }
    }
}

/// A with [moment; force] = I a + v x* I v = A pi, all about the body's origin: with the
/// acceleration d of the origin, force = m d + (alpha x + w x w x) h and
/// moment = h x d + L(alpha) I + w x L(w) I, h = m c.
fn wrench_block(v: &Motion, a: &Motion) -> Block {
    let d = a.linear + v.angular.cross(&v.linear);
    let w = v.angular.cross_matrix();
    let mut block = Block::zeros();
    block.fixed_view_mut::<3, 1>(3, 0).copy_from(&d);
    block.fixed_view_mut::<3, 3>(0, 1).copy_from(&-d.cross_matrix());
    block.fixed_view_mut::<3, 3>(3, 1).copy_from(&(a.angular.cross_matrix() + w * w));
    block
        .fixed_view_mut::<3, 6>(0, 4)
        .copy_from(&(inertia_columns(&a.angular) + w * inertia_columns(&v.angular)));
    block
}

/// L(w) with I w = L(w) [Ixx, Ixy, Iyy, Ixz, Iyz, Izz].
fn inertia_columns(w: &Vector3<f64>) -> SMatrix<f64, 3, 6> {
    let mut l = SMatrix::<f64, 3, 6>::zeros();
    let left = Matrix3::new(w.x, w.y, 0.0, 0.0, w.x, w.y, 0.0, 0.0, 0.0);
    let right = Matrix3::new(w.z, 0.0, 0.0, 0.0, w.z, 0.0, w.x, w.y, w.z);
    l.fixed_view_mut::<3, 3>(0, 0).copy_from(&left);
    l.fixed_view_mut::<3, 3>(0, 3).copy_from(&right);
    l
}
