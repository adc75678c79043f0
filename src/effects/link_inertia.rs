//! A link's mass and centre of mass other than in the twin: tau = Y_j [dm, d(m c)].
//!
//! First moments m c are in the link's frame. The rotational inertia about the centre of mass stays,
//! the columns are linear in small changes. Not all combinations can be seen: a mass on a vertical
//! first axis has no torque.

use nalgebra::{Matrix3, Vector3};

use super::{About, Effect, Mechanism, Motion, Parameter, Role, Scope};
use crate::robot::{Inertia, Robot, body_regressor_series};
use crate::series::JointSeries;

pub struct LinkInertia;

static ABOUT: About = About {
    name: "link_inertia",
    law: "tau = Y_j(q, qd, qdd) [dm, d(m cx), d(m cy), d(m cz)]",
    scope: Scope::Link,
    parameters: &[
        Parameter {
            name: "link_mass",
            symbol: "dm",
            unit: "kg",
            min: -5.0,
            max: 5.0,
            typical: 0.5,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "link_moment_x",
            symbol: "d(m cx)",
            unit: "kg.m",
            min: -2.0,
            max: 2.0,
            typical: 0.05,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "link_moment_y",
            symbol: "d(m cy)",
            unit: "kg.m",
            min: -2.0,
            max: 2.0,
            typical: 0.05,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "link_moment_z",
            symbol: "d(m cz)",
            unit: "kg.m",
            min: -2.0,
            max: 2.0,
            typical: 0.05,
            null: 0.0,
            role: Role::Linear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "CAD masses that leave out cables, grease and screws; parts bolted to a link",
    remedy: "correct the link's mass and centre of mass in the URDF",
    source: "Atkeson, An, Hollerbach, Int. J. Robotics Research 5(3), 1986: torque linear in inertial parameters",
};

impl Effect for LinkInertia {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn reach(&self, motion: &Motion<'_>, from: usize, _: &[f64]) -> Vec<JointSeries> {
        let Motion { robot, q, qd, qdd, .. } = motion;
        let body = body_regressor_series(robot, q, qd, qdd, from);
        let inertia = &robot.bodies[from].inertia;
        (0..4).map(|i| weighted_sum(&body, &per_unit(inertia, i))).collect()
    }

    fn expected(&self, robot: &Robot, joint: usize) -> Vec<f64> {
        let inertia = &robot.bodies[joint].inertia;
        let moment = inertia.mass * (CENTRE_ERROR_M + MASS_ERROR * inertia.com.norm());
        vec![MASS_ERROR * inertia.mass, moment, moment, moment]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        let inertia = &mut mechanism.robot.bodies[joint].inertia;
        let moment = inertia.com * inertia.mass + Vector3::new(values[1], values[2], values[3]);
        let mass = inertia.mass + values[0];
        if values.iter().any(|v| *v != 0.0) {
            (inertia.mass, inertia.com) = (mass, moment / mass);
        }
    }
}

/// What data sheets and CAD are commonly wrong by: of a mass, and of its centre, m.
const MASS_ERROR: f64 = 0.1;
const CENTRE_ERROR_M: f64 = 0.02;

/// The ten inertial parameters per unit of dm (`i` = 0) or of a first moment: with h = m c,
/// d I_o = d(h^T h 1 - h h^T)/m.
fn per_unit(inertia: &Inertia, i: usize) -> [f64; 10] {
    let c = inertia.com;
    let (dm, dh) = match i {
        0 => (1.0, Vector3::zeros()),
        _ => (0.0, Vector3::ith(i - 1, 1.0)),
    };
    let second = c * dh.transpose() + dh * c.transpose() - c * c.transpose() * dm;
    let o = Matrix3::identity() * second.trace() - second;
    [dm, dh.x, dh.y, dh.z, o.m11, o.m12, o.m22, o.m13, o.m23, o.m33]
}

fn weighted_sum(columns: &[JointSeries; 10], weights: &[f64; 10]) -> JointSeries {
    columns[0].map_joints(|j, column| {
        let mut sum = vec![0.0; column.len()];
        for (column, weight) in columns.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            sum.iter_mut().zip(column.joint(j)).for_each(|(s, c)| *s += weight * c);
        }
        sum
    })
}
