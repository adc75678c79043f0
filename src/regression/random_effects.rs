//! Random effects beside a regression: y = X b + D w + e, with w ~ N(0, s^2 R) and e ~ N(0, s^2).
//!
//! The columns of D come in groups, each with a size of its own (R is diagonal, one value per
//! group). With w integrated out y ~ N(X b, s^2 (1 + D R D')), so that every inner product of
//! least squares becomes x' (1 + D R D')^-1 y, and the sizes are those that make the data most
//! likely (variance components by maximum likelihood: Harville, J. Am. Stat. Ass. 72, 1977).
//! Woodbury: (1 + D R D')^-1 = 1 - D R^1/2 (1 + R^1/2 D'D R^1/2)^-1 R^1/2 D'.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex};

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::kernels;

/// Sizes of a group, as powers of two times [`SMALLEST`]; 0 is absent. A factor of two between
/// neighbours costs no more than a tenth of a nat per independent feature. The largest is 3.2 times the
/// noise: of what a model leaves the features explain nine tenths at most, the rest is noise, or else
/// a large gap would never need a cause.
pub const STEPS: u8 = 7;
const SMALLEST: f64 = 0.025;

/// The root of R for a step of the grid: standard deviation of what the group adds over that of e.
pub fn size(step: u8) -> f64 {
    if step == 0 { 0.0 } else { SMALLEST * 2f64.powi(i32::from(step)) }
}

/// How inner products are taken at every joint.
#[derive(Debug, Clone)]
pub struct Metric {
    pub joints: Vec<Arc<JointMetric>>,
}

/// Inner products at one joint, for one set of sizes.
#[derive(Debug)]
pub struct JointMetric {
    /// Step of every group's size on the grid.
    pub steps: Vec<u8>,
    /// Features of groups that are there, with the roots of their sizes.
    active: Vec<(usize, f64)>,
    /// L of L L' = 1 + R^1/2 D'D R^1/2.
    lower: DMatrix<f64>,
    /// ln det (1 + D R D')
    pub ln_det: f64,
}

/// The features of one joint.
#[derive(Debug)]
pub struct Features {
    /// D, one column per feature, a value for each run of rows.
    columns: Vec<Vec<f64>>,
    /// First row of each run, and the end.
    runs: Vec<usize>,
    /// First run of each part of the rows, and the end.
    parts: Vec<usize>,
    /// Group of each feature.
    pub group: Vec<usize>,
    pub groups: usize,
    /// Largest step of every group.
    largest: Vec<u8>,
    /// D'D, part by part and of all.
    grams: Vec<DMatrix<f64>>,
    gram: DMatrix<f64>,
    known: Mutex<HashMap<Vec<u8>, Arc<JointMetric>>>,
}

impl JointMetric {
    /// L^-1 R^1/2 a of a column's products a = D'x: what the random effects take up of it.
    pub fn taken(&self, features: &[f64]) -> Vec<f64> {
        if features.is_empty() || self.active.is_empty() {
            return Vec::new();
        }
        let scaled = self.active.iter().map(|(i, root)| root * features[*i]);
        let mut v: Vec<f64> = scaled.collect();
        kernels::solve_lower(self.lower.as_slice(), &mut v);
        v
    }

    /// The most likely coefficients w of all features for a residual of which `taken` is taken up:
    /// w = R^1/2 L'^-1 (L^-1 R^1/2 D'r).
    pub fn coefficients(&self, taken: &[f64], features: usize) -> Vec<f64> {
        let mut v = DVector::from_column_slice(taken);
        if taken.len() == self.active.len() {
            self.lower.tr_solve_lower_triangular_mut(&mut v);
        }
        let mut all = vec![0.0; features];
        for ((i, root), v) in self.active.iter().zip(v.iter()) {
            all[*i] = root * v;
        }
        all
    }

    /// ln of the number of sizes, for every group that is there.
    pub fn price(&self) -> f64 {
        let there = self.steps.iter().filter(|s| **s > 0).count();
        there as f64 * f64::from(STEPS).ln()
    }

    /// Is no group there?
    pub fn is_plain(&self) -> bool {
        self.active.is_empty()
    }
}

/// Products of all columns with each other over these runs.
fn gram(columns: &[Vec<f64>], runs: Range<usize>) -> DMatrix<f64> {
    let m = columns.len();
    let views: Vec<&[f64]> = columns.iter().map(|c| &c[runs.clone()]).collect();
    let mut gram = DMatrix::zeros(m, m);
    for i in 0..m {
        for (k, v) in kernels::dots(views[i], &views[..=i]).into_iter().enumerate() {
            (gram[(i, k)], gram[(k, i)]) = (v, v);
        }
    }
    gram
}

