//! Every candidate against what a fit leaves: linear parameters by least squares, nonlinear ones
//! from the effect's starts, then refined.

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;

use super::candidate::{Candidate, Term};
use super::columns::Blocks;
use super::model::{Fit, Model};
use crate::effects::{Parameter, Role};
use crate::identification::{bounds::Bounds, brent};

/// Rounds of refining one nonlinear parameter after the other.
const ROUNDS: usize = 2;
/// Of a refined parameter, relative to the bracket (of its logarithm where positive).
const TOLERANCE: f64 = 0.01;
/// Rounds of setting references from what was fitted.
const SETTLING: usize = 4;

/// A candidate with values, and what it gains in log-likelihood over the fit it is added to.
#[derive(Debug, Clone)]
pub struct Trial {
    pub candidate: Candidate,
    pub linear: Vec<f64>,
    pub nonlinear: Vec<f64>,
    pub gain: f64,
    /// Where the search began.
    pub starts: Arc<Vec<Vec<f64>>>,
}

impl Trial {
    pub fn term(&self) -> Term {
        let held = self.linear.iter().map(|v| *v == 0.0).collect();
        let (candidate, nonlinear) = (self.candidate, self.nonlinear.clone());
        Term { searched: self.searched(), held, ..Term::new(candidate, nonlinear) }
    }

    /// The nonlinear parameters that are searched: those that differ among the starts.
    pub fn searched(&self) -> Vec<usize> {
        let starts = &self.starts;
        let differs = |i: &usize| starts.iter().any(|s| s[*i] != starts[0][*i]);
        (0..self.nonlinear.len()).filter(differs).collect()
    }
}

/// The best start of every candidate, and the largest gain any candidate makes on each surrogate.
pub fn screen(
    fit: &Fit,
    candidates: &[Candidate],
    surrogates: &[Blocks],
) -> (Vec<Trial>, Vec<f64>) {
    let each: Vec<(Trial, Vec<f64>)> =
        candidates.par_iter().map(|c| best_start(fit, *c, surrogates)).collect();
    let mut largest = vec![0.0f64; surrogates.len()];
    for (_, gains) in &each {
        largest.iter_mut().zip(gains).for_each(|(l, g)| *l = l.max(*g));
    }
    (each.into_iter().map(|(trial, _)| trial).collect(), largest)
}

fn best_start(fit: &Fit, candidate: Candidate, surrogates: &[Blocks]) -> (Trial, Vec<f64>) {
    let starts = Arc::new(candidate.starts(&fit.motion()));
    let mut best = Trial {
        candidate,
        linear: vec![],
        nonlinear: vec![],
        gain: f64::NEG_INFINITY,
        starts: starts.clone(),
    };
    let mut largest = vec![0.0f64; surrogates.len()];
    for nonlinear in starts.iter() {
        let from = Trial { nonlinear: nonlinear.clone(), ..best.clone() };
        let trial = match candidate.senses() {
            true => with_sensor(fit, from),
            false => with_columns(fit, from, surrogates, &mut largest),
        };
        if trial.gain > best.gain {
            best = trial;
        }
    }
    (best, largest)
}

/// Bounds of the linear parameters.
pub fn linear_bounds(candidate: Candidate) -> Bounds {
    let linear: Vec<&Parameter> =
        candidate.effect.about().parameters.iter().filter(|p| p.role == Role::Linear).collect();
    let lower = linear.iter().map(|p| p.min).collect();
    let upper = linear.iter().map(|p| p.max).collect();
    Bounds::new(lower, upper).unwrap_or_else(|_| Bounds::unbounded(linear.len()))
}

fn with_columns(fit: &Fit, at: Trial, surrogates: &[Blocks], largest: &mut [f64]) -> Trial {
    let columns = fit.columns(at.candidate, &at.nonlinear);
    let bounds = linear_bounds(at.candidate);
    let projected = fit.system.project(&columns);
    let (linear, gain) = projected.solve(&projected.pull, &bounds);
    for (surrogate, largest) in surrogates.iter().zip(largest) {
        let pull: DVector<f64> = fit.system.pull(&columns, surrogate);
        *largest = largest.max(projected.solve(&pull, &bounds).1);
    }
    Trial { linear: linear.as_slice().to_vec(), gain, ..at }
}

