//! Scratch memory of the recursive algorithms, so that hot loops do not allocate.

use nalgebra::{Matrix3, Vector3};

use crate::robot::spatial::{Force, Motion, Transform};
use crate::robot::{Inertia, Robot};

/// Holds nothing between calls; make one per thread. Fits every robot of the same size.
#[derive(Debug, Clone)]
pub struct Workspace {
    /// From the parent's to the body's coordinates, per body.
    pub(super) x: Vec<Transform>,
    pub(super) v: Vec<Motion>,
    pub(super) a: Vec<Motion>,
    pub(super) f: Vec<Force>,
    pub(super) i: Vec<Articulated>,
    /// Each body with all that it carries.
    pub(super) carried: Vec<Composite>,
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

/// Bodies that move as one, about their frame's origin: half the numbers of [`Articulated`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Composite {
    /// kg
    mass: f64,
    /// m c, kg.m
    moments: Vector3<f64>,
    /// kg.m2
    rotational: Matrix3<f64>,
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
            carried: vec![Composite::of(&Inertia::zero()); n],
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
    pub fn rigid(inertia: &Inertia) -> Self {
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

impl Composite {
    pub fn of(inertia: &Inertia) -> Self {
        let moments = inertia.com * inertia.mass;
        Self { mass: inertia.mass, moments, rotational: inertia.about_origin() }
    }

    /// What turns it about an axis through the origin with 1 rad/s2.
    #[inline]
    pub fn turned_about(&self, axis: &Vector3<f64>) -> Force {
        Force { moment: self.rotational * axis, force: axis.cross(&self.moments) }
    }

    /// X^T I X: the same bodies in the parent's coordinates, h' = E^T h + m r and, by the parallel axis theorem,
    /// I' = E^T I E + r.(E^T h + h') 1 - r h'^T - E^T h r^T.
    #[inline]
    pub fn in_parent(&self, x: &Transform) -> Self {
        let turned = x.e.tr_mul(&self.moments);
        let moments = turned + x.r * self.mass;
        let mut rotational = x.e.tr_mul(&self.rotational) * x.e;
        rotational -= x.r * moments.transpose() + turned * x.r.transpose();
        let along = x.r.dot(&(turned + moments));
        (0..3).for_each(|i| rotational[(i, i)] += along);
        Self { mass: self.mass, moments, rotational }
    }

    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.moments += other.moments;
        self.rotational += other.rotational;
    }
}

/// r x M, column by column.
#[inline]
fn cross_columns(r: &Vector3<f64>, m: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[r.cross(&m.column(0)), r.cross(&m.column(1)), r.cross(&m.column(2))])
}
