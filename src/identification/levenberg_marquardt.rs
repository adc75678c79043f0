//! Levenberg-Marquardt in a box, for any residual.
//!
//! min |r(x)|^2 with lower <= x <= upper. Each step solves min |r + J p| with |D p| <= Delta, D the
//! largest column norms of J so far (More, *The Levenberg-Marquardt algorithm: implementation and
//! theory*, 1978, which is MINPACK's `lmder`); the damping that meets the trust region comes from
//! the singular values of J D^-1, so dependent columns are no obstacle. Parameters on a bound
//! with the gradient pointing outwards stay there; a step that would leave the box is projected.

use nalgebra::{DMatrix, DVector, SVD};

use crate::kernels::dot;
use crate::regression::bounds::Bounds;
use crate::regression::qr::Qr;

/// What is minimised.
pub trait Residuals {
    /// Number of residuals.
    fn count(&self) -> usize;

    /// r(x) into `out` (`count` values).
    fn residuals(&self, x: &[f64], out: &mut [f64]);

    /// dr/dx, one column of `count` values per parameter; forward differences unless overridden.
    fn jacobian(&self, x: &[f64], r: &[f64], bounds: &Bounds) -> Vec<Vec<f64>> {
        forward_differences(self, x, r, bounds)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Relative reduction of the sum of squares, measured and predicted, below which to stop.
    pub cost_tolerance: f64,
    /// Relative step below which to stop.
    pub step_tolerance: f64,
    /// Cosine between residual and any column of the Jacobian below which to stop.
    pub gradient_tolerance: f64,
    pub max_evaluations: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            cost_tolerance: 1e-14,
            step_tolerance: 1e-12,
            gradient_tolerance: 1e-12,
            max_evaluations: 1000,
        }
    }
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    CostConverged,
    StepConverged,
    GradientConverged,
    /// The residual is zero to rounding, seen from where the search began.
    Exact,
    Evaluations,
    /// Residual or Jacobian is not finite where the search stands.
    NotFinite,
}

impl Stop {
    pub fn converged(self) -> bool {
        !matches!(self, Self::Evaluations | Self::NotFinite)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    pub x: Vec<f64>,
    /// |r|^2
    pub sum_of_squares: f64,
    /// Evaluations of the residual; a Jacobian counts as one, by differences as one per parameter.
    pub evaluations: usize,
    pub iterations: usize,
    pub stop: Stop,
}

/// Minimises from `start` (moved into the box if need be) downhill.
pub fn minimise(
    problem: &impl Residuals,
    start: &[f64],
    bounds: &Bounds,
    settings: &Settings,
) -> Outcome {
    let mut search = Search::new(problem, start, bounds);
    let stop = search.run(settings);
    Outcome {
        sum_of_squares: search.norm * search.norm,
        x: search.x,
        evaluations: search.evaluations,
        iterations: search.iterations,
        stop,
    }
}

struct Search<'a, P> {
    problem: &'a P,
    bounds: &'a Bounds,
    x: Vec<f64>,
    r: Vec<f64>,
    /// |r|
    norm: f64,
    /// D
    scale: Vec<f64>,
    /// Delta
    radius: f64,
    evaluations: usize,
    iterations: usize,
}

/// The linearised problem over the parameters that may move.
struct Model {
    free: Vec<usize>,
    /// R and Q' r of J restricted to `free`.
    r: DMatrix<f64>,
    c: DVector<f64>,
    /// U' c, singular values and V of R D^-1.
    uc: DVector<f64>,
    s: DVector<f64>,
    v_t: DMatrix<f64>,
    /// Largest cosine between the residual and a free column.
    cosine: f64,
}

/// What became of a trial step.
enum Trial {
    Accepted,
    Rejected,
    Stopped(Stop),
}

impl<'a, P: Residuals> Search<'a, P> {
    fn new(problem: &'a P, start: &[f64], bounds: &'a Bounds) -> Self {
        let x: Vec<f64> = start.iter().enumerate().map(|(i, &v)| bounds.clamp(i, v)).collect();
        let mut r = vec![0.0; problem.count()];
        problem.residuals(&x, &mut r);
        let norm = dot(&r, &r).sqrt();
        let scale = vec![0.0; x.len()];
        Self { problem, bounds, x, r, norm, scale, radius: 0.0, evaluations: 1, iterations: 0 }
    }

