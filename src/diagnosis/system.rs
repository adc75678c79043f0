//! Linear least squares over all joints, kept so that further columns can be tried cheaply.
//!
//! min sum_j w_j |y_j - B_j x|^2 + sum_i (x_i / s_i)^2, with s_i what is known of x_i beforehand
//! (infinite: nothing). What a further column C gains follows from the Schur complement
//! C'C - C'B G^-1 B'C, G the information matrix B'B + S^-2 (Frisch and Waugh's theorem).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::columns::{Blocks, weighted_dot};
use crate::identification::{bounded, bounds::Bounds};

/// Added to the unit diagonal of the scaled information matrix: keeps dependent columns apart.
const RIDGE: f64 = 1e-10;

pub struct System {
    pub columns: Vec<Blocks>,
    pub weights: Vec<f64>,
    pub x: DVector<f64>,
    pub residual: Blocks,
    /// sqrt(diagonal of G)
    scale: DVector<f64>,
    factor: Option<Cholesky<f64, Dyn>>,
}

/// Columns as seen through a system: what they add to it.
pub struct Projected {
    /// Information on the new parameters, given the others.
    pub information: DMatrix<f64>,
    /// C'r
    pub pull: DVector<f64>,
    /// Diagonal of C'C, before the others take their share.
    pub alone: DVector<f64>,
}

impl System {
    /// `priors` are standard deviations, one per column.
    pub fn solve(columns: Vec<Blocks>, y: &Blocks, weights: Vec<f64>, priors: &[f64]) -> Self {
        let n = columns.len();
        let mut g = DMatrix::zeros(n, n);
        for i in 0..n {
            for k in 0..=i {
                let value = weighted_dot(&columns[i], &columns[k], &weights);
                (g[(i, k)], g[(k, i)]) = (value, value);
            }
            g[(i, i)] += priors[i].powi(-2);
        }
        let scale = g.diagonal().map(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
        let scaled = DMatrix::from_fn(n, n, |i, k| {
            g[(i, k)] / (scale[i] * scale[k]) + if i == k { RIDGE } else { 0.0 }
        });
        let factor = Cholesky::new(scaled);
        let mut system =
            Self { x: DVector::zeros(n), residual: y.clone(), columns, weights, scale, factor };
        // The second step takes off what rounding and the ridge left.
        for _ in 0..2 {
            let pull = system.against(&system.residual);
            let prior = DVector::from_fn(n, |i, _| system.x[i] * priors[i].powi(-2));
            let step = system.inverse_times(&(pull - prior));
            for (column, dx) in system.columns.iter().zip(step.iter()) {
                system.residual.add_scaled(-dx, column);
            }
            system.x += step;
        }
        system
    }

    /// B'W r
    fn against(&self, r: &Blocks) -> DVector<f64> {
        let each = self.columns.iter().map(|c| weighted_dot(c, r, &self.weights));
        DVector::from_iterator(self.columns.len(), each)
    }

    /// G^-1 v
    pub fn inverse_times(&self, v: &DVector<f64>) -> DVector<f64> {
        match (&self.factor, v.is_empty()) {
            (Some(factor), false) => {
                factor.solve(&v.component_div(&self.scale)).component_div(&self.scale)
            }
            _ => v.map(|_| 0.0),
        }
    }

    /// The logarithm of Occam's factor, negated, of parameters with a finite prior, nats: how far
    /// they are from zero by it, and how much the data narrow them,
    /// 1/2 sum (x/s)^2 + 1/2 ln det(I + S G S), G the information on them given the others.
    pub fn occam_penalty(&self, priors: &[f64]) -> f64 {
        let (known, free): (Vec<usize>, Vec<usize>) =
            (0..priors.len()).partition(|&i| priors[i].is_finite());
        if known.is_empty() {
            return 0.0;
        }
        let information = |rows: &[usize], columns: &[usize], scale: &dyn Fn(usize) -> f64| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, k| {
                let (i, k) = (rows[i], columns[k]);
                let (a, b) = (&self.columns[i], &self.columns[k]);
                scale(i) * scale(k) * weighted_dot(a, b, &self.weights)
            })
        };
        let scale = |i: usize| if priors[i].is_finite() { priors[i] } else { 1.0 / self.scale[i] };
        let own = information(&known, &known, &scale);
        let cross = information(&free, &known, &scale);
        let others =
            information(&free, &free, &scale) + DMatrix::identity(free.len(), free.len()) * RIDGE;
        let through = Cholesky::new(others).map(|f| cross.transpose() * f.solve(&cross));
        let given = own - through.unwrap_or_else(|| DMatrix::zeros(known.len(), known.len()));
        let narrowed = Cholesky::new(given + DMatrix::identity(known.len(), known.len()));
        let distance: f64 = known.iter().map(|&i| (self.x[i] / priors[i]).powi(2)).sum();
        0.5 * (distance + narrowed.map_or(0.0, |f| f.ln_determinant()))
    }

    /// Do other values differ from these by no more than a tenth of a standard deviation?
    pub fn is_near(&self, other: &DVector<f64>) -> bool {
        let near = |i: usize| (self.x[i] - other[i]).powi(2) <= 0.01 * self.variance(i);
        self.x.len() == other.len() && (0..self.x.len()).all(near)
    }

    /// Of parameter `i`, given the weights.
    pub fn variance(&self, i: usize) -> f64 {
        let mut unit = DVector::zeros(self.columns.len());
        unit[i] = 1.0;
        self.inverse_times(&unit)[i].max(0.0)
    }

    /// Leaves of `r` what the columns cannot show.
    pub fn take_out(&self, r: &mut Blocks) {
        let x = self.inverse_times(&self.against(r));
        self.columns.iter().zip(x.iter()).for_each(|(c, x)| r.add_scaled(-x, c));
    }

    pub fn project(&self, new: &[Blocks]) -> Projected {
        let (p, k) = (self.columns.len(), new.len());
        let w = &self.weights;
        let cross = DMatrix::from_fn(p, k, |i, c| weighted_dot(&self.columns[i], &new[c], w));
        let mut through = DMatrix::zeros(p, k);
        for c in 0..k {
            through.set_column(c, &self.inverse_times(&cross.column(c).into_owned()));
        }
        let own = DMatrix::from_fn(k, k, |a, b| weighted_dot(&new[a], &new[b], w));
        let information = &own - cross.transpose() * &through;
        let pull = self.pull(new, &self.residual);
        Projected { information, pull, alone: own.diagonal() }
    }

    pub fn pull(&self, new: &[Blocks], r: &Blocks) -> DVector<f64> {
        let each = new.iter().map(|c| weighted_dot(c, r, &self.weights));
        DVector::from_iterator(new.len(), each)
    }
}

