//! How well a motion tells unknowns: Fisher information of linear parameters under white noise.
//!
//! With the columns of what is asked for A and of what is open besides B, all rows over their joint's
//! noise, the information about A alone is S = A'A - A'B (B'B)^-1 B'A: D_s-optimality maximises
//! log det S (Atkinson, Donev, Tobias, *Optimum Experimental Designs, with SAS*, 2007, section 10.3).
//! It does not depend on the units of A.

use nalgebra::{Cholesky, DMatrix};

use super::columns::Column;
use crate::kernels::dot;
use crate::regression::qr::Qr;

/// Rows that count, and what they weigh: 1 over the standard deviation of a row's noise.
pub struct Rows {
    /// Rows that count, by joint.
    pub counted: Vec<Vec<usize>>,
    pub weight: Vec<f64>,
}

/// Information on `open` parameters and then on those asked for.
pub struct Information {
    open: usize,
    /// Lower Cholesky factor of the scaled normal matrix.
    factor: DMatrix<f64>,
    /// Length of every column.
    scale: Vec<f64>,
}

/// A column with less than this share of its length to itself says nothing of its own.
const OWN_SHARE: f64 = 1e-6;
/// Nor does a column with less length to itself than this, which is rounding, in units of the noise.
const LEAST: f64 = 1e-9;

impl Rows {
    /// What the rows of a column that count hold at one joint, weighed; empty where it is not felt.
    fn of(&self, column: &Column, joint: usize) -> Vec<f64> {
        match column[joint].is_empty() {
            true => Vec::new(),
            false => {
                let values = &column[joint];
                self.counted[joint].iter().map(|&k| values[k] * self.weight[joint]).collect()
            }
        }
    }

    /// The column with all joints below each other.
    fn stacked(&self, column: &Column) -> Vec<f64> {
        let at = |j: usize| match self.of(column, j) {
            none if none.is_empty() => vec![0.0; self.counted[j].len()],
            values => values,
        };
        (0..self.counted.len()).flat_map(at).collect()
    }
}

/// Which columns, from the first to the last, do not follow from those before them: base parameters
/// (Gautier and Khalil, IEEE Trans. Robotics and Automation 6(3), 1990; by QR, Gautier, J. Robotic
/// Systems 8(4), 1991).
/// `sizes` are those of the parameters.
pub fn independent(columns: &[Column], sizes: &[f64], rows: &Rows) -> Vec<bool> {
    let stacked: Vec<Vec<f64>> = columns.iter().map(|c| rows.stacked(c)).collect();
    let lengths: Vec<f64> = stacked.iter().map(|c| dot(c, c).sqrt()).collect();
    let qr = Qr::new(stacked);
    let of_its_own = |(k, (length, size)): (usize, (&f64, &f64))| {
        qr.r[(k, k)] > OWN_SHARE * length && qr.r[(k, k)] * size > LEAST
    };
    lengths.iter().zip(sizes).enumerate().map(of_its_own).collect()
}

impl Information {
    /// `None` where the motion leaves some of them undetermined.
    pub fn new(columns: &[Column], open: usize, rows: &Rows) -> Option<Self> {
        let mut gram = gram(columns, rows);
        let scale: Vec<f64> = gram.diagonal().iter().map(|d| d.sqrt()).collect();
        if scale.iter().any(|s| s.is_nan() || *s <= 0.0) {
            return None;
        }
        for i in 0..scale.len() {
            for k in 0..scale.len() {
                gram[(i, k)] /= scale[i] * scale[k];
            }
        }
        let factor = Cholesky::new(gram)?.unpack();
        let weakest = factor.diagonal().iter().fold(f64::INFINITY, |m: f64, d| m.min(*d));
        // Below, it is rounding.
        (weakest > 1e-7).then_some(Self { open, factor, scale })
    }

    /// log det S, of parameters in units of `sizes`.
    pub fn log_det(&self, sizes: &[f64]) -> f64 {
        let asked = (self.open..self.scale.len()).zip(sizes);
        asked.map(|(k, size)| 2.0 * (self.factor[(k, k)] * self.scale[k] * size).ln()).sum()
    }

