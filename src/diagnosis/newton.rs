//! All parameters of a trial moved at once.
//!
//! Refining one nonlinear parameter after the other stops short where several make up for each
//! other (a slip angle for a hysteresis for a stiffness). Steps of Gauss and Newton do not: linear
//! parameters are solved for together with small changes of the nonlinear ones, whose columns are
//! their slopes (Golub, Pereyra, "Separable nonlinear least squares", Inverse Problems 19, 2003).

use super::fit::{Fit, expected};
use super::trial::{Trial, evaluate, linear_bounds, neighbours, settled};
use crate::regression::Column;
use crate::regression::bounds::Bounds;

const STEPS: usize = 6;
/// Gains that are worth another step, nats.
const SETTLED: f64 = 0.1;
/// Shares of a step, tried one after the other until one gains.
const SHARES: [f64; 3] = [1.0, 0.5, 0.2];
/// Step of the difference that gives a slope, as a share of the distance between the neighbouring starts.
const DIFFERENCE: f64 = 1e-3;

/// The trial where no step gains any more, within its neighbouring starts.
pub fn descend(fit: &Fit<'_>, mut best: Trial) -> Trial {
    let free: Vec<usize> = best.searched().into_iter().filter(|&i| !settled(&best, i)).collect();
    if free.is_empty() || best.candidate.senses() {
        return best;
    }
    for _ in 0..STEPS {
        let Some(next) = step(fit, &best, &free) else { break };
        let gained = next.ahead_of(&best);
        best = next;
        if gained < SETTLED {
            break;
        }
    }
    best
}

fn step(fit: &Fit<'_>, best: &Trial, free: &[usize]) -> Option<Trial> {
    let ends: Vec<[f64; 2]> = free.iter().map(|&i| neighbours(best, i, fit.data.twin)).collect();
    let raw = fit.raw(best.candidate, &best.nonlinear);
    let mut expected = expected(fit.data, best.candidate, &best.nonlinear, &raw);
    let mut columns = Column::all(&raw, &fit.metric);
    columns.extend(free.iter().zip(&ends).map(|(&i, ends)| slope(fit, best, i, *ends)));
    expected.resize(columns.len(), f64::INFINITY);
    let projected = fit.system.project(&columns, &expected);
    let (x, _) = projected.solve(&bounds(fit, best, free, &ends)?);
    let change = &x.as_slice()[best.linear.len()..];
    let moved = |share: f64| {
        let mut nonlinear = best.nonlinear.clone();
        free.iter().zip(change).for_each(|(&i, dx)| nonlinear[i] += share * dx);
        evaluate(fit, best, nonlinear)
    };
    SHARES.into_iter().map(moved).find(|t| t.gain > best.gain)
}

/// d torque / d nonlinear parameter `i` at the trial's linear parameters, N.m per unit.
fn slope(fit: &Fit<'_>, best: &Trial, i: usize, [below, above]: [f64; 2]) -> Column {
    let step = DIFFERENCE * (above - below);
    let at = |value: f64| {
        let mut nonlinear = best.nonlinear.clone();
        nonlinear[i] = value;
        fit.columns(best.candidate, &nonlinear)
    };
    let (low, high) = (best.nonlinear[i] - step, best.nonlinear[i] + step);
    let (low, high) = (low.max(below), high.min(above));
    let per_unit = 1.0 / (high - low).max(f64::MIN_POSITIVE);
    let mut sum = Column::zeros(fit.squares.len());
    for (columns, sign) in [(at(high), per_unit), (at(low), -per_unit)] {
        for (column, c) in columns.iter().zip(&best.linear) {
            sum.gather(sign * c, column);
        }
    }
    sum
}

/// Bounds of the linear parameters, and of the changes of the nonlinear ones.
fn bounds(fit: &Fit<'_>, best: &Trial, free: &[usize], ends: &[[f64; 2]]) -> Option<Bounds> {
    let linear = linear_bounds(best.candidate, fit.data.twin);
    let own = 0..best.linear.len();
    let change = |end: usize| free.iter().zip(ends).map(move |(&i, e)| e[end] - best.nonlinear[i]);
    let lower = own.clone().map(|i| linear.lower(i)).chain(change(0)).collect();
    let upper = own.map(|i| linear.upper(i)).chain(change(1)).collect();
    Bounds::new(lower, upper).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::{Candidate, Place};
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::diagnosis::refine::refine;
    use crate::diagnosis::screen::screen;
    use crate::effects::find;
    use crate::signals::testing::samples;
    use crate::twin::Twin;

    /// Stiffness, hysteresis, rest angle and slip angle of a cable make up for each other.
    const CABLE: [f64; 4] = [0.7, 0.08, 0.69, 0.28];
    const JOINT: usize = 3;

    #[test]
    fn parameters_that_make_up_for_each_other_are_found_together() {
        let twin = Twin::default();
        let mut made = samples(6, 4000, |j, t| {
            0.6 * (0.9 * t + j as f64).sin() + 0.3 * ((1.7 + 0.3 * j as f64) * t).sin()
        });
        let cable = find("cable_spring").unwrap();
        let motion = twin.motion(&made);
        let columns = cable.columns(&motion, JOINT, &CABLE[2..]);
        let mut torque = twin.torque(&motion);
        for (column, value) in columns.iter().zip(CABLE) {
            torque.joint_mut(JOINT).iter_mut().zip(column).for_each(|(t, c)| *t += value * c);
        }
        made.torque = torque;
        let floor = noise_floor(&made, &twin);
        let evidence = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&evidence]);
        let fit = Fit::plain(&data, Model::of(&twin));
        let candidate = Candidate::new(cable, Place::Joint(JOINT));
        let start = screen(&fit, &[candidate]).remove(0).trial;
        let found = refine(&fit, &start);
        let values = found.linear.iter().chain(&found.nonlinear);
        for (value, truth) in values.zip(CABLE) {
            assert!((value / truth - 1.0).abs() < 0.01, "{:?} {:?}", found.linear, found.nonlinear);
        }
    }

    /// A value that hardly left a start is not caught between that start and its mirror image.
    #[test]
    fn a_value_beside_a_start_still_has_room() {
        let twin = Twin::default();
        let made = samples(6, 2000, |j, t| 0.6 * (0.9 * t + j as f64).sin());
        let floor = noise_floor(&made, &twin);
        let evidence = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&evidence]);
        let fit = Fit::plain(&data, Model::of(&twin));
        let stribeck = find("stribeck").unwrap();
        let candidate = Candidate::new(stribeck, Place::Joint(0));
        let mut trial = screen(&fit, &[candidate]).remove(0).trial;
        let first = trial.starts.iter().map(|s| s[0]).fold(f64::INFINITY, f64::min);
        for factor in [1.0, 1.0 - 1e-9, 1.0 + 1e-9] {
            trial.nonlinear[0] = first * factor;
            let [below, above] = neighbours(&trial, 0, fit.data.twin);
            assert!(below < 0.9 * first && above > 1.1 * first, "{below} {first} {above}");
        }
    }
}