impl Projected {
    /// The new parameters within bounds, and the gain 1/2 (chi2 before - chi2 after).
    pub fn solve(&self, pull: &DVector<f64>, bounds: &Bounds) -> (DVector<f64>, f64) {
        let k = pull.len();
        let (scale, factor) = self.factor();
        let Some(factor) = factor else { return (DVector::zeros(k), 0.0) };
        let r = factor.l().transpose();
        let target = factor.l().solve_lower_triangular(&pull.component_div(&scale));
        let Some(target) = target else { return (DVector::zeros(k), 0.0) };
        let mut z = factor.solve(&pull.component_div(&scale));
        let inside = |i: usize, z: f64| bounds.clamp(i, z / scale[i]) == z / scale[i];
        if !z.iter().enumerate().all(|(i, z)| inside(i, *z)) {
            let lower = (0..k).map(|i| bounds.lower(i) * scale[i]).collect();
            let upper = (0..k).map(|i| bounds.upper(i) * scale[i]).collect();
            let Ok(scaled_bounds) = Bounds::new(lower, upper) else {
                return (DVector::zeros(k), 0.0);
            };
            z = bounded::solve(&r, &target, &scaled_bounds);
        }
        let gain = target.dot(&(&r * &z)) - 0.5 * (&r * &z).norm_squared();
        (z.component_div(&scale), gain.max(0.0))
    }

    /// The roots of the diagonal of C'C, and the information scaled by them.
    fn factor(&self) -> (DVector<f64>, Option<Cholesky<f64, Dyn>>) {
        let k = self.alone.len();
        let scale = self.alone.map(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
        let scaled = DMatrix::from_fn(k, k, |i, j| {
            self.information[(i, j)] / (scale[i] * scale[j]) + if i == j { RIDGE } else { 0.0 }
        });
        (scale, Cholesky::new(scaled))
    }

    /// Of the new parameters without bounds, given the weights.
    pub fn variances(&self) -> Vec<f64> {
        let (scale, factor) = self.factor();
        let inverse = factor.map(|f| f.inverse());
        let variance = |i: usize| inverse.as_ref().map_or(0.0, |v| v[(i, i)] / scale[i].powi(2));
        (0..scale.len()).map(variance).collect()
    }

    /// How much of each new column no other column shows, 0 to 1.
    pub fn own_share(&self) -> Vec<f64> {
        let share = |i: usize| match self.alone[i] > 0.0 {
            true => (self.information[(i, i)] / self.alone[i]).clamp(0.0, 1.0),
            false => 0.0,
        };
        (0..self.alone.len()).map(share).collect()
    }
}