    fn run(&mut self, settings: &Settings) -> Stop {
        if !self.norm.is_finite() {
            return Stop::NotFinite;
        }
        let rounding = f64::EPSILON * self.norm;
        loop {
            if self.norm <= rounding {
                return Stop::Exact;
            }
            let Some(model) = self.linearise() else { return Stop::NotFinite };
            if model.cosine <= settings.gradient_tolerance {
                return Stop::GradientConverged;
            }
            self.iterations += 1;
            loop {
                match self.try_step(&model, settings) {
                    Trial::Accepted => break,
                    Trial::Rejected => {}
                    Trial::Stopped(stop) => return stop,
                }
            }
        }
    }

    /// `None` where the Jacobian is not finite.
    fn linearise(&mut self) -> Option<Model> {
        let columns = self.problem.jacobian(&self.x, &self.r, self.bounds);
        self.evaluations += 1;
        let norms: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
        if norms.iter().any(|n| !n.is_finite()) {
            return None;
        }
        self.update_scale(&norms);
        let gradient: Vec<f64> = columns.iter().map(|c| dot(c, &self.r)).collect();
        let free: Vec<usize> =
            (0..self.x.len()).filter(|&i| self.movable(i, gradient[i])).collect();
        let cosine = free.iter().filter(|&&i| norms[i] > 0.0);
        let cosine =
            cosine.map(|&i| (gradient[i] / norms[i]).abs() / self.norm).fold(0.0, f64::max);
        let qr = Qr::new(free.iter().map(|&i| columns[i].clone()).collect());
        let c = qr.transpose_times(&self.r);
        let scaled =
            DMatrix::from_fn(free.len(), free.len(), |i, j| qr.r[(i, j)] / self.scale[free[j]]);
        let (uc, s, v_t) = singular(scaled, &c);
        Some(Model { free, r: qr.r, c, uc, s, v_t, cosine })
    }

    fn update_scale(&mut self, norms: &[f64]) {
        let first = self.radius == 0.0;
        for (d, &n) in self.scale.iter_mut().zip(norms) {
            *d = if first && n == 0.0 { 1.0 } else { d.max(n) };
        }
        if first {
            let length = self.scaled_length(&self.x);
            self.radius = if length > 0.0 { 100.0 * length } else { 100.0 };
        }
    }

    /// Inside, or on a bound with the way downhill leading inside.
    fn movable(&self, i: usize, gradient: f64) -> bool {
        let x = self.x[i];
        let held_below = x <= self.bounds.lower(i) && gradient >= 0.0;
        let held_above = x >= self.bounds.upper(i) && gradient <= 0.0;
        !held_below && !held_above
    }

    fn scaled_length(&self, p: &[f64]) -> f64 {
        p.iter().zip(&self.scale).map(|(p, d)| (p * d).powi(2)).sum::<f64>().sqrt()
    }

    fn try_step(&mut self, model: &Model, settings: &Settings) -> Trial {
        let (x, step) = self.projected_step(model);
        let mut r = vec![0.0; self.r.len()];
        self.problem.residuals(&x, &mut r);
        self.evaluations += 1;
        let norm = dot(&r, &r).sqrt();
        let actual =
            if norm.is_finite() { 1.0 - (norm / self.norm).powi(2) } else { f64::NEG_INFINITY };
        let predicted = model.reduction(&step) / self.norm.powi(2);
        let ratio = if predicted > 0.0 { actual / predicted } else { 0.0 };
        let length = self.scaled_length(&step);
        self.update_radius(ratio, length);
        let accepted = ratio > 1e-4;
        if accepted {
            (self.x, self.r, self.norm) = (x, r, norm);
        }
        let small = |v: f64| v.abs() <= settings.cost_tolerance;
        if small(actual) && small(predicted) && ratio <= 2.0 {
            return Trial::Stopped(Stop::CostConverged);
        }
        if self.radius <= settings.step_tolerance * self.scaled_length(&self.x) || length == 0.0 {
            return Trial::Stopped(Stop::StepConverged);
        }
        if self.evaluations >= settings.max_evaluations {
            return Trial::Stopped(Stop::Evaluations);
        }
        if accepted { Trial::Accepted } else { Trial::Rejected }
    }