/// Sum of matrices, each times a factor.
fn sum(all: &[DMatrix<f64>], factors: &[f64]) -> DMatrix<f64> {
    let none = all.first().map_or_else(|| DMatrix::zeros(0, 0), |m| m * 0.0);
    all.iter().zip(factors).fold(none, |sum, (m, by)| sum + m * *by)
}

impl Features {
    /// `columns` all have one value per row; `group` says which group each belongs to.
    pub fn new(columns: Vec<Vec<f64>>, group: Vec<usize>, groups: usize) -> Self {
        let rows = columns.first().map_or(0, Vec::len);
        Self::over_runs(&columns, group, groups, (0..=rows).collect(), &[rows])
    }

    /// Features with each column constant over runs of rows, at its mean: what is smooth needs no more.
    /// `runs`: where each begins, and the end; `ends`: where each part of the rows ends, which no run crosses.
    pub fn over_runs(
        columns: &[Vec<f64>],
        group: Vec<usize>,
        groups: usize,
        runs: Vec<usize>,
        ends: &[usize],
    ) -> Self {
        let mean = |rows: &[f64]| rows.iter().sum::<f64>() / rows.len().max(1) as f64;
        let coarse = |c: &Vec<f64>| runs.windows(2).map(|run| mean(&c[run[0]..run[1]])).collect();
        let columns: Vec<Vec<f64>> = columns.iter().map(coarse).collect();
        let roots = || runs.windows(2).map(|run| ((run[1] - run[0]) as f64).sqrt());
        let rooted = |c: &Vec<f64>| c.iter().zip(roots()).map(|(v, root)| v * root).collect();
        let rooted: Vec<Vec<f64>> = columns.iter().map(rooted).collect();
        let begins = |end: &usize| runs.partition_point(|run| run < end);
        let parts: Vec<usize> = std::iter::once(0).chain(ends.iter().map(begins)).collect();
        let grams: Vec<_> = parts.windows(2).map(|part| gram(&rooted, part[0]..part[1])).collect();
        let (largest, known) = (vec![STEPS; groups], Mutex::default());
        let gram = sum(&grams, &vec![1.0; grams.len()]);
        Self { columns, runs, parts, group, groups, largest, grams, gram, known }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.columns.len()
    }

    /// Keeps group `g` no larger than `most` times the standard deviation of e.
    pub fn bounded(mut self, g: usize, most: f64) -> Self {
        self.largest[g] = (1..=STEPS).rev().find(|s| size(*s) <= most).unwrap_or(0);
        self
    }

    /// Largest step of the size of group `g`.
    pub fn largest(&self, g: usize) -> u8 {
        self.largest[g]
    }

    /// Features with all columns times a factor of each part of the rows.
    pub fn scaled(&self, factors: &[f64]) -> Self {
        let column = |c: &Vec<f64>| -> Vec<f64> {
            let parts = self.parts.windows(2).zip(factors);
            parts.flat_map(|(part, by)| c[part[0]..part[1]].iter().map(move |v| v * by)).collect()
        };
        let squares: Vec<f64> = factors.iter().map(|by| by * by).collect();
        let scaled = |(gram, by): (&DMatrix<f64>, &f64)| gram * *by;
        Self {
            columns: self.columns.iter().map(column).collect(),
            runs: self.runs.clone(),
            parts: self.parts.clone(),
            group: self.group.clone(),
            groups: self.groups,
            largest: self.largest.clone(),
            grams: self.grams.iter().zip(&squares).map(scaled).collect(),
            gram: sum(&self.grams, &squares),
            known: Mutex::default(),
        }
    }

    /// D'x of every column x.
    pub fn products(&self, columns: &[&[f64]]) -> Vec<Vec<f64>> {
        let of_run = |x: &[f64], run: &[usize]| x[run[0]..run[1]].iter().sum::<f64>();
        let coarse = |x: &&[f64]| self.runs.windows(2).map(|run| of_run(x, run)).collect();
        let coarse: Vec<Vec<f64>> = match self.columns.is_empty() {
            true => vec![Vec::new(); columns.len()],
            false => columns.iter().map(coarse).collect(),
        };
        let views: Vec<&[f64]> = self.columns.iter().map(Vec::as_slice).collect();
        kernels::dots_of(&coarse, &views)
    }

