//! Linear least squares over all joints, kept so that further columns can be tried cheaply.
//!
//! min sum_j w_j |y_j - B_j x|^2 + sum_i (x_i / s_i)^2 in the inner products of a metric, with s_i
//! what is known of x_i beforehand (infinite: nothing). What a further column C gains follows from
//! the Schur complement C'C - C'B G^-1 B'C, G the information matrix B'B + S^-2 (Frisch and Waugh's
//! theorem).

use std::sync::Arc;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::random_effects::{Features, Metric, Profile};
use super::{Column, Raw, bounded, bounds::Bounds, weighted_dot};

/// Added to the unit diagonal of the scaled information matrix: keeps dependent columns apart.
const RIDGE: f64 = 1e-10;

/// Columns and y, with their products over the rows of every joint: whatever the metric.
#[derive(Debug)]
pub struct Normal {
    pub columns: Vec<Raw>,
    pub y: Raw,
    /// [B y]'[B y], joint by joint.
    products: Vec<DMatrix<f64>>,
}

#[derive(Clone)]
pub struct System {
    pub columns: Vec<Column>,
    pub weights: Vec<f64>,
    pub x: DVector<f64>,
    pub residual: Column,
    /// Standard deviations known beforehand, one per column.
    pub priors: Vec<f64>,
    /// G
    information: DMatrix<f64>,
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

impl Normal {
    pub fn new(columns: Vec<Raw>, y: Raw) -> Arc<Self> {
        let n = columns.len() + 1;
        let of = |i: usize| if i + 1 == n { &y } else { &columns[i] };
        let mut products = vec![DMatrix::zeros(n, n); y.rows.0.len()];
        for i in 0..n {
            for k in 0..=i {
                for (products, v) in products.iter_mut().zip(of(i).dots(of(k)).iter()) {
                    (products[(i, k)], products[(k, i)]) = (*v, *v);
                }
            }
        }
        Arc::new(Self { columns, y, products })
    }

    /// Profile of a joint: those of its columns that no other joint has, and what the values `x` of the
    /// others leave of y, for the random effects there; the rows count as so many.
    pub fn profile<'a>(
        &'a self,
        features: &'a Features,
        j: usize,
        x: &DVector<f64>,
        count: f64,
        least: f64,
    ) -> Profile<'a> {
        let joints = self.products.len();
        let elsewhere = |i: usize| (0..joints).any(|k| k != j && self.columns[i].rows.touches(k));
        let touching = (0..x.len()).filter(|i| self.columns[*i].rows.touches(j));
        let (shared, own): (Vec<usize>, Vec<usize>) = touching.partition(|i| elsewhere(*i));
        let y = self.columns.len();
        let all = &self.products[j];
        let p = own.len();
        let mut products = DMatrix::zeros(p + 1, p + 1);
        // y less the shared columns, as a combination of all columns.
        let rest: Vec<(usize, f64)> =
            shared.iter().map(|&i| (i, -x[i])).chain([(y, 1.0)]).collect();
        for (a, &i) in own.iter().enumerate() {
            for (b, &k) in own.iter().enumerate() {
                products[(a, b)] = all[(i, k)];
            }
            let with_rest = rest.iter().map(|(k, f)| f * all[(i, *k)]).sum::<f64>();
            (products[(a, p)], products[(p, a)]) = (with_rest, with_rest);
        }
        products[(p, p)] = rest
            .iter()
            .flat_map(|(i, f)| rest.iter().map(move |(k, g)| f * g * all[(*i, *k)]))
            .sum();
        let raw = |i: usize| if i == y { &self.y } else { &self.columns[i] };
        let mut of_features: Vec<Vec<f64>> =
            own.iter().map(|&i| raw(i).products(j).to_vec()).collect();
        let mut of_rest = vec![0.0; features.count()];
        for (i, f) in &rest {
            crate::kernels::axpy(*f, raw(*i).products(j), &mut of_rest);
        }
        of_features.push(of_rest);
        Profile::new(features, products, of_features, count, least)
    }

    /// The first `count` columns, and y, in a metric.
    pub fn seen(&self, metric: &Metric, count: usize) -> Seen {
        let columns = Column::all(&self.columns[..count], metric);
        let y = Column::new(&self.y, metric);
        let all: Vec<&Column> = columns.iter().chain([&y]).collect();
        let place = |i: usize| if i == count { self.columns.len() } else { i };
        let at = |(j, products): (usize, &DMatrix<f64>)| {
            let mut here = DMatrix::zeros(count + 1, count + 1);
            let touching: Vec<usize> = (0..=count).filter(|i| all[*i].touches(j)).collect();
            for (a, &i) in touching.iter().enumerate() {
                for &k in &touching[..=a] {
                    let value = products[(place(i), place(k))] - all[i].taken_dot(all[k], j);
                    (here[(i, k)], here[(k, i)]) = (value, value);
                }
            }
            here
        };
        let products = self.products.iter().enumerate().map(at).collect();
        Seen { columns, y, products }
    }
}

