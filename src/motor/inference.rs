//! What the data say about each parameter, by three conventions, and what they cannot say.
//!
//! The Jacobian of the residual decides: its singular values (columns scaled to unit length) fall
//! off a cliff where a direction of parameters leaves the output unchanged. Derivatives are exact,
//! so the cliff ends at rounding: a ratio below 1e-9 counts as zero (`statistics::Design`).
//!
//! An undetermined direction v is removed by a gauge: one of its members g is held, which maps
//! an influence w_k on parameter k to w_k - (v_k / v_g) w_g. Under the gauge the other members'
//! estimates are those of the combinations theta_k theta_g^(-e_k/e_g), e = v / theta, which the data
//! do determine. No value of a member alone gets an interval. Whether a member is zero does
//! not depend on the gauge, so its test stands.

use nalgebra::{DMatrix, DVector};

use super::model::{COUNT, NAMES, index};
use super::output_error::OutputError;
use crate::identification::levenberg_marquardt::Residuals;
use crate::regression::bounds::Bounds;
use crate::statistics::{
    Design, LongRun, PValue, StatisticsError, cosine_covariance, normal_two_sided,
    student_quantile, student_two_sided,
};

/// The paper's multiplier of the standard error for 99 %, and its significance level.
const PAPER_Z: f64 = 2.58;
pub const ALPHA: f64 = 0.01;
/// Stretches of time that the robust covariance works with: influences within one are summed first.
const STRETCHES: usize = 2000;

/// Estimate and test by one convention. NaN where refused.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
    pub statistic: f64,
    /// Two-sided, of the value being zero.
    pub p: f64,
    /// Finite where `p` underflows.
    pub log10_p: f64,
}

impl Interval {
    pub const REFUSED: Self =
        Self { low: f64::NAN, high: f64::NAN, statistic: f64::NAN, p: f64::NAN, log10_p: f64::NAN };

    fn new(value: f64, standard_error: f64, dof: f64, multiplier: f64) -> Self {
        let statistic = value / standard_error;
        let PValue { p, log10_p } = match dof.is_infinite() {
            true => normal_two_sided(statistic),
            false => student_two_sided(statistic, dof),
        };
        let (low, high) =
            (value - multiplier * standard_error, value + multiplier * standard_error);
        Self { low, high, statistic, p, log10_p }
    }

    fn without_bounds(self) -> Self {
        Self { low: f64::NAN, high: f64::NAN, ..self }
    }

    fn scaled(self, by: f64) -> Self {
        Self { low: self.low * by, high: self.high * by, ..self }
    }
}

/// The three conventions for one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conventions {
    /// Robust to autocorrelation and changing spread of the residual, never narrower than
    /// `asymptotic`'s standard error; the one to believe.
    pub robust: Interval,
    /// sigma^2 (J^T J)^-1 with Student's t.
    pub asymptotic: Interval,
    /// The paper's Eq. 7 to 11 (bounds the right way round, |Z|): sqrt(n) too narrow.
    pub paper: Interval,
}

impl Conventions {
    const REFUSED: Self =
        Self { robust: Interval::REFUSED, asymptotic: Interval::REFUSED, paper: Interval::REFUSED };

    /// Tests without intervals.
    pub fn without_bounds(self) -> Self {
        self.map(Interval::without_bounds)
    }

    fn map(self, f: impl Fn(Interval) -> Interval) -> Self {
        Self { robust: f(self.robust), asymptotic: f(self.asymptotic), paper: f(self.paper) }
    }
}

/// A product of powers that the data determine although its factors are not.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Combination {
    /// Name, for example `J * R`.
    pub name: String,
    /// (parameter, exponent)
    pub factors: Vec<(&'static str, f64)>,
    pub value: f64,
    /// Robust, 99 %.
    pub low: f64,
    pub high: f64,
}

impl Combination {
    /// Value of this combination for other parameter values.
    pub fn of(&self, values: &[f64; COUNT]) -> f64 {
        let factor = |(name, e): &(&str, f64)| {
            let k = NAMES.iter().position(|n| n == name);
            k.map_or(f64::NAN, |k| values[k].powf(*e))
        };
        // The first factor has exponent 1 and may be negative.
        self.factors.iter().map(factor).product()
    }
}

