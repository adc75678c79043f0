//! Kinematic and mass tables of the built-in arms: one file each, data only.

mod ur10;
mod ur10e;
mod ur3;
mod ur3e;
pub mod ur5;
mod ur5_as_printed;
mod ur5e;

use nalgebra::{Matrix3, Vector3};

use super::model::{Body, Inertia, Joint, Limits, Placement, Robot};

/// Every built-in arm.
pub const BUILT_IN: &[&Table] = &[
    &ur5::TABLE,
    &ur5_as_printed::TABLE,
    &ur3::TABLE,
    &ur10::TABLE,
    &ur3e::TABLE,
    &ur5e::TABLE,
    &ur10e::TABLE,
];

/// As the manufacturer's drivers name them, base to wrist; a prefix tells arms apart.
pub const JOINTS: [&str; 6] = [
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
];

const LINKS: [&str; 6] = [
    "shoulder_link",
    "upper_arm_link",
    "forearm_link",
    "wrist_1_link",
    "wrist_2_link",
    "wrist_3_link",
];

/// A six-axis arm in standard Denavit-Hartenberg parameters, as manufacturers print it:
/// T_i = Rot_z(q_i) Trans_z(d_i) Trans_x(a_i) Rot_x(alpha_i).
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Table {
    pub name: &'static str,
    /// Where each group of numbers comes from.
    pub source: &'static str,
    /// From the base axis, as in the data sheet, m.
    pub reach: f64,
    /// m
    pub d: [f64; 6],
    /// m
    pub a: [f64; 6],
    /// rad
    pub alpha: [f64; 6],
    /// kg
    pub mass: [f64; 6],
    /// Centre of mass in the link's DH frame, m.
    pub com: [[f64; 3]; 6],
    /// [Ixx, Ixy, Iyy, Ixz, Iyz, Izz] about the centre of mass in the axes of the DH frame, kg.m2.
    pub inertia: [[f64; 6]; 6],
    /// Joints turn from minus to plus this, rad; infinite where the joint is continuous.
    pub range: [f64; 6],
    /// rad/s
    pub velocity: [f64; 6],
    /// N.m
    pub effort: [f64; 6],
}

impl Table {
    /// The arm in body frames whose origin lies on the joint's axis and whose z is that axis:
    /// body i's frame is T_{i-1} Rot_z(q_i) Trans_z(d_i). The DH frame i follows from it by
    /// Trans_x(a_i) Rot_x(alpha_i), fixed on the body. The base is DH frame 0, the flange 6.
    pub fn robot(&self) -> Robot {
        let mut bodies = Vec::new();
        let mut dh_frame = Placement::identity();
        for (i, link) in LINKS.iter().enumerate() {
            let up = Vector3::new(0.0, 0.0, self.d[i]);
            let placement =
                Placement { rotation: dh_frame.rotation, translation: dh_frame.point(&up) };
            dh_frame = self.dh_frame(i);
            bodies.push(Body {
                name: (*link).into(),
                parent: i.checked_sub(1),
                joint: self.joint(i, placement),
                inertia: self.inertia_in_dh_frame(i).seen_from(&dh_frame),
            });
        }
        let gravity = Vector3::new(0.0, 0.0, -crate::robot::GRAVITY);
        Robot { name: self.name.into(), bodies, gravity, flange: dh_frame, flange_on: None }
    }

    /// Trans_x(a_i) Rot_x(alpha_i).
    fn dh_frame(&self, i: usize) -> Placement {
        let (s, c) = sin_cos(self.alpha[i]);
        Placement {
            rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
            translation: Vector3::new(self.a[i], 0.0, 0.0),
        }
    }

    fn joint(&self, i: usize, placement: Placement) -> Joint {
        let limits = Limits {
            lower: -self.range[i],
            upper: self.range[i],
            velocity: self.velocity[i],
            effort: self.effort[i],
        };
        Joint { name: JOINTS[i].into(), placement, axis: Vector3::z_axis(), limits }
    }

    fn inertia_in_dh_frame(&self, i: usize) -> Inertia {
        let [xx, xy, yy, xz, yz, zz] = self.inertia[i];
        Inertia {
            mass: self.mass[i],
            com: self.com[i].into(),
            about_com: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        }
    }
}

/// Exact where tables have right angles, so that frames do not carry 6e-17 about.
fn sin_cos(alpha: f64) -> (f64, f64) {
    if alpha.abs() == RIGHT { (alpha.signum(), 0.0) } else { alpha.sin_cos() }
}

const RIGHT: f64 = std::f64::consts::FRAC_PI_2;
const TURN: f64 = std::f64::consts::TAU;

/// Degrees per second.
const fn deg(x: f64) -> f64 {
    x * std::f64::consts::PI / 180.0
}

/// A tensor without products of inertia.
const fn diagonal(xx: f64, yy: f64, zz: f64) -> [f64; 6] {
    [xx, 0.0, yy, 0.0, 0.0, zz]
}
