//! The cost of the paper's law in a hundred nanoseconds, whatever the number of samples.
//!
//! With F = [s, columns ..] = Q R and the Stribeck column g(w_s), T_e = T_s - T_c,
//!
//! SSE = |R b + h T_e - Q'y|^2 + v T_e^2 - 2 u T_e + |y_|^2,
//! h = Q'g,  g_ = g - Q h,  v = g_'g_,  u = g_'y_,  y_ = y - Q Q'y
//!
//! where b holds T_c and the other linear parameters. Everything that sums over samples is
//! constant or a smooth function of w_s alone (h, u and v), so it is summed once, at Chebyshev
//! nodes in ln w_s, and interpolated to machine precision. Centring on the residual y_ keeps the large
//! sums y'y and F'F, which nearly cancel, out of the result.
//!
//! exp(-|w| / w_s) is analytic in ln w_s and bounded within pi/2 of the real axis, and so are sums
//! of products of two of them: that tells how many nodes are enough.

use nalgebra::{DMatrix, DVector};

use super::chebyshev;
use super::problem::{Curve, JointProblem};
use super::tables::Tables;
use crate::kernels::{axpy, dot, dots, dots_of_rest};
use crate::regression::bounds::Bounds;
use crate::regression::qr::{Qr, back_substitute, project_out};

/// Accuracy of the interpolants relative to the largest value.
const ACCURACY: f64 = 1e-16;

#[derive(Debug, Clone)]
pub struct QuadraticCost {
    samples: usize,
    /// R of the fixed columns, and Q'y.
    r: DMatrix<f64>,
    c: DVector<f64>,
    /// R row after row (the diagonal and what is right of it) for the hot loop.
    rows: Vec<f64>,
    /// |y_|^2
    left: f64,
    /// h, u and v over w_s, where there is a curve.
    tables: Option<Tables>,
    bounds: Bounds,
}

/// What bounded least squares over the linear parameters finds at one w_s.
#[derive(Debug, Clone)]
pub struct Profile {
    /// SSE
    pub sum_of_squares: f64,
    /// All parameters, in the order of the problem.
    pub x: Vec<f64>,
}