/// Columns and y in a metric, with their products there: one for all weights of joints (1/(N.m)^2) and all priors.
pub struct Seen {
    columns: Vec<Column>,
    y: Column,
    /// [B y]'[B y] in the metric, joint by joint.
    products: Vec<DMatrix<f64>>,
}

/// The equations of weighted least squares, G x = B'W y.
struct Weighted {
    information: DMatrix<f64>,
    scale: DVector<f64>,
    factor: Option<Cholesky<f64, Dyn>>,
    pull: DVector<f64>,
}

impl Seen {
    fn weighted(&self, weights: &[f64], priors: &[f64]) -> Weighted {
        let n = self.columns.len();
        let mut all = DMatrix::<f64>::zeros(n + 1, n + 1);
        for (w, products) in weights.iter().zip(&self.products) {
            all += products * *w;
        }
        let pull = all.view((0, n), (n, 1)).column(0).into_owned();
        let mut information = all.view((0, 0), (n, n)).into_owned();
        for i in 0..n {
            information[(i, i)] += priors[i].powi(-2);
        }
        let scale = information.diagonal().map(|d| if d > 0.0 { d.sqrt() } else { 1.0 });
        let scaled = DMatrix::from_fn(n, n, |i, k| {
            information[(i, k)] / (scale[i] * scale[k]) + if i == k { RIDGE } else { 0.0 }
        });
        Weighted { information, scale, factor: Cholesky::new(scaled), pull }
    }

    /// The values that solve, to rounding. `priors` are standard deviations known beforehand, one per column.
    pub fn values(&self, weights: &[f64], priors: &[f64]) -> DVector<f64> {
        let Weighted { scale, factor, pull, .. } = self.weighted(weights, priors);
        inverse_times(factor.as_ref(), &scale, &pull)
    }

    /// Sum of squares that values leave of y, joint by joint, (N.m)^2; of y itself without any. By products, so it is
    /// rounded as the squares of y are.
    pub fn squares(&self, x: Option<&DVector<f64>>) -> Vec<f64> {
        let n = self.columns.len();
        let of = |products: &DMatrix<f64>| {
            let whole = products[(n, n)];
            let Some(x) = x else { return whole };
            let with_y = products.view((0, n), (n, 1)).column(0).dot(x);
            let own = (products.view((0, 0), (n, n)) * x).dot(x);
            (whole - 2.0 * with_y + own).max(0.0)
        };
        self.products.iter().map(of).collect()
    }

    /// Least squares. `priors` as in [`Self::values`].
    pub fn solve(self, weights: Vec<f64>, priors: Vec<f64>) -> System {
        let Weighted { information, scale, factor, pull } = self.weighted(&weights, &priors);
        let Self { columns, y: residual, .. } = self;
        let n = columns.len();
        let x = DVector::zeros(n);
        let mut system =
            System { columns, weights, x, residual, priors, information, scale, factor };
        system.go(&system.inverse_times(&pull));
        // What rounding and the ridge left.
        let prior = DVector::from_fn(n, |i, _| system.x[i] * system.priors[i].powi(-2));
        let left = system.against(&system.residual) - prior;
        system.go(&system.inverse_times(&left));
        system
    }
}

/// G^-1 v
fn inverse_times(
    factor: Option<&Cholesky<f64, Dyn>>,
    scale: &DVector<f64>,
    v: &DVector<f64>,
) -> DVector<f64> {
    match (factor, v.is_empty()) {
        (Some(factor), false) => factor.solve(&v.component_div(scale)).component_div(scale),
        _ => v.map(|_| 0.0),
    }
}

impl System {
    /// `priors` are standard deviations, one per column; columns after those that have one are left out.
    pub fn solve(normal: &Normal, metric: &Metric, weights: Vec<f64>, priors: Vec<f64>) -> Self {
        normal.seen(metric, priors.len()).solve(weights, priors)
    }

    /// x += step
    fn go(&mut self, step: &DVector<f64>) {
        for (column, dx) in self.columns.iter().zip(step.iter()) {
            self.residual.add_scaled(-dx, column);
        }
        self.x += step;
    }

    /// B'W r
    fn against(&self, r: &Column) -> DVector<f64> {
        let each = self.columns.iter().map(|c| weighted_dot(c, r, &self.weights));
        DVector::from_iterator(self.columns.len(), each)
    }

    /// G^-1 v
    pub fn inverse_times(&self, v: &DVector<f64>) -> DVector<f64> {
        inverse_times(self.factor.as_ref(), &self.scale, v)
    }

