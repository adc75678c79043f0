//! What a rigid tree of revolute joints is. Immutable; state is passed to the dynamics explicitly.

use nalgebra::{Matrix3, Unit, Vector3};
use serde::{Deserialize, Serialize};

/// A rigid robot with revolute joints, bodies numbered so that parents come first
/// (Featherstone, *Rigid Body Dynamics Algorithms*, 2008, section 4.1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    pub name: String,
    /// Body `i` moves with joint `i`.
    pub bodies: Vec<Body>,
    /// Gravitational acceleration in the base frame, m/s^2.
    pub gravity: Vector3<f64>,
    /// The flange (tool0) seen from the frame of the body that carries it, for payloads and Cartesian paths.
    pub flange: Placement,
    /// That body, where it is not the last: a gripper's jaw moves beyond the flange.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flange_on: Option<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Body {
    pub name: String,
    /// Index of the parent body; `None` is the fixed base.
    pub parent: Option<usize>,
    pub joint: Joint,
    /// Inertia in the body's own frame, whose origin lies on the joint axis.
    pub inertia: Inertia,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    pub name: String,
    /// Joint frame at q = 0, seen from the parent body's frame.
    pub placement: Placement,
    /// Unit axis in the joint frame; positive rotation by the right hand.
    pub axis: Unit<Vector3<f64>>,
    pub limits: Limits,
}

/// rad, rad/s, N.m. A continuous joint has infinite `lower` and `upper`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    pub lower: f64,
    pub upper: f64,
    pub velocity: f64,
    pub effort: f64,
}

/// A frame seen from another: x_other = rotation * x_own + translation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    pub rotation: Matrix3<f64>,
    pub translation: Vector3<f64>,
}

impl Placement {
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// The frame `inner`, which is seen from this frame, seen from where this frame is seen from.
    pub fn compose(&self, inner: &Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.point(&inner.translation),
        }
    }

    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// A point given in this frame, seen from the other.
    pub fn point(&self, own: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * own + self.translation
    }
}

/// Mass, centre of mass, and rotational inertia about the centre of mass, in body axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Inertia {
    /// kg
    pub mass: f64,
    /// m
    pub com: Vector3<f64>,
    /// kg.m2 about the centre of mass
    pub about_com: Matrix3<f64>,
}

impl Inertia {
    pub fn zero() -> Self {
        Self { mass: 0.0, com: Vector3::zeros(), about_com: Matrix3::zeros() }
    }

    /// Rotational inertia about the frame's origin, I_o = I_c + m (c.c 1 - c c^T).
    pub fn about_origin(&self) -> Matrix3<f64> {
        self.about_com + point_mass(self.mass, &self.com)
    }

    /// [m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz], the inertia about the frame's origin:
    /// what inverse dynamics is linear in.
    pub fn parameters(&self) -> [f64; 10] {
        let h = self.com * self.mass;
        let i = self.about_origin();
        [self.mass, h.x, h.y, h.z, i.m11, i.m12, i.m22, i.m13, i.m23, i.m33]
    }

    /// The inverse of [`Inertia::parameters`]. The centre of mass of no mass is the origin.
    pub fn from_parameters(p: &[f64; 10]) -> Self {
        let mass = p[0];
        let h = Vector3::new(p[1], p[2], p[3]);
        let com = if mass == 0.0 { Vector3::zeros() } else { h / mass };
        let about_origin = Matrix3::new(p[4], p[5], p[7], p[5], p[6], p[8], p[7], p[8], p[9]);
        Self { mass, com, about_com: about_origin - point_mass(mass, &com) }
    }

    /// A body of the same shape that is `factor` times as heavy.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { mass: factor * self.mass, com: self.com, about_com: self.about_com * factor }
    }

    /// This body seen from the frame that sees its own frame at `placement`.
    pub fn seen_from(&self, placement: &Placement) -> Self {
        let r = placement.rotation;
        Self {
            mass: self.mass,
            com: placement.point(&self.com),
            about_com: r * self.about_com * r.transpose(),
        }
    }

    /// Two bodies, given in the same frame, bolted together.
    pub fn joined_with(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass == 0.0 {
            return Self { about_com: self.about_com + other.about_com, ..*self };
        }
        let com = (self.com * self.mass + other.com * other.mass) / mass;
        let part = |i: &Self| i.about_com + point_mass(i.mass, &(i.com - com));
        Self { mass, com, about_com: part(self) + part(other) }
    }
}

/// Inertia about the origin of a point mass at `c`.
fn point_mass(mass: f64, c: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * c.dot(c) - c * c.transpose()) * mass
}

impl Robot {
    /// Degrees of freedom.
    pub fn dof(&self) -> usize {
        self.bodies.len()
    }

    /// kg, of all moving bodies.
    pub fn mass(&self) -> f64 {
        self.bodies.iter().map(|b| b.inertia.mass).sum()
    }

    /// m, from the base to the flange with every joint's offset laid end to end.
    pub fn reach(&self) -> f64 {
        let offsets = self.bodies.iter().map(|b| b.joint.placement.translation.norm());
        offsets.sum::<f64>() + self.flange.translation.norm()
    }

    /// The body that carries the flange; none in an arm without bodies.
    pub fn carrier(&self) -> Option<usize> {
        self.flange_on.or(self.dof().checked_sub(1))
    }

    /// The arm with a load bolted to its flange: mass in kg, centre of mass in m and inertia about
    /// it in kg.m2, both in the flange's frame.
    pub fn with_payload(&self, mass: f64, com: Vector3<f64>, about_com: Matrix3<f64>) -> Self {
        let load = Inertia { mass, com, about_com }.seen_from(&self.flange);
        let mut robot = self.clone();
        if let Some(carrier) = self.carrier().and_then(|i| robot.bodies.get_mut(i)) {
            carrier.inertia = carrier.inertia.joined_with(&load);
        }
        robot
    }
}
