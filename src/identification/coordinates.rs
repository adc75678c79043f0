//! Coordinates in which a joint's posterior is nearly standard normal.
//!
//! Given w_s, the other parameters are Gaussian (cut by the bounds). With the decomposition of
//! [`super::quadratic`], R b + h T_e = c and sqrt(v) T_e = u / sqrt(v) up to noise, so with
//!
//! T_e = u / v' + sigma z_e / sqrt(v'),  v' = v + (sigma / span)^2
//! b = R'^-1 (c' - h' T_e + sigma z),  R'^T R' = R^T R + (sigma / span)^2
//!
//! (z_e, z) is about N(0, 1) whatever w_s is: a chain walks along ln w_s without dragging the
//! others behind. The primes keep the map invertible where data say nothing; it need not be exact,
//! its volume d x / d (ln w_s, z) = w_s / sqrt(v') (times a constant) is.

use nalgebra::{DMatrix, DVector};

use super::quadratic::QuadraticCost;
use crate::regression::bounds::Bounds;

pub struct Coordinates<'a> {
    cost: &'a QuadraticCost,
    bounds: &'a Bounds,
    sigma: f64,
    curved: bool,
    /// R', upper triangular.
    root: DMatrix<f64>,
    /// R'^-T R^T: c' = turn c, h' = turn h.
    turn: DMatrix<f64>,
    c: DVector<f64>,
}

/// What depends on w_s.
struct Bend {
    /// h'
    h: DVector<f64>,
    /// u / v'
    excess: f64,
    /// sigma / sqrt(v')
    spread: f64,
}

impl<'a> Coordinates<'a> {
    /// `sigma`: noise level, N.m; `bounds` those of `cost`. `None` if R is not finite.
    pub fn new(cost: &'a QuadraticCost, bounds: &'a Bounds, sigma: f64) -> Option<Self> {
        let (r, c) = cost.fixed();
        let curved = bounds.len() > c.len();
        let span = |k: usize| bounds.span(if curved && k > 0 { k + 1 } else { k });
        let prior = DMatrix::from_fn(c.len(), c.len(), |i, j| match i == j {
            true => (sigma / span(i)).powi(2),
            false => 0.0,
        });
        let root = (r.transpose() * r + prior).cholesky()?.l().transpose();
        let turn = root.transpose().solve_lower_triangular(&r.transpose())?;
        Some(Self { cost, bounds, sigma, curved, c: &turn * c, root, turn })
    }

    fn bend(&self, velocity: f64) -> Option<Bend> {
        let n = self.c.len();
        self.cost.bend(velocity, |f| {
            let v = f[n + 1] + (self.sigma / self.bounds.span(1)).powi(2);
            Bend {
                h: &self.turn * DVector::from_column_slice(&f[..n]),
                excess: f[n] / v,
                spread: self.sigma / v.sqrt(),
            }
        })
    }

    /// From `[ln w_s, z_e, z ..]` (`[z ..]` without a curve) to the problem's parameters, and the
    /// logarithm of the volume.
    pub fn parameters(&self, u: &[f64]) -> (Vec<f64>, f64) {
        let z = DVector::from_column_slice(&u[if self.curved { 2 } else { 0 }..]);
        let right = &self.c + z * self.sigma;
        let velocity = if self.curved { u[0].exp() } else { 0.0 };
        let Some(bend) = self.bend(velocity) else { return (self.solve(&right), 0.0) };
        let excess = bend.excess + bend.spread * u[1];
        let mut x = self.solve(&(right - bend.h * excess));
        x.insert(1, x[0] + excess);
        x.push(velocity);
        (x, u[0] + bend.spread.ln())
    }

    /// The inverse.
    pub fn of(&self, x: &[f64]) -> Vec<f64> {
        let velocity = x[x.len() - 1];
        let Some(bend) = self.bend(velocity) else {
            let z = (&self.root * DVector::from_column_slice(x) - &self.c) / self.sigma;
            return z.as_slice().to_vec();
        };
        let excess = x[1] - x[0];
        let b = DVector::from_iterator(
            self.c.len(),
            std::iter::once(x[0]).chain(x[2..x.len() - 1].iter().copied()),
        );
        let z = (&self.root * b - &self.c + bend.h * excess) / self.sigma;
        let mut u = vec![velocity.ln(), (excess - bend.excess) / bend.spread];
        u.extend(z.iter());
        u
    }

    /// R' b = right
    fn solve(&self, right: &DVector<f64>) -> Vec<f64> {
        let mut b = right.clone();
        self.root.solve_upper_triangular_mut(&mut b);
        b.as_slice().to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::testing;

    #[test]
    fn the_map_is_inverted_and_its_volume_is_the_jacobians_determinant() {
        let problem = testing::problem(800, 0.3, true);
        let bounds = problem.bounds().unwrap();
        let cost = QuadraticCost::new(&problem, &bounds);
        let coordinates = Coordinates::new(&cost, &bounds, 0.3).unwrap();
        let ln_determinant = |u: &[f64]| {
            let column = |k: usize, step: f64| {
                let mut moved = u.to_vec();
                moved[k] += step;
                DVector::from_vec(coordinates.parameters(&moved).0)
            };
            let slopes: Vec<_> =
                (0..u.len()).map(|k| (column(k, 1e-4) - column(k, -1e-4)) / 2e-4).collect();
            DMatrix::from_columns(&slopes).determinant().abs().ln()
        };
        let points = [testing::TRUTH.to_vec(), vec![2.0, 9.0, 3.0, 0.5, -0.7, 0.3]];
        let [a, b] = points.map(|x| {
            let u = coordinates.of(&x);
            let (back, ln_volume) = coordinates.parameters(&u);
            back.iter().zip(&x).for_each(|(b, x)| assert!((b - x).abs() < 1e-10, "{b} {x}"));
            ln_determinant(&u) - ln_volume
        });
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
}
