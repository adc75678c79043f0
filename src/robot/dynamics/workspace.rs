//! Scratch memory of the recursive algorithms, so that hot loops do not allocate.

use nalgebra::{Matrix3, Vector3};

use crate::robot::Robot;
use crate::robot::spatial::{Force, Motion, Transform};

/// Holds nothing between calls; make one per thread. Fits every robot of the same size.
#[derive(Debug, Clone)]
pub struct Workspace {
    /// From the parent's to the body's coordinates, per body.
    pub(super) x: Vec<Transform>,
    pub(super) v: Vec<Motion>,
    pub(super) a: Vec<Motion>,
    pub(super) f: Vec<Force>,
    pub(super) i: Vec<Articulated>,
    /// U = I^A S.
    pub(super) u_force: Vec<Force>,
    /// D = S^T U.
    pub(super) d: Vec<f64>,
    /// u = tau - S^T p^A.
    pub(super) u: Vec<f64>,
}

/// A 6 x 6 symmetric inertia in 3 x 3 blocks [rotational, coupling; coupling^T, translational].
#[derive(Debug, Clone, Copy)]
pub(super) struct Articulated {
    pub rotational: Matrix3<f64>,
    pub coupling: Matrix3<f64>,
    pub translational: Matrix3<f64>,
}

impl Workspace {
    pub fn new(robot: &Robot) -> Self {
        let n = robot.dof();
        Self {
            x: vec![Transform::identity(); n],
            v: vec![Motion::zero(); n],
            a: vec![Motion::zero(); n],
            f: vec![Force::zero(); n],
            i: vec![Articulated::zero(); n],
            u_force: vec![Force::zero(); n],
            d: vec![0.0; n],
            u: vec![0.0; n],
        }
    }
}

impl Articulated {
    fn zero() -> Self {
        let o = Matrix3::zeros();
        Self { rotational: o, coupling: o, translational: o }
    }

    /// A rigid body's inertia about its frame's origin (eq. 2.63).
    pub fn rigid(inertia: &crate::robot::Inertia) -> Self {
        Self {
            rotational: inertia.about_origin(),
            coupling: (inertia.com * inertia.mass).cross_matrix(),
            translational: Matrix3::identity() * inertia.mass,
        }
    }

    #[inline]
    pub fn apply(&self, m: &Motion) -> Force {
        Force {
            moment: self.rotational * m.angular + self.coupling * m.linear,
            force: self.coupling.tr_mul(&m.angular) + self.translational * m.linear,
        }
    }

    /// I - U U^T / D (eq. 7.25): what is left when the joint with axis U gives way.
    #[inline]
    pub fn released(&self, u: &Force, d: f64) -> Self {
        let scaled = *u * (1.0 / d);
        Self {
            rotational: self.rotational - scaled.moment * u.moment.transpose(),
            coupling: self.coupling - scaled.moment * u.force.transpose(),
            translational: self.translational - scaled.force * u.force.transpose(),
        }
    }

    /// X^T I X: the same inertia in the parent's coordinates.
    #[inline]
    pub fn in_parent(&self, x: &Transform) -> Self {
        let turn = |m: &Matrix3<f64>| x.e.tr_mul(m) * x.e;
        let translational = turn(&self.translational);
        let h = turn(&self.coupling);
        let coupling = h + cross_columns(&x.r, &translational);
        let moved = cross_columns(&x.r, &h.transpose());
        let rotational =
            turn(&self.rotational) + moved + cross_columns(&x.r, &coupling.transpose()).transpose();
        Self { rotational, coupling, translational }
    }

    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.rotational += other.rotational;
        self.coupling += other.coupling;
        self.translational += other.translational;
    }
}

/// r x M, column by column.
#[inline]
fn cross_columns(r: &Vector3<f64>, m: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[r.cross(&m.column(0)), r.cross(&m.column(1)), r.cross(&m.column(2))])
}
