//! Every candidate at all its starts, beside the discrepancy as it is and beside smaller ones.
//!
//! What a twin lacks has made the discrepancy as large as it is; with the cause in place it shrinks.
//! So a candidate is tried in several metrics, and the best of them counts.

use std::sync::Arc;

use rayon::prelude::*;

use super::candidate::Candidate;
use super::fit::{Fit, expected};
use super::sizes::Sizes;
use super::trial::{Trial, linear_bounds};
use super::{slopes, windows};
use crate::regression::bounds::Bounds;
use crate::regression::random_effects::Metric;
use crate::regression::{Column, Projected, Raw, System};

/// Steps by which all groups of the discrepancy are made smaller: as they are, a quarter, a
/// sixteenth, and none.
const SMALLER: [u8; 4] = [0, 2, 4, u8::MAX];
/// Rounds of setting references from what is fitted.
const FOLLOWED: usize = 2;

/// The best start of a candidate.
pub struct Screened {
    pub trial: Trial,
    /// Evidence gained, approximately, nats.
    pub gain: f64,
    /// Sizes of the discrepancy it was gained beside.
    pub sizes: Sizes,
}

/// The model of a fit beside a discrepancy of certain sizes.
struct Frame {
    sizes: Sizes,
    metric: Metric,
    system: System,
    squares: Vec<f64>,
    /// Log-likelihood less that of the fit, joint by joint.
    behind: Vec<f64>,
}

/// Every candidate's best start, best first.
pub fn screen(fit: &Fit<'_>, candidates: &[Candidate]) -> Vec<Screened> {
    let frames = frames(fit);
    let of = |candidate: &Candidate| best_start(fit, &frames, *candidate);
    let mut each: Vec<Screened> = candidates.par_iter().map(of).collect();
    each.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    each
}

fn frames(fit: &Fit<'_>) -> Vec<Frame> {
    let mut all: Vec<Sizes> = Vec::new();
    for less in SMALLER {
        let sizes = fit.sizes.smaller(less);
        if !all.contains(&sizes) {
            all.push(sizes);
        }
    }
    all.into_par_iter().map(|sizes| frame(fit, sizes)).collect()
}

fn frame(fit: &Fit<'_>, sizes: Sizes) -> Frame {
    let (metric, system) = fit.seen_beside(&sizes);
    let squares = system.residual.squares();
    let likelihood = |j: usize| fit.data.ln_likelihood(j, squares[j], &metric);
    let behind = (0..squares.len()).map(|j| likelihood(j) - fit.ln_likelihood(j)).collect();
    Frame { sizes, metric, system, squares, behind }
}

fn best_start(fit: &Fit<'_>, frames: &[Frame], candidate: Candidate) -> Screened {
    let starts = Arc::new(candidate.starts(&fit.motion(), fit.data.twin));
    let first = starts.first().cloned().unwrap_or_default();
    let mut best = Screened {
        trial: Trial::at(candidate, first, starts.clone()),
        gain: f64::NEG_INFINITY,
        sizes: fit.sizes.clone(),
    };
    let tried: Vec<&Vec<f64>> = match candidate {
        c if c.senses() => starts.iter().take(1).collect(),
        c if c.effect.lasts_a_while() => windows::promising(fit, candidate, &starts),
        _ => starts.iter().collect(),
    };
    let columns = |nonlinear: &&Vec<f64>| match candidate.senses() {
        true => Arc::new(vec![slopes::of_sensor(fit, candidate, nonlinear)]),
        false => fit.raw_kept(candidate, nonlinear),
    };
    let columns: Vec<Arc<Vec<Raw>>> = tried.iter().map(columns).collect();
    let all: Vec<&Raw> = columns.iter().flat_map(|raw| raw.iter()).collect();
    Raw::meet(&all, |j| frames.iter().any(|f| !f.metric.joints[j].is_plain()));
    for (nonlinear, raw) in tried.into_iter().zip(&columns) {
        try_at(fit, frames, (nonlinear, raw), &mut best);
    }
    follow(fit, frames, &mut best);
    best.gain -= best.trial.term().ln_starts();
    best
}

