//! How the torque of a model changes with nonlinear values, N.m per unit: columns to search by.

use std::sync::Arc;

use super::candidate::{Candidate, Term, acts_on, sense};
use super::fit::Fit;
use super::trial::{Trial, neighbours, settled};
use crate::regression::{Blocks, Raw};

/// Step of the difference that gives a slope, as a share of the way to a neighbouring start.
const DIFFERENCE: f64 = 1e-3;

/// Slopes of cause `k` of a model, for each nonlinear parameter that is searched and no reference.
pub fn of_cause(fit: &Fit<'_>, k: usize) -> Vec<Raw> {
    let term = &fit.model.causes[k];
    let starts = Arc::new(term.candidate.starts(&fit.motion(), fit.data.twin));
    let linear = fit.values(k)[..term.candidate.linear()].to_vec();
    let at = Trial { linear, ..Trial::at(term.candidate, term.nonlinear.clone(), starts) };
    let free = at.searched().into_iter().filter(|i| !settled(&at, *i));
    free.map(|i| {
        let [below, above] = neighbours(&at, i, fit.data.twin);
        // Towards the farther end, so that it stays within the range.
        let far = if above - at.nonlinear[i] > at.nonlinear[i] - below { above } else { below };
        slope(fit, k, i, DIFFERENCE * (far - at.nonlinear[i]))
    })
    .collect()
}

/// Slope of a sensor of `candidate` that is not in the model, around none.
pub fn of_sensor(fit: &Fit<'_>, candidate: Candidate, nonlinear: &[f64]) -> Raw {
    let mut sensors = fit.model.causes.clone();
    sensors.push(Term::new(candidate, nonlinear.to_vec()));
    otherwise_sensed(fit, candidate, &sensors, nonlinear[0])
}

/// Slope over nonlinear parameter `i` of cause `k`, by a difference of `step`.
fn slope(fit: &Fit<'_>, k: usize, i: usize, step: f64) -> Raw {
    let cause = &fit.model.causes[k];
    let mut moved = cause.nonlinear.clone();
    moved[i] += step;
    if cause.candidate.senses() {
        let mut sensors = fit.model.causes.clone();
        sensors[k].nonlinear = moved;
        return otherwise_sensed(fit, cause.candidate, &sensors, step);
    }
    let linear = &fit.values(k)[..cause.candidate.linear()];
    let at = |p: usize, nonlinear: &[f64]| fit.blocks(p, cause.candidate, nonlinear);
    let change = |p: usize| {
        let mut sum = Blocks((0..fit.data.joints()).map(|_| Vec::new()).collect());
        for (columns, sign) in [(at(p, &moved), 1.0), (at(p, &cause.nonlinear), -1.0)] {
            for (column, value) in columns.iter().zip(linear) {
                sum.gather(sign * value / step, column);
            }
        }
        sum
    };
    fit.data.raw((0..fit.data.parts.len()).map(change).collect())
}

/// What other `sensors` would show of the joints that `candidate` acts on, less what is shown, per
/// `step`.
fn otherwise_sensed(fit: &Fit<'_>, candidate: Candidate, sensors: &[Term], step: f64) -> Raw {
    let change = |p: usize| {
        let observed = fit.data.parts[p];
        let joint = |j: usize| {
            if !acts_on(candidate, j) {
                return Vec::new();
            }
            let modelled = fit.modelled(p).joint(j);
            let with = |sensors: &[Term]| observed.block(j, &sense(observed, sensors, j, modelled));
            let (before, after) = (with(&fit.model.causes), with(sensors));
            after.iter().zip(before).map(|(a, b)| (a - b) / step).collect()
        };
        Blocks((0..observed.joints()).map(joint).collect())
    };
    fit.data.raw((0..fit.data.parts.len()).map(change).collect())
}