    /// The trial point in the box, and the way there.
    fn projected_step(&self, model: &Model) -> (Vec<f64>, Vec<f64>) {
        let p = model.step(self.radius);
        let mut x = self.x.clone();
        for (k, &i) in model.free.iter().enumerate() {
            x[i] = self.bounds.clamp(i, x[i] + p[k] / self.scale[i]);
        }
        let step = x.iter().zip(&self.x).map(|(new, old)| new - old).collect();
        (x, step)
    }

    fn update_radius(&mut self, ratio: f64, length: f64) {
        if ratio < 0.25 {
            self.radius = 0.25 * self.radius.min(length);
        } else if ratio > 0.75 {
            self.radius = self.radius.max(2.0 * length);
        }
    }
}

impl Model {
    /// D p of min |c + R p| with |D p| <= radius.
    fn step(&self, radius: f64) -> DVector<f64> {
        let smallest = 1e-14 * self.s.iter().copied().fold(0.0, f64::max);
        let along = |mu: f64| {
            DVector::from_fn(self.s.len(), |k, _| {
                let s = self.s[k];
                if s <= smallest { 0.0 } else { -self.uc[k] * s / (s * s + mu) }
            })
        };
        let mut mu = 0.0;
        let mut p = along(mu);
        for _ in 0..50 {
            let length = p.norm();
            if length <= 1.1 * radius {
                break;
            }
            // Newton on 1/|p(mu)| = 1/radius (More, Eq. 5.5).
            let slope: f64 = (0..self.s.len())
                .filter(|&k| self.s[k] > smallest)
                .map(|k| p[k] * p[k] / (self.s[k].powi(2) + mu))
                .sum();
            mu += length * length / slope * (length - radius) / radius;
            p = along(mu);
        }
        self.v_t.tr_mul(&p)
    }

    /// |c|^2 - |c + R p|^2 for a step over all parameters.
    fn reduction(&self, step: &[f64]) -> f64 {
        let p = DVector::from_iterator(self.free.len(), self.free.iter().map(|&i| step[i]));
        let change = &self.r * p;
        -(2.0 * self.c.dot(&change) + change.norm_squared())
    }
}

/// U' c, singular values and V' of a square matrix.
fn singular(a: DMatrix<f64>, c: &DVector<f64>) -> (DVector<f64>, DVector<f64>, DMatrix<f64>) {
    let n = a.ncols();
    if n == 0 {
        return (DVector::zeros(0), DVector::zeros(0), a);
    }
    let svd = SVD::new(a, true, true);
    match (svd.u, svd.v_t) {
        (Some(u), Some(v_t)) => (u.tr_mul(c), svd.singular_values, v_t),
        _ => (DVector::zeros(n), DVector::zeros(n), DMatrix::identity(n, n)),
    }
}

/// (r(x + h) - r(x)) / h with h = sqrt(eps) |x|, backwards at an upper bound.
pub fn forward_differences<P: Residuals + ?Sized>(
    problem: &P,
    x: &[f64],
    r: &[f64],
    bounds: &Bounds,
) -> Vec<Vec<f64>> {
    let mut moved = x.to_vec();
    let mut columns = Vec::with_capacity(x.len());
    for i in 0..x.len() {
        let h = f64::EPSILON.sqrt() * if x[i] == 0.0 { 1.0 } else { x[i].abs() };
        moved[i] = if x[i] + h <= bounds.upper(i) { x[i] + h } else { x[i] - h };
        let h = moved[i] - x[i];
        let mut column = vec![0.0; r.len()];
        problem.residuals(&moved, &mut column);
        column.iter_mut().zip(r).for_each(|(c, r)| *c = (*c - r) / h);
        columns.push(column);
        moved[i] = x[i];
    }
    columns
}

#[cfg(test)]
#[path = "levenberg_marquardt_tests.rs"]
mod tests;
