//! The equation of motion M(q) qdd + C(q, qd) qd + g(q) = tau of a rigid tree, one algorithm per
//! file, after Featherstone, *Rigid Body Dynamics Algorithms*, 2008.
//!
//! Slices hold one value per joint, base to wrist, in rad, rad/s, rad/s^2 and N.m. They must have
//! `robot.dof()` entries: shorter ones panic, which callers prevent by checking user data.

mod energy;
mod forward;
#[cfg(test)]
mod golden;
mod gravity;
mod inverse;
mod jacobian;
mod kinematics;
mod mass_matrix;
mod regressor;
mod series;
#[cfg(test)]
mod tests;
mod workspace;

pub use energy::{Energy, energy};
pub use forward::{forward_dynamics, forward_dynamics_with_rotors};
pub use gravity::gravity_torque;
pub use inverse::inverse_dynamics;
pub use jacobian::point_jacobian;
pub use kinematics::{body_placements, flange_placement};
pub use mass_matrix::{equation_of_motion, mass_matrix};
pub use regressor::{body_regressor, body_regressor_series, regressor};
pub use series::{inverse_dynamics_series, mass_matrix_series, regressor_series};
pub use workspace::Workspace;

use super::model::Robot;
use super::spatial::{Force, Motion, Transform};

/// Gravity as an upward acceleration of the base, so that no algorithm treats it apart.
fn base_acceleration(robot: &Robot) -> Motion {
    Motion { angular: nalgebra::Vector3::zeros(), linear: -robot.gravity }
}

/// tau_i = S_i^T f_i, f_parent += X^T f_i, from the tips to the base (table 5.1, step 4).
fn project_forces(robot: &Robot, x: &[Transform], f: &mut [Force], tau: &mut [f64]) {
    for (i, body) in robot.bodies.iter().enumerate().rev() {
        tau[i] = body.joint.axis.dot(&f[i].moment);
        if let Some(p) = body.parent {
            let carried = x[i].transpose_force(&f[i]);
            f[p] += carried;
        }
    }
}