/// Everything inferred at one estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Knowledge {
    /// `REFUSED` for given parameters; undetermined ones have tests but no bounds.
    pub parameters: [Conventions; COUNT],
    pub identifiable: [bool; COUNT],
    /// Members of every undetermined direction.
    pub undetermined: Vec<Vec<usize>>,
    pub combinations: Vec<Combination>,
    /// The cliff: smallest singular value that counts as nonzero, relative to the largest.
    pub smallest_kept: f64,
    /// Largest singular value that counts as zero, relative to the largest; `None`: none does.
    pub largest_dropped: Option<f64>,
    /// How far the estimate is from the minimum of the cost: length of the Gauss-Newton step in
    /// standard errors, |Q^T e| / sigma. Tests and intervals are about the minimum: from about 1 on
    /// they do not hold.
    pub newton_step: f64,
}

/// A Jacobian's factors with the estimate they belong to.
struct Analysis<'a> {
    problem: &'a OutputError<'a>,
    x: Vec<f64>,
    design: Design,
    /// measured - predicted, in units of the noise.
    residual: DVector<f64>,
    sigma2: f64,
}

/// Analyses the problem at `values`, of which the free ones are estimates.
///
/// # Errors
/// If the motor cannot be simulated there (the Jacobian is not finite).
pub fn analyse(
    problem: &OutputError<'_>,
    values: &[f64; COUNT],
) -> Result<Knowledge, StatisticsError> {
    let analysis = Analysis::new(problem, values)?;
    let held = analysis.gauge(None);
    let mut knowledge = Knowledge {
        parameters: [Conventions::REFUSED; COUNT],
        identifiable: [true; COUNT],
        undetermined: analysis.members(),
        combinations: Vec::new(),
        smallest_kept: analysis.relative_singular_value(analysis.design.rank().max(1) - 1),
        largest_dropped: (analysis.design.rank() < problem.free.len())
            .then(|| analysis.relative_singular_value(analysis.design.rank())),
        newton_step: analysis.newton_step(),
    };
    let under_gauge = analysis.infer(&held);
    for (slot, &k) in problem.free.iter().enumerate() {
        knowledge.parameters[k] = under_gauge[slot];
        knowledge.identifiable[k] = analysis.design.is_determined(slot);
    }
    for &slot in &held {
        let other = analysis.infer(&analysis.gauge(Some(slot)));
        knowledge.parameters[problem.free[slot]] = other[slot];
    }
    knowledge.combinations = analysis.combinations(&held, &under_gauge);
    for k in (0..COUNT).filter(|&k| !knowledge.identifiable[k]) {
        knowledge.parameters[k] = knowledge.parameters[k].without_bounds();
    }
    Ok(knowledge)
}

impl<'a> Analysis<'a> {
    fn new(problem: &'a OutputError<'a>, values: &[f64; COUNT]) -> Result<Self, StatisticsError> {
        let x: Vec<f64> = problem.free.iter().map(|&k| values[k]).collect();
        let rows = problem.count();
        let mut residual = vec![0.0; rows];
        problem.residuals(&x, &mut residual);
        let columns = problem.jacobian(&x, &residual, &Bounds::unbounded(x.len()));
        let jacobian = DMatrix::from_iterator(rows, x.len(), columns.into_iter().flatten());
        let design = Design::new(&jacobian)?;
        let residual = -DVector::from_vec(residual);
        let sigma2 = residual.norm_squared() / (rows - design.rank()) as f64;
        Ok(Self { problem, x, design, residual, sigma2 })
    }

    fn newton_step(&self) -> f64 {
        self.design.basis().tr_mul(&self.residual).norm() / self.sigma2.sqrt()
    }

    fn relative_singular_value(&self, at: usize) -> f64 {
        let singular = self.design.singular_values();
        singular[at] / singular[0]
    }

    fn members(&self) -> Vec<Vec<usize>> {
        let of = |slots: &[usize]| slots.iter().map(|&s| self.problem.free[s]).collect();
        self.design.undetermined().iter().map(|d| of(&d.parameters)).collect()
    }

    /// One member to hold per direction, R where it is one: resistance is what people measure.
    fn gauge(&self, except: Option<usize>) -> Vec<usize> {
        let mut held: Vec<usize> = Vec::new();
        for direction in self.design.undetermined() {
            let open = |s: &&usize| Some(**s) != except && !held.contains(s);
            let preferred = |s: &&usize| match self.problem.free[**s] {
                index::R => 0,
                index::L => 1,
                other => 2 + other,
            };
            if let Some(&slot) = direction.parameters.iter().filter(open).min_by_key(preferred) {
                held.push(slot);
            }
        }
        held
    }

