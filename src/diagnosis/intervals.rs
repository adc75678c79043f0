//! Intervals of the causes' parameters.
//!
//! From the information matrix of all linear parameters and of the nonlinear ones that were
//! searched (their columns by central differences), samples counted by what is independent in the
//! residual. Where a step of Gauss and Newton on the check recording moves a value further than
//! both variances allow, signatures are not exact and the interval is widened by that ratio
//! (Birge, "The calculation of errors by the method of least squares", Phys. Rev. 40, 1932). The ends
//! of a window of time are told otherwise (`windows`).

use nalgebra::DVector;

use super::columns::Blocks;
use super::evidence::Evidence;
use super::model::{Built, Fit, Model};
use super::rank::effective_shares;
use super::system::System;
use super::{Value, slow, windows};
use crate::effects::Role;
use crate::statistics::normal_quantile;

/// Of the intervals.
pub const LEVEL: f64 = 0.9;
/// Of a nonlinear parameter, relative; a hundredth of its range for zero.
const DIFFERENCE: f64 = 1e-3;
/// The same where columns follow a reference and may jump: what they do over a small step says nothing
/// of what they do over a wide one.
const WIDE_DIFFERENCE: f64 = 0.2;

/// Values of every cause with intervals, in the order of the causes; `left` is what the fit leaves
/// of the check recording. Of joints that give way those of slow torque, which tells them better.
pub fn values(fit: &Fit<'_, '_>, check: &Evidence<'_>, left: &Blocks) -> Vec<Vec<Value>> {
    let mut values = of_fit(fit, check, left);
    for (i, of_cause) in slow::values(fit, check).into_iter().flatten() {
        values[i] = of_cause;
    }
    values
}

/// The same of a fit as it is.
pub(super) fn of_fit(fit: &Fit<'_, '_>, check: &Evidence<'_>, left: &Blocks) -> Vec<Vec<Value>> {
    let (on_fit, places) = step(fit, fit.evidence, &fit.system.residual);
    let (on_check, _) = step(fit, check, left);
    let variance = |column: usize| {
        let own = on_fit.variance(column);
        let moved = (on_check.x[column] - on_fit.x[column]).powi(2);
        own * (moved / (own + on_check.variance(column)).max(f64::MIN_POSITIVE)).max(1.0)
    };
    let wide = normal_quantile(1.0 - LEVEL);
    let cause = |i: usize| {
        let values = fit.values(i);
        let candidate = fit.model.causes[i].candidate;
        let parameters = candidate.effect.about().parameters.iter().zip(values).enumerate();
        let windows = windows::intervals(fit, i);
        let window = |k: usize| {
            let at = |(end, _): &&(usize, [f64; 2])| candidate.linear() + end == k;
            windows.as_ref()?.iter().find(at).map(|(_, ends)| *ends)
        };
        let value = |(k, (p, value)): (usize, (&crate::effects::Parameter, f64))| {
            let half = places[i][k].map_or(0.0, |column| wide * variance(column).sqrt());
            let [low, high] = window(k).unwrap_or([value - half, value + half]);
            let [min, max] = candidate.range(k, fit.evidence.twin);
            let near = 1e-3 * (max - min).min(1e6);
            Value {
                name: p.name.into(),
                unit: p.unit.into(),
                value,
                low: low.max(min),
                high: high.min(max),
                at_bound: places[i][k].is_some()
                    && value != p.null
                    && (value <= min || value >= max - near),
            }
        };
        let own = parameters.filter(|(_, (p, _))| !p.is_reference());
        own.map(value).collect()
    };
    (0..fit.model.causes.len()).map(cause).collect()
}

/// Column of each parameter, cause by cause; `None` where it was not searched.
type Places = Vec<Vec<Option<usize>>>;

/// How far all parameters would move to meet what is left of a recording, and where they are.
fn step(fit: &Fit<'_, '_>, evidence: &Evidence<'_>, left: &Blocks) -> (System, Places) {
    let (columns, places) = columns(fit, evidence);
    let shares = effective_shares(left);
    let weights = evidence.weights(&left.squares());
    let weights = weights.iter().zip(&shares).map(|(w, s)| w * s).collect();
    let mut priors = fit.model.priors();
    priors.resize(columns.len(), f64::INFINITY);
    (System::solve(columns, left, weights, &priors), places)
}