    /// D w over the rows, of one group or of all.
    pub fn sum(&self, w: &[f64], group: Option<usize>) -> Vec<f64> {
        let mut sum = vec![0.0; self.runs.len().saturating_sub(1)];
        for ((column, w), g) in self.columns.iter().zip(w).zip(&self.group) {
            if *w != 0.0 && group.is_none_or(|wanted| wanted == *g) {
                kernels::axpy(*w, column, &mut sum);
            }
        }
        let spread = |(run, d): (&[usize], &f64)| std::iter::repeat_n(*d, run[1] - run[0]);
        self.runs.windows(2).zip(&sum).flat_map(spread).collect()
    }

    /// The metric for these sizes; worked out once.
    pub fn metric(&self, steps: &[u8]) -> Arc<JointMetric> {
        if let Some(metric) = self.known.lock().ok().and_then(|k| k.get(steps).cloned()) {
            return metric;
        }
        let made = Arc::new(self.work_out(steps));
        if let Ok(mut known) = self.known.lock() {
            known.insert(steps.to_vec(), made.clone());
        }
        made
    }

    fn work_out(&self, steps: &[u8]) -> JointMetric {
        let root = |i: usize| (i, size(steps[self.group[i]]));
        let active: Vec<(usize, f64)> =
            (0..self.columns.len()).map(root).filter(|(_, r)| *r > 0.0).collect();
        let m = active.len();
        let k = DMatrix::from_fn(m, m, |a, b| {
            let ((i, ri), (j, rj)) = (active[a], active[b]);
            ri * rj * self.gram[(i, j)] + f64::from(u8::from(a == b))
        });
        let lower = Cholesky::new(k).map_or_else(|| DMatrix::identity(m, m), |c| c.unpack());
        let ln_det = 2.0 * lower.diagonal().iter().map(|d| d.ln()).sum::<f64>();
        JointMetric { steps: steps.to_vec(), active, lower, ln_det }
    }
}

/// Columns of one joint that are fitted by it alone, the last of them y: products over the rows,
/// and with the features. From these follows how likely the data are for any sizes.
#[derive(Debug)]
pub struct Profile<'a> {
    features: &'a Features,
    /// [X y]'[X y]
    gram: DMatrix<f64>,
    /// D'[X y], one per column.
    products: Vec<Vec<f64>>,
    /// Rows, as they count.
    rows: f64,
    /// Variance below which e is not.
    least: f64,
}

impl<'a> Profile<'a> {
    /// `gram` of the columns and y, which comes last; `products` of each with the features; `least`
    /// is the smallest variance e can have.
    pub fn new(
        features: &'a Features,
        gram: DMatrix<f64>,
        products: Vec<Vec<f64>>,
        rows: f64,
        least: f64,
    ) -> Self {
        Self { features, gram, products, rows, least }
    }

    /// Log-likelihood at its best coefficients and variance, nats up to a constant; each group that is
    /// there costs what it is to have chosen its size among all.
    pub fn ln_likelihood(&self, steps: &[u8]) -> f64 {
        let metric = self.features.metric(steps);
        let taken: Vec<Vec<f64>> = self.products.iter().map(|p| metric.taken(p)).collect();
        let n = taken.len();
        let gram =
            DMatrix::from_fn(n, n, |i, k| self.gram[(i, k)] - kernels::dot(&taken[i], &taken[k]));
        let left = remaining(&gram);
        ln_likelihood(left, self.rows, self.least) - 0.5 * metric.ln_det - metric.price()
    }

    /// The most likely sizes, by coordinate ascent over the grid from `from`; a group that is absent
    /// may come in at any size.
    pub fn best(&self, from: &[u8]) -> (Vec<u8>, f64) {
        let mut best = from.to_vec();
        let mut top = self.ln_likelihood(&best);
        for _ in 0..PASSES {
            let before = top;
            for g in 0..self.features.groups {
                self.ascend(g, &mut best, &mut top);
            }
            if top - before < SETTLED {
                break;
            }
        }
        (best, top)
    }

    fn ascend(&self, g: usize, best: &mut Vec<u8>, top: &mut f64) {
        let mut try_step = |step: u8, best: &mut Vec<u8>| {
            let mut steps = best.clone();
            steps[g] = step;
            let value = self.ln_likelihood(&steps);
            let better = value > *top;
            if better {
                (*best, *top) = (steps, value);
            }
            better
        };
        let now = best[g];
        if now == 0 {
            // Small, medium and large: from one of them the climb goes on.
            let most = self.features.largest[g];
            if !ENTRIES.iter().any(|&step| step <= most && try_step(step, best)) {
                return;
            }
        } else if now > 1 && try_step(0, best) {
            return;
        }
        for direction in [-1i8, 1] {
            while let Some(step) = best[g].checked_add_signed(direction) {
                if step > self.features.largest[g] || !try_step(step, best) {
                    break;
                }
            }
        }
    }
}