    /// I - V (V_held)^-1 E_held: what holding members does to an influence.
    fn holding(&self, held: &[usize]) -> DMatrix<f64> {
        let (p, directions) = (self.x.len(), self.design.undetermined());
        let identity = DMatrix::identity(p, p);
        if held.is_empty() {
            return identity;
        }
        let v = DMatrix::from_fn(p, directions.len(), |i, d| directions[d].weights[i]);
        let pick = DMatrix::from_fn(held.len(), p, |h, i| f64::from(held[h] == i));
        match (&pick * &v).try_inverse() {
            Some(inverse) => identity - v * inverse * pick,
            None => identity,
        }
    }

    /// Tests and intervals of all free parameters, with some held.
    fn infer(&self, held: &[usize]) -> Vec<Conventions> {
        let map = self.holding(held);
        let covariance = &map * self.design.unit_covariance() * map.transpose() * self.sigma2;
        let influence = self.influences() * map.transpose();
        let stretches: Vec<usize> = (0..influence.nrows()).collect();
        let robust = cosine_covariance(&influence, &stretches);
        (0..self.x.len())
            .map(|slot| match held.contains(&slot) {
                true => Conventions::REFUSED,
                false => self.conventions(slot, covariance[(slot, slot)], &robust),
            })
            .collect()
    }

    fn conventions(&self, slot: usize, variance: f64, robust: &LongRun) -> Conventions {
        let n = self.residual.len() as f64;
        let dof = n - self.design.rank() as f64;
        let (value, white) = (self.x[slot], variance.max(0.0).sqrt());
        let cosine = (robust.covariance[(slot, slot)] * n / dof).sqrt();
        // Fitting takes the slow part out of the residual, which makes the cosines' variance too
        // small (measured: 4 % false positives for 1 %); white noise is the least there is.
        let (error, dof_of) = if cosine > white { (cosine, robust.dof) } else { (white, dof) };
        Conventions {
            robust: Interval::new(value, error, dof_of, student_quantile(ALPHA, dof_of)),
            asymptotic: Interval::new(value, white, dof, student_quantile(ALPHA, dof)),
            paper: Interval::new(value, white / n.sqrt(), f64::INFINITY, PAPER_Z),
        }
    }

    /// Influences of the residuals on each parameter, channels of one moment summed, then stretches.
    fn influences(&self) -> DMatrix<f64> {
        let samples = self.problem.samples();
        let stretch = samples.div_ceil(STRETCHES);
        let mut sums = DMatrix::zeros(samples.div_ceil(stretch), self.x.len());
        for slot in 0..self.x.len() {
            let weights = self.design.weights(slot);
            for (row, (w, e)) in weights.iter().zip(self.residual.iter()).enumerate() {
                sums[(row % samples / stretch, slot)] += w * e;
            }
        }
        sums
    }

    /// Every member of a direction that is not held, in terms of the held one.
    fn combinations(&self, held: &[usize], under_gauge: &[Conventions]) -> Vec<Combination> {
        let mut found = Vec::new();
        for (direction, &g) in self.design.undetermined().iter().zip(held) {
            let exponent = |slot: usize| direction.weights[slot] / self.x[slot];
            for &slot in direction.parameters.iter().filter(|s| !held.contains(s)) {
                let power = -exponent(slot) / exponent(g);
                let factor = self.x[g].powf(rounded(power));
                let robust = under_gauge[slot].robust.scaled(factor);
                let names = [slot, g].map(|s| NAMES[self.problem.free[s]]);
                found.push(Combination {
                    name: product(names, rounded(power)),
                    factors: vec![(names[0], 1.0), (names[1], rounded(power))],
                    value: self.x[slot] * factor,
                    low: robust.low,
                    high: robust.high,
                });
            }
        }
        found
    }
}

/// Exponents are small whole numbers up to rounding.
fn rounded(power: f64) -> f64 {
    if (power - power.round()).abs() < 1e-3 { power.round() } else { power }
}

fn product([a, b]: [&str; 2], power: f64) -> String {
    match power {
        1.0 => format!("{a} * {b}"),
        -1.0 => format!("{a} / {b}"),
        _ => format!("{a} * {b}^{power:.3}"),
    }
}