/// All columns on a recording, and where each parameter's is. What a bound holds at zero is as
/// uncertain as the rest, and makes the rest as uncertain.
fn columns(fit: &Fit<'_, '_>, evidence: &Evidence<'_>) -> (Vec<Blocks>, Places) {
    let mut free = fit.model.clone();
    free.causes.iter_mut().for_each(|t| t.held.fill(false));
    let mut columns = Built::new(evidence, &free).columns;
    let mut places = Vec::new();
    for (i, term) in fit.model.causes.iter().enumerate() {
        let linear: Vec<usize> = fit.model.range(i).collect();
        let mut of_cause = Vec::new();
        for (k, p) in term.candidate.effect.about().parameters.iter().enumerate() {
            of_cause.push(match p.role {
                Role::Linear => Some(linear[k]),
                Role::Nonlinear if term.searched.contains(&(k - linear.len())) => {
                    columns.push(slope(fit, evidence, i, k - linear.len(), p));
                    Some(columns.len() - 1)
                }
                Role::Nonlinear => None,
            });
        }
        places.push(of_cause);
    }
    (columns, places)
}

/// d torque / d nonlinear parameter `k` of cause `i`, N.m per unit.
fn slope(
    fit: &Fit<'_, '_>,
    evidence: &Evidence<'_>,
    i: usize,
    k: usize,
    p: &crate::effects::Parameter,
) -> Blocks {
    let term = &fit.model.causes[i];
    let value = term.nonlinear[k];
    let follows = term.candidate.effect.about().parameters.iter().any(|p| p.is_reference());
    let share = if follows { WIDE_DIFFERENCE } else { DIFFERENCE };
    let step = if value != 0.0 { share * value.abs() } else { 0.01 * (p.max - p.min) };
    let at = |value: f64| {
        let mut model = fit.model.clone();
        model.causes[i].nonlinear[k] = value;
        predicted(evidence, &model, &fit.system.x)
    };
    let mut slope = at(value + step);
    slope.add_scaled(-1.0, &at(value - step));
    slope.0.iter_mut().flatten().for_each(|s| *s /= 2.0 * step);
    slope
}

/// What a model gives at the values `x`, less the recorded torque, N.m.
pub(super) fn predicted(evidence: &Evidence<'_>, model: &Model, x: &DVector<f64>) -> Blocks {
    let built = Built::new(evidence, model);
    let mut sum = built.y;
    sum.0.iter_mut().flatten().for_each(|v| *v = -*v);
    built.columns.iter().zip(x.iter()).for_each(|(c, x)| sum.add_scaled(*x, c));
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::{Candidate, Place, Term};
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::testing::{noisy, samples};
    use crate::effects::find;
    use crate::twin::Twin;

    /// A spring without hysteresis: that it is held at zero does not make it known.
    #[test]
    fn what_a_bound_holds_has_an_interval_too() {
        let twin = Twin::default();
        let mut made = samples(6, 3000, |j, t| 0.6 * ((0.9 + 0.1 * j as f64) * t).sin());
        made.torque = twin.torque(&twin.motion(&made));
        noisy(&mut made, 0.3);
        let floor = noise_floor(&made, &twin);
        let evidence = Evidence::new(&twin, &made, &floor).unwrap();
        let effect = find("maxwell_slip").unwrap();
        let candidate = Candidate { effect, place: Place::Joint(1) };
        let held = vec![true, false, false];
        let term = Term { held, ..Term::new(candidate, vec![0.01]) };
        let fit = Fit::new(&evidence, Model::of(&twin).with(term));
        let values = of_fit(&fit, &evidence, &fit.system.residual);
        let held = &values[0][0];
        assert!(held.value == 0.0 && held.low == 0.0 && held.high > 0.01, "{held:?}");
    }
}
