//! Where on the arm somebody may touch it.

use nalgebra::Vector3;

use crate::robot::Robot;
use crate::series::JointSeries;

/// Places along a link, as shares of the way from its joint to the next one (the flange at the last).
const ALONG: [f64; 2] = [0.5, 1.0];
/// Share of the arm's length: ends of a link nearer to each other than this are one place, and a force
/// with less than this as its lever at every joint does not show.
const NEAR: f64 = 0.1;

/// A point fixed on a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Number of the link, from 0 at the base.
    pub link: usize,
    /// Position in the link's frame, m.
    pub point: Vector3<f64>,
}

/// Columns of what a joint feels of a force, one row of three per joint, m.
pub type Levers = Vec<[f64; 3]>;

/// Half way along every long link and at the end of every link.
pub fn places(robot: &Robot) -> Vec<Place> {
    let ends: Vec<Vector3<f64>> = (0..robot.dof()).map(|link| end(robot, link)).collect();
    let length: f64 = ends.iter().map(|e| e.norm()).sum();
    let of_link = |(link, end): (usize, &Vector3<f64>)| {
        let long = end.norm() > NEAR * length;
        let along = ALONG.into_iter().filter(move |share| long || *share == 1.0);
        let end = *end;
        along.map(move |share| Place { link, point: end * share }).collect::<Vec<_>>()
    };
    let all: Vec<Place> = ends.iter().enumerate().flat_map(of_link).collect();
    let q = vec![0.0; robot.dof()];
    let shows = |place: &Place| {
        let lever = |row: &[f64; 3]| Vector3::from_column_slice(row).norm();
        levers(robot, &q, place).iter().map(lever).fold(0.0, f64::max) > NEAR * length
    };
    all.into_iter().filter(shows).collect()
}

/// Position of the flange, or else of the next joint, in the link's frame, m; centre of mass where the link
/// branches.
fn end(robot: &Robot, link: usize) -> Vector3<f64> {
    if robot.carrier() == Some(link) {
        return robot.flange.translation;
    }
    let children: Vec<_> = robot.bodies.iter().filter(|b| b.parent == Some(link)).collect();
    match &children[..] {
        [child] => child.joint.placement.translation,
        _ => robot.bodies[link].inertia.com,
    }
}

/// Linear rows of the point's Jacobian, joint by joint: tau_j = levers[j] . F balances -F.
pub fn levers(robot: &Robot, q: &[f64], place: &Place) -> Levers {
    let jacobian = crate::robot::point_jacobian(robot, q, place.link, &place.point);
    (0..robot.dof()).map(|j| [0, 1, 2].map(|axis| jacobian[(axis, j)])).collect()
}

/// [`levers`] at some samples of a motion.
pub fn along(robot: &Robot, q: &JointSeries, samples: &[usize], place: &Place) -> Vec<Levers> {
    let mut pose = vec![0.0; robot.dof()];
    let mut at = |k: &usize| {
        q.sample_into(*k, &mut pose);
        levers(robot, &pose, place)
    };
    samples.iter().map(&mut at).collect()
}