impl QuadraticCost {
    /// `bounds` are the problem's own.
    pub fn new(problem: &JointProblem, bounds: &Bounds) -> Self {
        let sign = problem.curve.iter().map(|c| c.sign.clone());
        let fixed = sign.chain(problem.columns.iter().map(|c| c.values.clone())).collect();
        let qr = Qr::new(fixed);
        let mut left = problem.y.clone();
        let c = DVector::from_vec(project_out(&qr.q, &mut left));
        let tables = problem.curve.as_ref().map(|curve| tabulate(curve, &qr, &left));
        let n = qr.r.nrows();
        let rows = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).map(|ij| qr.r[ij]).collect();
        let left = dot(&left, &left);
        Self { samples: problem.samples(), r: qr.r, c, rows, left, tables, bounds: bounds.clone() }
    }

    /// R of the fixed columns and Q'y.
    pub fn fixed(&self) -> (&DMatrix<f64>, &DVector<f64>) {
        (&self.r, &self.c)
    }

    /// Calls `use_values` with `[h .., u, v]` at a w_s; `None` without a curve.
    pub fn bend<T>(&self, velocity: f64, use_values: impl FnOnce(&[f64]) -> T) -> Option<T> {
        self.tables.as_ref().map(|t| t.with(velocity, use_values))
    }

    /// J = sqrt(SSE / n), N.m (the paper's Eq. 5).
    pub fn rms(&self, x: &[f64]) -> f64 {
        (self.sum_of_squares(x).max(0.0) / self.samples.max(1) as f64).sqrt()
    }

    /// SSE
    pub fn sum_of_squares(&self, x: &[f64]) -> f64 {
        let n = self.c.len();
        let Some(tables) = &self.tables else { return self.left + self.explained(x, None) };
        let (excess, velocity) = (x[1] - x[0], x[n + 1]);
        tables.with(velocity, |f| {
            let (u, v) = (f[n], f[n + 1]);
            let bend = (v * excess - 2.0 * u) * excess;
            self.left + bend + self.explained(x, Some((excess, f)))
        })
    }

    /// |R b + h T_e - Q'y|^2
    fn explained(&self, x: &[f64], bend: Option<(f64, &[f64])>) -> f64 {
        let n = self.c.len();
        let shift = usize::from(bend.is_some());
        let b = |k: usize| if k == 0 { x[0] } else { x[k + shift] };
        let (excess, h) = bend.unwrap_or((0.0, &[]));
        let mut rows = self.rows.as_slice();
        let mut sum = 0.0;
        for (i, &c) in self.c.iter().enumerate() {
            let (row, rest) = rows.split_at(n - i);
            rows = rest;
            let mut e = h.get(i).map_or(0.0, |h| h * excess) - c;
            for (k, r) in row.iter().enumerate() {
                e += r * b(i + k);
            }
            sum += e * e;
        }
        sum
    }

    /// The best linear parameters within bounds at a given w_s (ignored without a curve).
    pub fn profile(&self, velocity: f64) -> Profile {
        let f = self.tables.as_ref().map(|t| t.with(velocity, <[f64]>::to_vec));
        let free = self.unbounded(f.as_deref());
        let x = if self.inside(&free) { free } else { self.bounded(f.as_deref()) };
        let x = self.with_velocity(x, velocity);
        Profile { sum_of_squares: self.sum_of_squares(&x), x }
    }

    fn with_velocity(&self, mut linear: Vec<f64>, velocity: f64) -> Vec<f64> {
        linear.extend(self.tables.as_ref().map(|_| velocity));
        linear
    }

    fn inside(&self, linear: &[f64]) -> bool {
        linear.iter().enumerate().all(|(i, &x)| self.bounds.clamp(i, x) == x)
    }

    /// Solution without bounds: T_e = u / v, R b = Q'y - h T_e
    fn unbounded(&self, f: Option<&[f64]>) -> Vec<f64> {
        let n = self.c.len();
        let mut b = self.c.as_slice().to_vec();
        let Some(f) = f else {
            back_substitute(&self.r, &mut b);
            return b;
        };
        let excess = if self.bends(f) { f[n] / f[n + 1] } else { 0.0 };
        b.iter_mut().zip(f).for_each(|(b, h)| *b -= h * excess);
        back_substitute(&self.r, &mut b);
        b.insert(1, b[0] + excess);
        b
    }

    /// Is there anything of the Stribeck column that the others do not hold?
    fn bends(&self, f: &[f64]) -> bool {
        let n = self.c.len();
        let in_others: f64 = f[..n].iter().map(|h| h * h).sum();
        f[n + 1] > 1e-14 * in_others && f[n + 1] > 0.0
    }

    /// Solution in the box, in the paper's own parameters: T_c multiplies s - g, T_s multiplies g.
    fn bounded(&self, f: Option<&[f64]>) -> Vec<f64> {
        let n = self.c.len();
        let Some(f) = f else {
            return self.solve_in_box(&self.r, &self.c);
        };
        let v = if self.bends(f) { f[n + 1].sqrt() } else { 0.0 };
        let mut a = DMatrix::zeros(n + 1, n + 1);
        let mut y = DVector::zeros(n + 1);
        y.rows_mut(0, n).copy_from(&self.c);
        y[n] = if v > 0.0 { f[n] / v } else { 0.0 };
        let g = DVector::from_fn(n + 1, |i, _| if i < n { f[i] } else { v });
        a.view_mut((0, 0), (n, 1)).copy_from(&self.r.column(0));
        let sliding = a.column(0) - &g;
        a.set_column(0, &sliding);
        a.set_column(1, &g);
        a.view_mut((0, 2), (n, n - 1)).copy_from(&self.r.columns(1, n - 1));
        self.solve_in_box(&a, &y)
    }

    fn solve_in_box(&self, a: &DMatrix<f64>, y: &DVector<f64>) -> Vec<f64> {
        let n = a.ncols();
        let part = |at: fn(&Bounds, usize) -> f64| (0..n).map(|i| at(&self.bounds, i)).collect();
        match Bounds::new(part(Bounds::lower), part(Bounds::upper)) {
            Ok(bounds) => crate::regression::bounded::solve(a, y, &bounds).as_slice().to_vec(),
            Err(_) => unreachable!("part of bounds that were checked when made"),
        }
    }
}

/// h, u and v at Chebyshev nodes in ln w_s, then tables of them.
fn tabulate(curve: &Curve, qr: &Qr, left: &[f64]) -> Tables {
    let (low, high) = Tables::covered(curve.velocity.lower, curve.velocity.upper);
    let (middle, half) = (0.5 * (high * low).ln(), 0.5 * (high / low).ln());
    let count = chebyshev::nodes_needed(std::f64::consts::FRAC_PI_2, half, ACCURACY);
    let nodes = chebyshev::nodes(count);
    let velocities: Vec<f64> = nodes.iter().map(|node| (middle + half * node).exp()).collect();
    let at_nodes = sums(curve, qr, left, &velocities);
    let lagrange = chebyshev::Lagrange::new(count);
    let functions = qr.q.len() + 2;
    Tables::new(low, high, functions, |velocity| {
        let mut values = vec![0.0; functions];
        let weights = lagrange.at((velocity.ln() - middle) / half);
        weights.iter().zip(&at_nodes).for_each(|(w, node)| axpy(*w, node, &mut values));
        values[functions - 1] = values[functions - 1].max(0.0);
        values
    })
}

/// Stribeck columns made at once: as many as filters run on side by side.
const TOGETHER: usize = 8;

/// `[h .., u, v]` at each of the velocities.
fn sums(curve: &Curve, qr: &Qr, left: &[f64], velocities: &[f64]) -> Vec<Vec<f64>> {
    let q: Vec<&[f64]> = qr.q.iter().map(Vec::as_slice).collect();
    let of_column = |g: &Vec<f64>| {
        let mut values = dots(g, &q);
        values.extend(dots_of_rest(g, &q, &values, left));
        values
    };
    let groups = velocities.chunks(TOGETHER).map(|some| curve.columns(some));
    groups.flat_map(|columns| columns.iter().map(of_column).collect::<Vec<_>>()).collect()
}

#[cfg(test)]
#[path = "quadratic_tests.rs"]
mod tests;
