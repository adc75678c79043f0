//! Normal equations of a few columns: small enough to keep, and those of several joints add up.

use nalgebra::{DMatrix, DMatrixView, DVector, SymmetricEigen};

/// Directions of the columns, scaled to unit length, that are weaker than this beside the strongest
/// are not determined.
const RANK: f64 = 1e-10;

/// C'C x = C'y
#[derive(Debug, Clone)]
pub struct Equations {
    /// C'C
    gram: DMatrix<f64>,
    /// C'y
    pull: DVector<f64>,
}

/// Where every column says something of its own.
pub struct Solved {
    pub x: DVector<f64>,
    /// (C'C)^-1: times the variance of y the covariance of x.
    pub inverse: DMatrix<f64>,
}

impl Equations {
    pub fn new(columns: DMatrixView<'_, f64>, y: &DVector<f64>) -> Self {
        Self { gram: columns.tr_mul(&columns), pull: columns.tr_mul(y) }
    }

    /// Those of all rows together; `None` of nothing.
    pub fn sum<'a>(all: impl IntoIterator<Item = &'a Self>) -> Option<Self> {
        let add = |a: Self, b: Self| Self { gram: a.gram + b.gram, pull: a.pull + b.pull };
        all.into_iter().cloned().reduce(add)
    }

    /// Least squares; `None` where a column depends on others.
    pub fn solve(&self) -> Option<Solved> {
        let inverse = self.gram.clone().cholesky()?.inverse();
        Some(Solved { x: &inverse * &self.pull, inverse })
    }

    /// Least squares whatever the columns; directions that are not determined stay at zero.
    pub fn solve_determined(&self) -> DVector<f64> {
        let root = |square: f64| if square > 0.0 { square.sqrt() } else { 1.0 };
        let scale = self.gram.diagonal().map(root);
        let n = scale.len();
        if n == 0 {
            return scale;
        }
        let scaled = DMatrix::from_fn(n, n, |i, k| self.gram[(i, k)] / (scale[i] * scale[k]));
        let pull = self.pull.component_div(&scale);
        let eigen = SymmetricEigen::new(scaled);
        let largest = eigen.eigenvalues.max();
        let mut x = DVector::zeros(n);
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > RANK * largest {
                x += vector * (vector.dot(&pull) / value);
            }
        }
        x.component_div(&scale)
    }

    /// What the values `x` take off the square of y: |y|^2 - |y - C x|^2.
    pub fn taken(&self, x: &DVector<f64>) -> f64 {
        2.0 * x.dot(&self.pull) - x.dot(&(&self.gram * x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> DMatrix<f64> {
        DMatrix::from_fn(40, 3, |i, k| ((0.3 + 0.2 * k as f64) * i as f64).sin())
    }

    fn y(columns: &DMatrix<f64>) -> DVector<f64> {
        let off = DVector::from_fn(40, |i, _| 0.1 * (1.7 * i as f64).cos());
        columns * DVector::from_vec(vec![2.0, -1.0, 0.5]) + off
    }

    #[test]
    fn blocks_of_rows_add_up_to_least_squares_over_all() {
        let a = columns();
        let y = y(&a);
        let block = |from: usize| {
            Equations::new(a.rows(from, 20).into_owned().as_view(), &y.rows(from, 20).into_owned())
        };
        let all = Equations::sum(&[block(0), block(20)]).unwrap();
        let solved = all.solve().unwrap();
        let expected = a.clone().svd(true, true).solve(&y, 1e-12).unwrap();
        assert!((&solved.x - &expected).amax() < 1e-12);
        assert!((&solved.inverse * a.tr_mul(&a) - DMatrix::identity(3, 3)).amax() < 1e-12);
        assert!((all.solve_determined() - &expected).amax() < 1e-12);
        let left = (&y - &a * &solved.x).norm_squared();
        assert!((all.taken(&solved.x) - (y.norm_squared() - left)).abs() < 1e-10);
    }

    #[test]
    fn no_columns_have_no_values() {
        let none = Equations::new(DMatrix::zeros(40, 0).as_view(), &y(&columns()));
        assert_eq!(none.solve_determined().len(), 0);
    }

    #[test]
    fn a_dependent_column_and_one_of_zeros_leave_the_fit_as_it_is() {
        let a = columns();
        let y = y(&a);
        let twice = 2.0 * a.column(0);
        let more = a.clone().insert_columns(3, 2, 0.0);
        let more = DMatrix::from_fn(40, 5, |i, k| if k == 3 { twice[i] } else { more[(i, k)] });
        let equations = Equations::new(more.as_view(), &y);
        assert!(equations.solve().is_none());
        let x = equations.solve_determined();
        let plain = Equations::new(a.as_view(), &y).solve_determined();
        assert!(x[4] == 0.0 && (&more * &x - &a * plain).amax() < 1e-9, "{x}");
    }
}
