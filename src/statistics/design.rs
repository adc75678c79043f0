//! What a Jacobian can determine: rank, condition, undetermined directions, influence.

use nalgebra::{DMatrix, DVector};

use super::StatisticsError;

/// Relative singular value (of unit-length columns) below which a direction counts as undetermined.
const TOLERANCE: f64 = 1e-9;
/// Share of a unit-length undetermined direction above which a parameter is part of it.
const PART: f64 = 1e-4;

/// The factors of a Jacobian J (rows x parameters): with the columns scaled to unit length by D,
/// J = Q S V^T D. Only singular values above the tolerance are kept, so estimates and covariances
/// are those of the determined part (Golub and Van Loan, Matrix Computations, section 5.5).
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Q, rows x rank, orthonormal.
    basis: DMatrix<f64>,
    /// D^-1 V S^-1, parameters x rank: the pseudo-inverse of J is map Q^T.
    map: DMatrix<f64>,
    /// Singular values of J D^-1, largest first, zeros included.
    singular: Vec<f64>,
    undetermined: Vec<Direction>,
    determined: Vec<bool>,
}

/// A combination of parameters that leaves the prediction unchanged.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Direction {
    /// Weight of every parameter, in its unit, the largest effect on any single column being 1.
    pub weights: Vec<f64>,
    /// Indices of the parameters in it.
    pub parameters: Vec<usize>,
}

impl Design {
    /// `jacobian`: d prediction / d parameter, one row per sample.
    pub fn new(jacobian: &DMatrix<f64>) -> Result<Self, StatisticsError> {
        Self::with_tolerance(jacobian, TOLERANCE)
    }

    /// A Jacobian by finite differences needs a tolerance as coarse as its errors.
    pub fn with_tolerance(
        jacobian: &DMatrix<f64>,
        tolerance: f64,
    ) -> Result<Self, StatisticsError> {
        let (rows, parameters) = jacobian.shape();
        if rows < parameters || rows == 0 {
            return Err(StatisticsError::TooFewRows { rows, parameters });
        }
        if let Some(at) = jacobian.iter().position(|v| !v.is_finite()) {
            return Err(StatisticsError::NotFinite { what: "the Jacobian", row: at % rows });
        }
        let scale: Vec<f64> = jacobian.column_iter().map(|c| column_scale(c.norm())).collect();
        let unit = DMatrix::from_fn(rows, parameters, |i, k| jacobian[(i, k)] / scale[k]);
        let qr = unit.qr();
        let svd = qr.r().svd(true, true);
        let (Some(u), Some(v_t)) = (&svd.u, &svd.v_t) else {
            return Err(StatisticsError::TooFewRows { rows, parameters });
        };
        let mut order: Vec<usize> = (0..parameters).collect();
        order.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
        let singular: Vec<f64> = order.iter().map(|&i| svd.singular_values[i]).collect();
        let limit = tolerance * singular.first().copied().unwrap_or(0.0);
        let rank = singular.iter().filter(|s| **s > limit).count();
        let basis = qr.q() * DMatrix::from_fn(parameters, rank, |i, k| u[(i, order[k])]);
        let map = DMatrix::from_fn(parameters, rank, |i, k| {
            v_t[(order[k], i)] / (singular[k] * scale[i])
        });
        let null =
            DMatrix::from_fn(parameters, parameters - rank, |i, k| v_t[(order[rank + k], i)]);
        let determined = null.row_iter().map(|row| row.norm() < PART).collect();
        let undetermined = directions(null, &scale);
        Ok(Self { basis, map, singular, undetermined, determined })
    }

    pub fn rows(&self) -> usize {
        self.basis.nrows()
    }

    pub fn parameters(&self) -> usize {
        self.map.nrows()
    }

    /// Parameter combinations the rows determine.
    pub fn rank(&self) -> usize {
        self.map.ncols()
    }

    /// Singular values of the Jacobian with unit-length columns, largest first, also below the tolerance.
    pub fn singular_values(&self) -> &[f64] {
        &self.singular
    }

    /// Largest over smallest singular value of the unit-length columns; infinite if rank-deficient.
    pub fn condition(&self) -> f64 {
        match (self.singular.first(), self.singular.last()) {
            (Some(largest), Some(smallest)) => largest / smallest,
            _ => 1.0,
        }
    }

    pub fn undetermined(&self) -> &[Direction] {
        &self.undetermined
    }

    /// False for parameters that take part in an undetermined direction.
    pub fn is_determined(&self, parameter: usize) -> bool {
        self.determined[parameter]
    }

    /// (J^T J)^+: times sigma^2 the covariance under white residuals.
    pub fn unit_covariance(&self) -> DMatrix<f64> {
        &self.map * self.map.transpose()
    }

    /// The least-squares solution of J beta = y (of minimal length where undetermined).
    pub fn solve(&self, y: &[f64]) -> DVector<f64> {
        &self.map * self.basis.tr_mul(&DVector::from_column_slice(y))
    }

    /// Row `parameter` of the pseudo-inverse: d beta / d y, one weight per row.
    pub fn weights(&self, parameter: usize) -> DVector<f64> {
        &self.basis * self.map.row(parameter).transpose()
    }

    /// The orthonormal basis of the prediction's tangent space, rows x rank.
    pub fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// The covariance of the parameters from the covariance of basis^T noise (rank x rank): the
    /// sandwich (J^T J)^-1 J^T Omega J (J^T J)^-1.
    pub fn sandwich(&self, of_basis: &DMatrix<f64>) -> DMatrix<f64> {
        &self.map * of_basis * self.map.transpose()
    }
}

fn column_scale(norm: f64) -> f64 {
    if norm > 0.0 { norm } else { 1.0 }
}

/// The null space's columns by Gauss-Jordan elimination: each direction with as few parameters as
/// possible, in parameter units.
fn directions(null: DMatrix<f64>, scale: &[f64]) -> Vec<Direction> {
    let mut columns: Vec<DVector<f64>> = null.column_iter().map(|c| c.clone_owned()).collect();
    for c in 0..columns.len() {
        let pivot = columns[c].icamax();
        let lead = columns[c].clone() / columns[c][pivot];
        for (other, column) in columns.iter_mut().enumerate() {
            match other == c {
                true => *column = lead.clone(),
                false => *column -= column[pivot] * &lead,
            }
        }
    }
    let direction = |c: &DVector<f64>| Direction {
        parameters: (0..c.len()).filter(|&k| c[k].abs() > PART).collect(),
        weights: c.iter().zip(scale).map(|(w, s)| w / s).collect(),
    };
    columns.iter().map(direction).collect()
}
