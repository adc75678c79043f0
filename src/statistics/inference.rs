//! Three conventions for intervals and tests, side by side.

use nalgebra::{DMatrix, DVector};

use super::{
    Cycle, Design, LongRun, PValue, StatisticsError, cosine_covariance, model_covariance,
    normal_two_sided, student_quantile, student_two_sided,
};

/// The paper's multiplier of the standard error for 99 %.
const PAPER_Z: f64 = 2.58;

/// One parameter by one convention. All NaN (p = 1) where the data do not determine it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Inference {
    pub standard_error: f64,
    /// Infinite: the statistic is normal.
    pub dof: f64,
    /// (value - null) / standard error.
    pub statistic: f64,
    /// Two-sided, of value = null.
    pub p: f64,
    /// Finite where p underflows to 0.
    pub log10_p: f64,
    pub low: f64,
    pub high: f64,
}

/// One entry per parameter in each convention.
#[derive(Debug, Clone, PartialEq)]
pub struct Inferences {
    /// Robust to autocorrelation and changing spread of the residual; the one to believe.
    pub robust: Vec<Inference>,
    /// sigma^2 (J^T J)^-1 with Student's t: right if the residuals are white.
    pub asymptotic: Vec<Inference>,
    /// The paper's Eq. 7 to 11 (bounds the right way round): the standard deviation is divided by
    /// sqrt(n) once more, so every interval is sqrt(n) too narrow; 2.58 whatever the level.
    pub paper: Vec<Inference>,
    pub design: Design,
    /// Standard deviation of the residual with n - rank degrees of freedom.
    pub sigma: f64,
}

/// Tests `values` (least-squares estimates with prediction Jacobian `jacobian`, rows x parameters,
/// and `residual` = measured - predicted) against `null`, with intervals at `level` (0.99).
/// `slots`: integer time of each row, increasing; a step of 1 joins neighbours, a larger one says
/// that rows between were masked ([`crate::signals::Rows::slots`]). What comes again with the motion,
/// every `cycle`, counts once.
pub fn infer(
    values: &[f64],
    null: &[f64],
    jacobian: &DMatrix<f64>,
    residual: &[f64],
    slots: &[usize],
    cycle: Option<Cycle>,
    level: f64,
) -> Result<Inferences, StatisticsError> {
    check(values, null, jacobian, residual, slots, level)?;
    let design = Design::new(jacobian)?;
    let residual = DVector::from_column_slice(residual);
    let (n, dof) = (residual.len() as f64, (residual.len() - design.rank()) as f64);
    let sigma2 = residual.norm_squared() / dof;
    let unit = design.unit_covariance();
    let of = |k: usize, standard_error: f64, dof: f64, multiplier: f64| {
        let known = design.is_determined(k);
        estimate(values[k], null[k], standard_error, dof, multiplier, known)
    };
    let alpha = 1.0 - level;
    let white = |k: usize| (sigma2 * unit[(k, k)]).sqrt();
    let t = student_quantile(alpha, dof);
    let parameters = 0..values.len();
    let asymptotic = parameters.clone().map(|k| of(k, white(k), dof, t)).collect();
    let paper = parameters.clone().map(|k| of(k, white(k) / n.sqrt(), f64::INFINITY, PAPER_Z));
    let paper = paper.collect();
    let times = cycle.map_or(1.0, |cycle| cycle.design_effect(slots, residual.as_slice()));
    let candidates = robust_covariances(&design, &residual, slots)
        .map(|c| LongRun { covariance: c.covariance * times, dof: (c.dof / times).max(1.0) });
    let robust = parameters.map(|k| {
        let by =
            |c: &LongRun| of(k, c.covariance[(k, k)].sqrt(), c.dof, student_quantile(alpha, c.dof));
        wider(candidates.each_ref().map(by))
    });
    let robust = robust.collect();
    Ok(Inferences { robust, asymptotic, paper, design, sigma: sigma2.sqrt() })
}

/// (J^T J)^-1 Cov(J^T e) (J^T J)^-1 twice: without a model of e, and with an autoregression.
fn robust_covariances(design: &Design, residual: &DVector<f64>, slots: &[usize]) -> [LongRun; 2] {
    let basis = design.basis();
    let (n, rank) = (residual.len() as f64, design.rank() as f64);
    if design.rank() == 0 {
        return [(); 2].map(|()| LongRun { covariance: design.unit_covariance(), dof: n });
    }
    let mut scores = basis.clone();
    scores.column_iter_mut().for_each(|mut c| c.component_mul_assign(residual));
    let free = cosine_covariance(&scores, slots);
    let model = model_covariance(basis, residual.as_slice(), slots);
    let of_parameters = |c: LongRun, lost: f64| LongRun {
        covariance: design.sandwich(&c.covariance) * lost,
        dof: c.dof.min(n - rank),
    };
    [of_parameters(free, n / (n - rank)), of_parameters(model, 1.0)]
}

/// Each estimator misses what the other sees, and both err by being too narrow.
fn wider([a, b]: [Inference; 2]) -> Inference {
    if b.high - b.low > a.high - a.low { b } else { a }
}

fn estimate(value: f64, null: f64, se: f64, dof: f64, multiplier: f64, known: bool) -> Inference {
    if !known {
        let nan = f64::NAN;
        let (p, log10_p) = (1.0, 0.0);
        return Inference {
            standard_error: nan,
            dof,
            statistic: nan,
            p,
            log10_p,
            low: nan,
            high: nan,
        };
    }
    let statistic = (value - null) / se;
    let PValue { p, log10_p } = match dof.is_infinite() {
        true => normal_two_sided(statistic),
        false => student_two_sided(statistic, dof),
    };
    let (low, high) = (value - multiplier * se, value + multiplier * se);
    Inference { standard_error: se, dof, statistic, p, log10_p, low, high }
}

fn check(
    values: &[f64],
    null: &[f64],
    jacobian: &DMatrix<f64>,
    residual: &[f64],
    slots: &[usize],
    level: f64,
) -> Result<(), StatisticsError> {
    let (rows, parameters) = jacobian.shape();
    let length = |what, found, expected| match found == expected {
        true => Ok(()),
        false => Err(StatisticsError::Length { what, found, expected }),
    };
    length("the estimate", values.len(), parameters)?;
    length("the null hypothesis", null.len(), parameters)?;
    length("the residual", residual.len(), rows)?;
    length("the row times", slots.len(), rows)?;
    if rows < parameters + 2 {
        return Err(StatisticsError::TooFewRows { rows, parameters });
    }
    if let Some(row) = residual.iter().position(|e| !e.is_finite()) {
        return Err(StatisticsError::NotFinite { what: "the residual", row });
    }
    if let Some(row) = slots.windows(2).position(|w| w[1] <= w[0]) {
        return Err(StatisticsError::Order { row: row + 1 });
    }
    if level > 0.0 && level < 1.0 { Ok(()) } else { Err(StatisticsError::Level { level }) }
}