    /// The logarithm of Occam's factor, negated, of parameters with a finite prior, those from `first` on, nats: how far
    /// they are from zero by it, and how much the data narrow them,
    /// 1/2 sum (x/s)^2 + 1/2 ln det(S G S), G the information on them (prior included) given the
    /// others.
    pub fn occam_penalty(&self, first: usize) -> f64 {
        let (known, free): (Vec<usize>, Vec<usize>) =
            (0..self.priors.len()).partition(|&i| i >= first && self.priors[i].is_finite());
        if known.is_empty() {
            return 0.0;
        }
        let scale = |i: usize| match self.priors[i] {
            s if s.is_finite() => s,
            _ => 1.0 / self.scale[i],
        };
        let part = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, k| {
                let (i, k) = (rows[i], columns[k]);
                scale(i) * scale(k) * self.information[(i, k)]
            })
        };
        let (own, cross) = (part(&known, &known), part(&free, &known));
        let others = part(&free, &free) + DMatrix::identity(free.len(), free.len()) * RIDGE;
        let through = Cholesky::new(others).map(|f| cross.transpose() * f.solve(&cross));
        let given = own - through.unwrap_or_else(|| DMatrix::zeros(known.len(), known.len()));
        let narrowed = Cholesky::new(given).map_or(0.0, |f| f.ln_determinant());
        let distance: f64 = known.iter().map(|&i| (self.x[i] / self.priors[i]).powi(2)).sum();
        0.5 * (distance + narrowed.max(0.0))
    }

    /// Do other values differ from these by no more than a tenth of a standard deviation?
    pub fn is_near(&self, other: &DVector<f64>) -> bool {
        let near = |i: usize| (self.x[i] - other[i]).powi(2) <= 0.01 * self.variance(i);
        self.x.len() == other.len() && (0..self.x.len()).all(near)
    }

    /// Variance of parameter `i`, given the weights.
    pub fn variance(&self, i: usize) -> f64 {
        self.variance_along(&[(i, 1.0)])
    }

    /// Variance of a sum of parameters, each times a factor.
    pub fn variance_along(&self, direction: &[(usize, f64)]) -> f64 {
        let mut along = DVector::zeros(self.columns.len());
        direction.iter().for_each(|(i, factor)| along[*i] = *factor);
        self.inverse_times(&along).dot(&along).max(0.0)
    }

    /// Covariance of some parameters, in their order and units, given the weights.
    pub fn covariance(&self, parameters: &[usize]) -> DMatrix<f64> {
        let unit = |i: usize| {
            let n = self.columns.len();
            DVector::from_fn(n, |k, _| f64::from(u8::from(k == i)))
        };
        let columns: Vec<_> = parameters.iter().map(|i| self.inverse_times(&unit(*i))).collect();
        let n = parameters.len();
        DMatrix::from_fn(n, n, |a, b| columns[b][parameters[a]])
    }

    /// How much of parameter `i` these data tell, 0 to 1: what they narrow of the variance that is expected
    /// beforehand (MacKay, Neural Computation 4, 1992, eq. 2.11).
    pub fn determined(&self, i: usize) -> f64 {
        let expected = self.priors[i].powi(2);
        if expected.is_finite() { (1.0 - self.variance(i) / expected).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// New columns, with standard deviations known beforehand.
    pub fn project(&self, new: &[Column], priors: &[f64]) -> Projected {
        let (p, k) = (self.columns.len(), new.len());
        let w = &self.weights;
        let cross = DMatrix::from_fn(p, k, |i, c| weighted_dot(&self.columns[i], &new[c], w));
        let mut through = DMatrix::zeros(p, k);
        for c in 0..k {
            through.set_column(c, &self.inverse_times(&cross.column(c).into_owned()));
        }
        let own = DMatrix::from_fn(k, k, |a, b| weighted_dot(&new[a], &new[b], w));
        let mut information = &own - cross.transpose() * &through;
        for i in 0..k {
            information[(i, i)] += priors[i].powi(-2);
        }
        let each = new.iter().map(|c| weighted_dot(c, &self.residual, w));
        Projected { information, pull: DVector::from_iterator(k, each), alone: own.diagonal() }
    }
}

impl Projected {
    /// The new parameters within bounds, and the gain 1/2 (chi2 before - chi2 after).
    pub fn solve(&self, bounds: &Bounds) -> (DVector<f64>, f64) {
        let (pull, k) = (&self.pull, self.pull.len());
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

    /// 1/2 ln det (S G S), G the information on the new parameters: how much the data narrow what
    /// was known beforehand, nats.
    pub fn narrowing(&self, priors: &[f64]) -> f64 {
        let k = priors.len();
        let scaled =
            DMatrix::from_fn(k, k, |i, j| priors[i] * priors[j] * self.information[(i, j)]);
        0.5 * Cholesky::new(scaled).map_or(0.0, |f| f.ln_determinant()).max(0.0)
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

    /// Variances of the new parameters without bounds, given the weights.
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