    /// Standard deviations of the asked parameters: diagonal of S^-1.
    pub fn deviations(&self) -> Vec<f64> {
        let asked = self.scale.len() - self.open;
        let corner = self.factor.view((self.open, self.open), (asked, asked)).into_owned();
        let Some(inverse) = corner.solve_lower_triangular(&DMatrix::identity(asked, asked)) else {
            return vec![f64::INFINITY; asked];
        };
        let scale = &self.scale[self.open..];
        inverse.column_iter().zip(scale).map(|(column, s)| column.norm() / s).collect()
    }
}

/// C'C, joint by joint over the columns that a joint feels.
fn gram(columns: &[Column], rows: &Rows) -> DMatrix<f64> {
    let mut gram = DMatrix::zeros(columns.len(), columns.len());
    for (joint, counted) in rows.counted.iter().enumerate() {
        let felt: Vec<usize> =
            (0..columns.len()).filter(|&c| !columns[c][joint].is_empty()).collect();
        let values: Vec<f64> = felt.iter().flat_map(|&c| rows.of(&columns[c], joint)).collect();
        let block = DMatrix::from_vec(counted.len(), felt.len(), values);
        let squares = block.tr_mul(&block);
        for (i, &a) in felt.iter().enumerate() {
            for (k, &b) in felt.iter().enumerate() {
                gram[(a, b)] += squares[(i, k)];
            }
        }
    }
    gram
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;

    /// Five columns over two joints: the first of joint 1 alone, the rest of both.
    fn columns() -> (Vec<Column>, Rows) {
        let wave = |f: f64| (0..80).map(|i| (f * f64::from(i)).sin()).collect::<Vec<_>>();
        let both = |f: f64| vec![wave(f), wave(f + 0.05)];
        let columns = vec![vec![wave(0.2), vec![]], both(0.31), both(0.4), both(0.7), both(0.9)];
        let counted = vec![(0..80).collect(), (10..70).collect()];
        (columns, Rows { counted, weight: vec![2.0, 0.5] })
    }

    /// Against the formula in the module's head, with dense matrices.
    #[test]
    fn of_the_asked_alone() {
        let (columns, rows) = columns();
        let stacked: Vec<DVector<f64>> =
            columns.iter().map(|c| DVector::from_vec(rows.stacked(c))).collect();
        let (b, a) = (DMatrix::from_columns(&stacked[..2]), DMatrix::from_columns(&stacked[2..]));
        let inside = (b.tr_mul(&b)).try_inverse().unwrap();
        let s = a.tr_mul(&a) - a.tr_mul(&b) * inside * b.tr_mul(&a);
        let found = Information::new(&columns, 2, &rows).unwrap();
        let sizes = [0.5, 2.0, 4.0];
        let expected = (s.determinant() * (0.5_f64 * 2.0 * 4.0).powi(2)).ln();
        assert!((found.log_det(&sizes) - expected).abs() < 1e-9);
        let inverse = s.try_inverse().unwrap();
        for (found, expected) in found.deviations().iter().zip(inverse.diagonal().iter()) {
            assert!((found - expected.sqrt()).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn what_follows_from_others_is_left_out() {
        let (mut columns, rows) = columns();
        let sum = |j: usize| columns[1][j].iter().zip(&columns[3][j]).map(|(a, b)| a - 2.0 * b);
        let dependent = vec![sum(0).collect(), sum(1).collect()];
        columns.insert(4, dependent);
        columns.push(vec![vec![], vec![]]);
        columns.push(vec![(0..80).map(|i| 1e-16 * f64::from(i % 7)).collect(), vec![]]);
        let expected = [true, true, true, true, false, true, false, false];
        assert_eq!(independent(&columns, &[1.0; 8], &rows), expected);
        assert!(Information::new(&columns[..6], 2, &rows).is_none());
    }
}
