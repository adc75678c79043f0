//! Thin QR of a few long columns.
//!
//! Modified Gram-Schmidt, every column orthogonalised twice ("twice is enough": Giraud, Langou,
//! Rozloznik, *Computers and Mathematics with Applications* 50, 2005), so Q is orthonormal to
//! rounding even where columns are nearly dependent.

use nalgebra::{DMatrix, DVector};

use crate::kernels::{axpy, dot};

/// A = Q R. Where column k depends on those before it, `q[k]` is zero and so is `r[(k, k)]`.
#[derive(Debug, Clone)]
pub struct Qr {
    /// Orthonormal columns.
    pub q: Vec<Vec<f64>>,
    /// Upper triangular.
    pub r: DMatrix<f64>,
}

/// What is left of a column, relative to its length, when it counts as dependent.
const DEPENDENT: f64 = 1e-11;

impl Qr {
    pub fn new(columns: Vec<Vec<f64>>) -> Self {
        Self::within(columns, DEPENDENT)
    }

    /// Decomposes columns; one of which no more than the share `dependent` is left counts as dependent.
    pub fn within(columns: Vec<Vec<f64>>, dependent: f64) -> Self {
        let n = columns.len();
        let mut q = columns;
        let mut r = DMatrix::zeros(n, n);
        for k in 0..n {
            let (before, rest) = q.split_at_mut(k);
            let column = &mut rest[0];
            let length = dot(column, column).sqrt();
            let h = project_out(before, column);
            r.view_mut((0, k), (k, 1)).copy_from_slice(&h);
            let left = dot(column, column).sqrt();
            let independent = left > dependent * length;
            r[(k, k)] = if independent { left } else { 0.0 };
            let scale = if independent { 1.0 / left } else { 0.0 };
            column.iter_mut().for_each(|c| *c *= scale);
        }
        Self { q, r }
    }

    /// Q' y
    pub fn transpose_times(&self, y: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.q.len(), self.q.iter().map(|q| dot(q, y)))
    }

    /// Are all columns independent?
    pub fn full_rank(&self) -> bool {
        self.r.diagonal().iter().all(|&d| d != 0.0)
    }

    /// Least-squares solution of R x = c; components of dependent columns are zero.
    pub fn solve(&self, c: &DVector<f64>) -> DVector<f64> {
        let mut x = c.clone();
        back_substitute(&self.r, x.as_mut_slice());
        x
    }
}

/// Removes what `orthonormal` columns explain of `column`, twice, and returns the coefficients.
pub fn project_out(orthonormal: &[Vec<f64>], column: &mut [f64]) -> Vec<f64> {
    let mut h = vec![0.0; orthonormal.len()];
    for _ in 0..2 {
        for (h, q) in h.iter_mut().zip(orthonormal) {
            let part = dot(q, column);
            axpy(-part, q, column);
            *h += part;
        }
    }
    h
}

/// What `orthonormal` columns do not explain of `column`.
pub fn unexplained(orthonormal: &[Vec<f64>], mut column: Vec<f64>) -> Vec<f64> {
    project_out(orthonormal, &mut column);
    column
}

/// Solves the upper triangular R x = c in place; x_k = 0 where R_kk = 0.
pub fn back_substitute(r: &DMatrix<f64>, c: &mut [f64]) {
    for k in (0..c.len()).rev() {
        c[k] = if r[(k, k)] == 0.0 { 0.0 } else { c[k] / r[(k, k)] };
        let x = c[k];
        for i in 0..k {
            c[i] -= r[(i, k)] * x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<Vec<f64>> {
        let wave = |f: f64| (0..50).map(|i| (f * f64::from(i)).sin()).collect::<Vec<_>>();
        let mut near = wave(0.3);
        near[7] += 1e-7;
        vec![wave(0.3), near, wave(0.9)]
    }

    #[test]
    fn q_is_orthonormal_and_q_times_r_is_a_for_nearly_dependent_columns() {
        let a = columns();
        let qr = Qr::new(a.clone());
        for (i, column) in a.iter().enumerate() {
            for j in 0..3 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((dot(&qr.q[i], &qr.q[j]) - expected).abs() < 1e-14);
            }
            let mut rebuilt = vec![0.0; 50];
            (0..=i).for_each(|k| axpy(qr.r[(k, i)], &qr.q[k], &mut rebuilt));
            assert!(rebuilt.iter().zip(column).all(|(x, y)| (x - y).abs() < 1e-14));
        }
    }

    #[test]
    fn a_dependent_column_gets_no_share_of_the_solution() {
        let mut a = columns();
        a[1] = a[0].iter().map(|x| 2.0 * x).collect();
        let y: Vec<f64> = a[0].iter().zip(&a[2]).map(|(u, v)| 3.0 * u - v).collect();
        let qr = Qr::new(a);
        let x = qr.solve(&qr.transpose_times(&y));
        assert!(!qr.full_rank());
        assert!((x - DVector::from_vec(vec![3.0, 0.0, -1.0])).amax() < 1e-12);
    }
}
