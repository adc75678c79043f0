//! Cylinders that show where the masses of an arm are, for viewers without meshes.

use nalgebra::{Rotation3, Vector3};

use crate::robot::{Placement, Robot};

/// Along z of its own frame, centred.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    pub placement: Placement,
    /// m
    pub radius: f64,
    /// m
    pub length: f64,
}

/// A body to look at, in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// About the joint's axis.
    pub hub: Option<Cylinder>,
    /// From the axis to the next joint.
    pub tubes: Vec<Cylinder>,
}

/// kg/m^3: hubs of this density, as high as wide, look like the real joints.
const DENSITY: f64 = 2500.0;

/// From the base to the first joint.
pub fn base(robot: &Robot) -> Vec<Cylinder> {
    let Some(first) = robot.bodies.first() else { return Vec::new() };
    let end = first.joint.placement.translation;
    between(Vector3::zeros(), end, radius(first.inertia.mass)).into_iter().collect()
}

/// A hub about the joint's axis, then tubes to the next joint (or the flange) that leave the axis
/// at the height of the centre of mass.
pub fn body(robot: &Robot, i: usize) -> Shape {
    let body = &robot.bodies[i];
    let axis = body.joint.axis.into_inner();
    let radius = radius(body.inertia.mass);
    let height = axis * axis.dot(&body.inertia.com);
    let end = next_frame(robot, i);
    let lifted = end - axis * axis.dot(&end) + height;
    let hub = between(height - axis * radius, height + axis * radius, radius);
    let tubes = [(Vector3::zeros(), height), (height, lifted), (lifted, end)];
    let tubes = tubes.into_iter().filter_map(|(a, b)| between(a, b, 0.7 * radius));
    // Shorter ones are hidden in the hub.
    let tubes = tubes.filter(|t| t.length > radius).collect();
    Shape { hub, tubes }
}

fn next_frame(robot: &Robot, i: usize) -> Vector3<f64> {
    let child = robot.bodies.iter().find(|b| b.parent == Some(i));
    match child {
        Some(child) => child.joint.placement.translation,
        None if robot.carrier() == Some(i) => robot.flange.translation,
        None => robot.bodies[i].inertia.com,
    }
}

fn radius(mass: f64) -> f64 {
    let r = (mass.max(0.0) / (std::f64::consts::TAU * DENSITY)).cbrt();
    (r * 1e4).round() / 1e4
}

fn between(a: Vector3<f64>, b: Vector3<f64>, radius: f64) -> Option<Cylinder> {
    let length = (b - a).norm();
    if length < 1e-3 || radius <= 0.0 {
        return None;
    }
    let along = Rotation3::rotation_between(&Vector3::z(), &(b - a))
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    let placement = Placement { rotation: *along.matrix(), translation: (a + b) / 2.0 };
    Some(Cylinder { placement, radius, length })
}
