//! Spatial (6D) vectors and Plücker transforms, Featherstone, *Rigid Body Dynamics Algorithms*,
//! 2008, chapter 2: the angular part comes first, motion and force vectors are different types.

use std::ops::{Add, AddAssign, Mul, Sub};

use nalgebra::{Matrix3, Vector3};

use super::model::{Inertia, Joint};

/// A velocity or acceleration: angular part, and linear part of the frame's origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    pub angular: Vector3<f64>,
    pub linear: Vector3<f64>,
}

/// A wrench: moment about the frame's origin, and force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    pub moment: Vector3<f64>,
    pub force: Vector3<f64>,
}

/// Plücker transform from a parent's to a child's coordinates, X = rot(E) xlt(r) (eq. 2.24):
/// `e` turns parent into child coordinates, `r` is the child's origin in the parent's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    pub e: Matrix3<f64>,
    pub r: Vector3<f64>,
}

impl Motion {
    pub fn zero() -> Self {
        Self { angular: Vector3::zeros(), linear: Vector3::zeros() }
    }

    /// S of a revolute joint about `axis` through the origin, times a rate.
    #[inline]
    pub fn rotation(axis: &Vector3<f64>, rate: f64) -> Self {
        Self { angular: axis * rate, linear: Vector3::zeros() }
    }

    /// v x m (eq. 2.31).
    #[inline]
    pub fn cross(&self, m: &Self) -> Self {
        Self {
            angular: self.angular.cross(&m.angular),
            linear: self.angular.cross(&m.linear) + self.linear.cross(&m.angular),
        }
    }

    /// v x* f (eq. 2.32).
    #[inline]
    pub fn cross_force(&self, f: &Force) -> Force {
        Force {
            moment: self.angular.cross(&f.moment) + self.linear.cross(&f.force),
            force: self.angular.cross(&f.force),
        }
    }

    /// Power of `f` when this is a velocity.
    #[inline]
    pub fn dot(&self, f: &Force) -> f64 {
        self.angular.dot(&f.moment) + self.linear.dot(&f.force)
    }
}

impl Force {
    pub fn zero() -> Self {
        Self { moment: Vector3::zeros(), force: Vector3::zeros() }
    }
}

impl Transform {
    pub fn identity() -> Self {
        Self { e: Matrix3::identity(), r: Vector3::zeros() }
    }

    /// X_J X_T: from the parent body's to the body's coordinates at joint angle `q`.
    #[inline]
    pub fn of_joint(joint: &Joint, q: f64) -> Self {
        let e = turn_back(&joint.axis, q) * joint.placement.rotation.transpose();
        Self { e, r: joint.placement.translation }
    }

    /// X m.
    #[inline]
    pub fn motion(&self, m: &Motion) -> Motion {
        Motion {
            angular: self.e * m.angular,
            linear: self.e * (m.linear - self.r.cross(&m.angular)),
        }
    }

    /// X^T f: from the child's to the parent's coordinates.
    #[inline]
    pub fn transpose_force(&self, f: &Force) -> Force {
        let force = self.e.tr_mul(&f.force);
        Force { moment: self.e.tr_mul(&f.moment) + self.r.cross(&force), force }
    }
}

/// Rot(axis, -q), by Rodrigues' formula.
#[inline]
fn turn_back(axis: &Vector3<f64>, q: f64) -> Matrix3<f64> {
    let (s, c) = q.sin_cos();
    let a = axis * (1.0 - c);
    let b = axis * s;
    Matrix3::new(
        a.x * axis.x + c,
        a.x * axis.y + b.z,
        a.x * axis.z - b.y,
        a.y * axis.x - b.z,
        a.y * axis.y + c,
        a.y * axis.z + b.x,
        a.z * axis.x + b.y,
        a.z * axis.y - b.x,
        a.z * axis.z + c,
    )
}

impl Inertia {
    /// I m (eq. 2.63), with the moment about the body's origin: for an acceleration a force, for
    /// a velocity a momentum.
    #[inline]
    pub fn apply(&self, m: &Motion) -> Force {
        let force = (m.linear + m.angular.cross(&self.com)) * self.mass;
        Force { moment: self.about_com * m.angular + self.com.cross(&force), force }
    }

    /// I a + v x* I v: the force that makes the body move so (eq. 5.9).
    #[inline]
    pub fn force(&self, v: &Motion, a: &Motion) -> Force {
        self.apply(a) + v.cross_force(&self.apply(v))
    }
}

impl Add for Motion {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { angular: self.angular + o.angular, linear: self.linear + o.linear }
    }
}

impl Sub for Motion {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self { angular: self.angular - o.angular, linear: self.linear - o.linear }
    }
}

impl Mul<f64> for Motion {
    type Output = Self;
    #[inline]
    fn mul(self, s: f64) -> Self {
        Self { angular: self.angular * s, linear: self.linear * s }
    }
}

impl Add for Force {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self { moment: self.moment + o.moment, force: self.force + o.force }
    }
}

impl AddAssign for Force {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        self.moment += o.moment;
        self.force += o.force;
    }
}

impl Mul<f64> for Force {
    type Output = Self;
    #[inline]
    fn mul(self, s: f64) -> Self {
        Self { moment: self.moment * s, force: self.force * s }
    }
}