/// Rounds over all groups, and what another has to gain, nats.
const PASSES: usize = 3;
const SETTLED: f64 = 0.5;
/// Steps at which a group that is absent is tried.
pub const ENTRIES: [u8; 3] = [2, 4, 6];

/// Sum of squares of the last column that the others leave: the Schur complement of their Gram
/// matrix.
fn remaining(gram: &DMatrix<f64>) -> f64 {
    let p = gram.nrows() - 1;
    let scale: Vec<f64> = (0..p)
        .map(|i| gram[(i, i)].max(0.0).sqrt())
        .map(|s| if s > 0.0 { s } else { 1.0 })
        .collect();
    let scaled = DMatrix::from_fn(p, p, |i, k| {
        gram[(i, k)] / (scale[i] * scale[k]) + if i == k { 1e-10 } else { 0.0 }
    });
    let pull = DVector::from_fn(p, |i, _| gram[(i, p)] / scale[i]);
    let taken = Cholesky::new(scaled).map_or(0.0, |c| pull.dot(&c.solve(&pull)));
    (gram[(p, p)] - taken).max(0.0)
}

/// -n/2 ln s^2 - left / (2 s^2) at the most likely variance s^2, which is at least `least`.
pub fn ln_likelihood(left: f64, n: f64, least: f64) -> f64 {
    if n <= 0.0 {
        return 0.0;
    }
    let variance = (left / n).max(least).max(f64::MIN_POSITIVE);
    -0.5 * (n * variance.ln() + left / variance)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    const ROWS: usize = 40;

    fn features() -> Features {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut column = || (0..ROWS).map(|_| rng.random::<f64>() - 0.5).collect::<Vec<f64>>();
        Features::new((0..7).map(|_| column()).collect(), vec![0, 0, 0, 1, 1, 1, 1], 2)
    }

    fn profile<'a>(features: &'a Features, columns: &[&Vec<f64>]) -> Profile<'a> {
        let n = columns.len();
        let gram = DMatrix::from_fn(n, n, |i, k| kernels::dot(columns[i], columns[k]));
        let columns: Vec<&[f64]> = columns.iter().map(|c| c.as_slice()).collect();
        let products = features.products(&columns);
        Profile::new(features, gram, products, ROWS as f64, 1e-12)
    }

    /// ln N(y; X b, s^2 (1 + D R D')) at the best b and s by brute force.
    #[test]
    fn the_likelihood_is_that_of_the_whole_covariance() {
        let features = features();
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut column = || (0..ROWS).map(|_| rng.random::<f64>() - 0.3).collect::<Vec<f64>>();
        let (x, y) = (column(), column());
        let profile = profile(&features, &[&x, &y]);
        for steps in [[0, 0], [3, 0], [0, 6], [7, 5]] {
            let covariance = DMatrix::from_fn(ROWS, ROWS, |a, b| {
                let part = |i: usize| {
                    size(steps[features.group[i]]).powi(2)
                        * features.columns[i][a]
                        * features.columns[i][b]
                };
                f64::from(u8::from(a == b)) + (0..7).map(part).sum::<f64>()
            });
            let inverse = covariance.clone().try_inverse().unwrap();
            let (x, y) = (DVector::from_vec(x.clone()), DVector::from_vec(y.clone()));
            let b = (x.transpose() * &inverse * &y)[0] / (x.transpose() * &inverse * &x)[0];
            let rest = &y - &x * b;
            let left = (rest.transpose() * &inverse * &rest)[0];
            let n = ROWS as f64;
            let there = steps.iter().filter(|s| **s > 0).count() as f64;
            let price = there * f64::from(STEPS).ln();
            let exact = -0.5 * (n * (left / n).ln() + n + covariance.determinant().ln()) - price;
            let found = profile.ln_likelihood(&steps);
            assert!((found - exact).abs() < 1e-6, "{steps:?}: {found} {exact}");
        }
    }

    #[test]
    fn a_group_that_is_there_comes_in_and_one_that_is_not_stays_out() {
        let features = features();
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut noise = || 0.05 * (rng.random::<f64>() - 0.5);
        let y: Vec<f64> = (0..ROWS)
            .map(|k| features.columns[3][k] - 0.7 * features.columns[5][k] + noise())
            .collect();
        let profile = profile(&features, &[&y]);
        let (steps, _) = profile.best(&[0, 0]);
        assert!(steps[0] == 0 && steps[1] > 5, "{steps:?}");
    }
}
