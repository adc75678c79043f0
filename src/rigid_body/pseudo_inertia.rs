//! A link as a density of mass: its pseudo-inertia
//!
//! P = [[S, h], [h^T, m]], S = tr(I)/2 1 - I, h = m c,
//!
//! is positive definite where and only where some distribution of mass has these parameters (Wensing,
//! Kim, Slotine, *IEEE Robotics and Automation Letters* 3(1), 2018). It is linear in them.

use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3};

use super::parameters::PER_LINK;
use crate::robot::{Inertia, Robot};

type Parameters = [f64; PER_LINK];

/// Least eigenvalue of a link's spread of mass, relative to their mean, where a model gives none.
const LEAST_SPREAD: f64 = 1e-3;

/// P of [m, h, I].
pub fn matrix(p: &Parameters) -> Matrix4<f64> {
    let inertia = Matrix3::new(p[4], p[5], p[7], p[5], p[6], p[8], p[7], p[8], p[9]);
    let spread = Matrix3::identity() * (inertia.trace() / 2.0) - inertia;
    let mut all = Matrix4::zeros();
    all.fixed_view_mut::<3, 3>(0, 0).copy_from(&spread);
    all.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::new(p[1], p[2], p[3]));
    all.fixed_view_mut::<1, 3>(3, 0).copy_from(&Vector3::new(p[1], p[2], p[3]).transpose());
    all[(3, 3)] = p[0];
    all
}

/// The inverse of [`matrix`].
pub fn parameters(p: &Matrix4<f64>) -> Parameters {
    let spread: Matrix3<f64> = p.fixed_view::<3, 3>(0, 0).into_owned();
    let i = Matrix3::identity() * spread.trace() - spread;
    [p.m44, p.m14, p.m24, p.m34, i.m11, i.m12, i.m22, i.m13, i.m23, i.m33]
}

/// Is there a body with this mass, centre and inertia?
pub fn is_possible(inertia: &Inertia) -> bool {
    matrix(&inertia.parameters()).cholesky().is_some()
}

/// This link with an inertia that a body of its mass can have: eigenvalues of its spread of mass about
/// the centre that are too small are raised.
pub fn made_possible(inertia: &Inertia) -> Inertia {
    if is_possible(inertia) {
        return *inertia;
    }
    let i = inertia.about_com;
    let spread = (Matrix3::identity() * (i.trace() / 2.0) - i).symmetric_eigen();
    let mean =
        (spread.eigenvalues.iter().map(|v| v.abs()).sum::<f64>() / 3.0).max(f64::MIN_POSITIVE);
    let raised = spread.eigenvalues.map(|v| v.max(LEAST_SPREAD * mean));
    let turn = spread.eigenvectors;
    let spread = turn * Matrix3::from_diagonal(&raised) * turn.transpose();
    Inertia { about_com: Matrix3::identity() * spread.trace() - spread, ..*inertia }
}

/// The robot with links that bodies can have, and which of its bodies (from 0) were not.
pub fn possible(robot: &Robot) -> (Robot, Vec<usize>) {
    let mut all = robot.clone();
    let bodies = all.bodies.iter_mut().enumerate();
    let wrong = bodies.filter(|(_, b)| !is_possible(&b.inertia)).map(|(i, body)| {
        body.inertia = made_possible(&body.inertia);
        i
    });
    let wrong = wrong.collect();
    (all, wrong)
}

/// Coordinates in which the model's own link is the identity: P = L X L^T with L L^T the model's P.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Matrix from coordinates to parameters.
    pub to_parameters: SMatrix<f64, PER_LINK, PER_LINK>,
}

impl Frame {
    /// `None` where the model's link is impossible.
    pub fn of(model: &Inertia) -> Option<Self> {
        let l = matrix(&model.parameters()).cholesky()?.l();
        let unit = |a: usize| {
            let mut one = [0.0; PER_LINK];
            one[a] = 1.0;
            SVector::<f64, PER_LINK>::from(parameters(&(l * matrix(&one) * l.transpose())))
        };
        let columns: [_; PER_LINK] = std::array::from_fn(unit);
        Some(Self { to_parameters: SMatrix::from_columns(&columns) })
    }

