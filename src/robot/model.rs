//! What a rigid tree of revolute joints is. Immutable; state is passed to the dynamics explicitly.

use nalgebra::{Matrix3, Unit, Vector3};

/// A rigid robot with revolute joints, bodies numbered so that parents come first
/// (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, section 4.1).
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    pub name: String,
    /// Body `i` moves with joint `i`.
    pub bodies: Vec<Body>,
    /// Gravitational acceleration in the base frame, m/s^2.
    pub gravity: Vector3<f64>,
    /// From the last body's frame to the flange (tool0), for payloads and Cartesian paths.
    pub flange: Placement,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    pub name: String,
    /// Index of the parent body; `None` is the fixed base.
    pub parent: Option<usize>,
    pub joint: Joint,
    /// Inertia in the body's own frame, whose origin lies on the joint axis.
    pub inertia: Inertia,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    pub name: String,
    /// Joint frame at q = 0, seen from the parent body's frame.
    pub placement: Placement,
    /// Unit axis in the joint frame; positive rotation by the right hand.
    pub axis: Unit<Vector3<f64>>,
    pub limits: Limits,
}

/// rad, rad/s, N.m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    pub lower: f64,
    pub upper: f64,
    pub velocity: f64,
    pub effort: f64,
}

/// A frame seen from another: x_other = rotation * x_own + translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    pub rotation: Matrix3<f64>,
    pub translation: Vector3<f64>,
}

impl Placement {
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }
}

/// Mass, centre of mass, and rotational inertia about the centre of mass, in body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// kg
    pub mass: f64,
    /// m
    pub com: Vector3<f64>,
    /// kg.m2 about the centre of mass
    pub about_com: Matrix3<f64>,
}

impl Robot {
    /// Degrees of freedom.
    pub fn dof(&self) -> usize {
        self.bodies.len()
    }
}