/// The candidate with these nonlinear values, which have the columns `raw`, where that is better than what was best.
fn try_at(
    fit: &Fit<'_>,
    frames: &[Frame],
    (nonlinear, raw): (&[f64], &[Raw]),
    best: &mut Screened,
) {
    let candidate = best.trial.candidate;
    let priors = expected(fit.data, candidate, nonlinear, raw);
    for frame in frames {
        let added = frame.add(fit, candidate, raw, &priors);
        let gain = added.likelihood - added.projected.narrowing(&priors);
        if gain > best.gain {
            best.gain = gain;
            best.sizes.clone_from(&frame.sizes);
            best.trial = at(&best.trial, nonlinear, added.linear);
        }
    }
}

/// References follow from what is fitted where they say how large the rest can be: how long a load is depends on what it
/// weighs, which no start says.
fn follow(fit: &Fit<'_>, frames: &[Frame], best: &mut Screened) {
    let candidate = best.trial.candidate;
    if best.trial.linear.is_empty() {
        return;
    }
    let expected = |nonlinear: &[f64]| candidate.expected(fit.data.twin, nonlinear);
    for _ in 0..FOLLOWED {
        let (before, mut nonlinear) = (best.gain, best.trial.nonlinear.clone());
        candidate.settle(&best.trial.linear, &mut nonlinear);
        if expected(&nonlinear) == expected(&best.trial.nonlinear) {
            return;
        }
        try_at(fit, frames, (&nonlinear, &fit.raw(candidate, &nonlinear)), best);
        if best.gain <= before {
            return;
        }
    }
}

/// The trial with these values; of a sensor the value is the nonlinear one.
fn at(trial: &Trial, nonlinear: &[f64], linear: Vec<f64>) -> Trial {
    match trial.candidate.senses() {
        true => {
            let p = &trial.candidate.effect.about().parameters[0];
            let inside = linear.iter().map(|v| p.clamp(v.max(nonlinear[0]))).collect();
            Trial { nonlinear: inside, ..trial.clone() }
        }
        false => Trial { nonlinear: nonlinear.to_vec(), linear, ..trial.clone() },
    }
}

/// What a candidate's columns add to the model of a frame.
struct Added {
    linear: Vec<f64>,
    /// Log-likelihood gained over the fit.
    likelihood: f64,
    projected: Projected,
}

impl Frame {
    fn add(&self, fit: &Fit<'_>, candidate: Candidate, raw: &[Raw], priors: &[f64]) -> Added {
        let columns = Column::all(raw, &self.metric);
        let touched = |j: &usize| columns.iter().any(|c| c.touches(*j));
        let touched: Vec<usize> = (0..self.squares.len()).filter(touched).collect();
        let projected = self.system.project(&columns, priors);
        if touched.is_empty() {
            let linear = vec![0.0; columns.len()];
            return Added { linear, likelihood: f64::NEG_INFINITY, projected };
        }
        let bounds = match candidate.senses() {
            true => {
                Bounds::new(vec![0.0], vec![f64::INFINITY]).unwrap_or_else(|_| Bounds::unbounded(1))
            }
            false => linear_bounds(candidate, fit.data.twin),
        };
        let (linear, gain) = projected.solve(&bounds);
        let weighted = |j: &usize| self.system.weights[*j] * self.squares[*j];
        let left: f64 = touched.iter().map(weighted).sum();
        let count: f64 = touched.iter().map(|j| fit.data.count(*j)).sum();
        let after = (1.0 - 2.0 * gain / left.max(f64::MIN_POSITIVE)).max(1e-6);
        let behind: f64 = touched.iter().map(|j| self.behind[*j]).sum();
        let likelihood = behind - 0.5 * count * after.ln();
        Added { linear: linear.as_slice().to_vec(), likelihood, projected }
    }
}