    /// Coordinates of the model itself.
    pub fn origin() -> Parameters {
        parameters(&Matrix4::identity())
    }
}

/// tr X - log det X with gradient and Hessian in X's coordinates; `None` where X is not positive
/// definite. Times g it is g times the divergence of Lee, Wensing, Park, *IEEE Trans. Robotics* 36(1),
/// 2020, from the model, which does not depend on frames or units.
pub fn divergence(
    x: &Parameters,
) -> Option<(f64, SVector<f64, PER_LINK>, SMatrix<f64, PER_LINK, PER_LINK>)> {
    let matrix_x = matrix(x);
    let cholesky = matrix_x.cholesky()?;
    let log_det: f64 = 2.0 * cholesky.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
    let inverse = cholesky.inverse();
    let unit = |a: usize| {
        let mut one = [0.0; PER_LINK];
        one[a] = 1.0;
        matrix(&one)
    };
    let units: [Matrix4<f64>; PER_LINK] = std::array::from_fn(unit);
    let seen = units.map(|e| inverse * e);
    let gradient = SVector::from_fn(|a, _| units[a].trace() - seen[a].trace());
    let hessian = SMatrix::from_fn(|a, b| (seen[a] * seen[b]).trace());
    Some((matrix_x.trace() - log_det, gradient, hessian))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::builtin;

    /// A rod: its moment about its own axis cannot be more than the sum of the other two.
    #[test]
    fn the_triangle_inequality_decides() {
        let rod = |x: f64| Inertia {
            mass: 1.0,
            com: Vector3::new(0.1, 0.0, 0.2),
            about_com: Matrix3::from_diagonal(&Vector3::new(x, 0.02, 0.02)),
        };
        assert!(is_possible(&rod(0.039)) && !is_possible(&rod(0.041)));
        let mended = made_possible(&rod(0.041));
        assert!(is_possible(&mended) && (mended.about_com.m11 - 0.041).abs() < 2e-3);
        assert_eq!(made_possible(&rod(0.039)), rod(0.039));
    }

    #[test]
    fn parameters_and_matrix_are_one() {
        let p = builtin("ur5").unwrap().bodies[2].inertia.parameters();
        let back = parameters(&matrix(&p));
        p.iter().zip(back).for_each(|(a, b)| assert!((a - b).abs() < 1e-14));
    }

    #[test]
    fn the_model_is_the_origin_of_its_frame_and_least_divergent() {
        let model = builtin("ur5").unwrap().bodies[1].inertia;
        let frame = Frame::of(&model).unwrap();
        let p = frame.to_parameters * SVector::from(Frame::origin());
        p.iter().zip(model.parameters()).for_each(|(a, b)| assert!((a - b).abs() < 1e-12));
        let (value, gradient, _) = divergence(&Frame::origin()).unwrap();
        assert!((value - 4.0).abs() < 1e-14 && gradient.amax() < 1e-14);
    }

    /// Gradient and Hessian against differences.
    #[test]
    fn slopes_are_those_of_the_divergence() {
        let x = [1.3, 0.1, -0.2, 0.05, 2.2, 0.1, 1.9, -0.1, 0.2, 2.4];
        let (_, gradient, hessian) = divergence(&x).unwrap();
        let moved = |a: usize, by: f64| {
            let mut y = x;
            y[a] += by;
            divergence(&y).unwrap()
        };
        for a in 0..PER_LINK {
            let (more, less) = (moved(a, 1e-5), moved(a, -1e-5));
            assert!(((more.0 - less.0) / 2e-5 - gradient[a]).abs() < 1e-8);
            let bend = (more.1 - less.1) / 2e-5;
            assert!((bend - hessian.column(a)).amax() < 1e-7);
        }
    }
}
