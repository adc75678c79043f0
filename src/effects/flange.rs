//! Where the flange goes along a motion, and what a force on it asks of the joints.

use nalgebra::Matrix3xX;

use crate::robot::{Robot, flange_placement, point_jacobian};
use crate::series::JointSeries;

/// The flange along one motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Flange {
    /// Height above the base, m, per sample.
    pub height: Vec<f64>,
    /// Torque the drive must supply at every joint per N on the flange along x, y and z of the base, N.m/N.
    pub per_force: [JointSeries; 3],
}

impl Flange {
    pub(super) fn along(robot: &Robot, motion: &JointSeries) -> Self {
        let (dof, samples) = (robot.dof(), motion.samples());
        let mut per_force = [(); 3].map(|()| JointSeries::zeros(dof, samples));
        let mut q = vec![0.0; dof];
        let height = |k: usize| {
            motion.sample_into(k, &mut q);
            let torque = torque_per_force(robot, &q);
            for (axis, column) in per_force.iter_mut().enumerate() {
                (0..dof).for_each(|j| column.joint_mut(j)[k] = torque[(axis, j)]);
            }
            flange_placement(robot, &q).translation.z
        };
        let height = (0..samples).map(height).collect();
        Self { height, per_force }
    }
}

/// N.m at every joint (columns) per N on the flange along x, y, z of the base (rows): -J', as the drive
/// supplies what balances the force.
pub fn torque_per_force(robot: &Robot, q: &[f64]) -> Matrix3xX<f64> {
    let Some(carrier) = robot.carrier() else { return Matrix3xX::zeros(0) };
    -point_jacobian(robot, q, carrier, &robot.flange.translation).fixed_rows::<3>(0)
}