/// A sensor changes every column: everything is fitted again.
fn with_sensor(fit: &Fit, at: Trial) -> Trial {
    let new = Fit::new(fit.evidence, fit.model.with(at.term()));
    let weights = &fit.system.weights;
    let change = fit.squares.iter().zip(&new.squares).zip(weights);
    let gain = change.map(|((before, after), w)| 0.5 * w * (before - after)).sum();
    Trial { gain, ..at }
}

/// The trial at other nonlinear parameters.
fn evaluate(fit: &Fit, trial: &Trial, nonlinear: Vec<f64>) -> Trial {
    let at = Trial { nonlinear, ..trial.clone() };
    match at.candidate.senses() {
        true => with_sensor(fit, at),
        false => with_columns(fit, at, &[], &mut []),
    }
}

/// Refines the nonlinear parameters that differ among the starts, between the neighbouring
/// starts, then lets references follow from what was fitted.
pub fn refine(fit: &Fit, start: &Trial) -> Trial {
    let free: Vec<usize> = start.searched().into_iter().filter(|&i| !settled(start, i)).collect();
    let mut best = settle(fit, start.clone());
    let rounds = if free.len() > 1 { ROUNDS } else { free.len() };
    for _ in 0..rounds {
        for &i in &free {
            best = along(fit, best, i);
        }
    }
    if free.is_empty() { best } else { settle(fit, best) }
}

/// Is parameter `i` a reference that follows from the linear ones?
fn settled(trial: &Trial, i: usize) -> bool {
    let mut moved = trial.nonlinear.clone();
    let linear: Vec<f64> = trial.linear.iter().map(|v| 1.7 * v + 1e-3).collect();
    trial.candidate.effect.settle(&linear, &mut moved);
    moved[i] != trial.nonlinear[i]
}

fn settle(fit: &Fit, mut trial: Trial) -> Trial {
    for _ in 0..SETTLING {
        let mut nonlinear = trial.nonlinear.clone();
        trial.candidate.effect.settle(&trial.linear, &mut nonlinear);
        if nonlinear == trial.nonlinear {
            break;
        }
        let next = evaluate(fit, &trial, nonlinear);
        if next.gain < 0.98 * trial.gain {
            break;
        }
        trial = next;
    }
    trial
}

/// The best value of nonlinear parameter `i`, the others as they are.
fn along(fit: &Fit, best: Trial, i: usize) -> Trial {
    let parameters = best.candidate.effect.about().parameters;
    let parameter = &parameters[best.candidate.linear() + i];
    let now = best.nonlinear[i];
    let starts = best.starts.clone();
    let others = starts.iter().map(|s| s[i]);
    let below = others.clone().filter(|v| *v < now).fold(parameter.min, f64::max);
    let above = others.filter(|v| *v > now).fold(parameter.max, f64::min);
    let by_ratio = below > 0.0 && now > 0.0;
    let to = |x: f64| if by_ratio { x.ln() } else { x };
    let from = |u: f64| if by_ratio { u.exp() } else { u };
    let mut top = best;
    let fixed = top.clone();
    let cost = |u: f64| {
        let mut nonlinear = fixed.nonlinear.clone();
        nonlinear[i] = from(u).clamp(parameter.min, parameter.max);
        let trial = evaluate(fit, &fixed, nonlinear);
        let cost = -trial.gain;
        if trial.gain > top.gain {
            top = trial;
        }
        cost
    };
    let (low, high) = (to(below), to(above));
    if high > low {
        brent::minimise(cost, low, high, TOLERANCE * (high - low));
    }
    top
}

/// The trial's candidate as one more cause of the model, everything fitted again.
pub fn adopt<'a, 'e>(fit: &Fit<'a, 'e>, model: &Model, trial: &Trial) -> Fit<'a, 'e> {
    Fit::new(fit.evidence, model.with(trial.term()))
}
