//! Where the bodies are.

use crate::robot::spatial::Transform;
use crate::robot::{Placement, Robot};

/// Every body's frame seen from the base, in the order of `robot.bodies`.
pub fn body_placements(robot: &Robot, q: &[f64]) -> Vec<Placement> {
    let mut placements: Vec<Placement> = Vec::with_capacity(robot.dof());
    for (body, &q) in robot.bodies.iter().zip(q) {
        let x = Transform::of_joint(&body.joint, q);
        let local = Placement { rotation: x.e.transpose(), translation: x.r };
        placements.push(body.parent.map_or(local, |p| placements[p].compose(&local)));
    }
    placements
}

/// The flange (tool0) seen from the base.
pub fn flange_placement(robot: &Robot, q: &[f64]) -> Placement {
    match robot.carrier().and_then(|i| body_placements(robot, q).into_iter().nth(i)) {
        Some(carrier) => carrier.compose(&robot.flange),
        None => robot.flange,
    }
}
