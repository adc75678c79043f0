//! Kinetic and potential energy.

use super::{Workspace, body_placements};
use crate::robot::Robot;
use crate::robot::spatial::{Motion, Transform};

/// J. The potential is zero with all mass at the base frame's origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    pub kinetic: f64,
    pub potential: f64,
}

impl Energy {
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// T = 1/2 sum v_i . I_i v_i and V = - sum m_i g . c_i, Featherstone 2008, section 2.14.
/// Rotor inertia is not in T.
pub fn energy(robot: &Robot, ws: &mut Workspace, q: &[f64], qd: &[f64]) -> Energy {
    let placements = body_placements(robot, q);
    let mut energy = Energy { kinetic: 0.0, potential: 0.0 };
    for (i, body) in robot.bodies.iter().enumerate() {
        let x = Transform::of_joint(&body.joint, q[i]);
        let v_j = Motion::rotation(&body.joint.axis, qd[i]);
        ws.v[i] = body.parent.map_or(v_j, |p| x.motion(&ws.v[p]) + v_j);
        energy.kinetic += 0.5 * ws.v[i].dot(&body.inertia.apply(&ws.v[i]));
        let com = placements[i].point(&body.inertia.com);
        energy.potential -= body.inertia.mass * robot.gravity.dot(&com);
    }
    energy
}
