//! Intervals of a cause that fits in more than one way.
//!
//! Springs of presliding change places at another width and fit nearly as well, of which the slope at
//! the best width knows nothing. Along the one nonlinear parameter of such a cause the others are
//! fitted again and again (a profile likelihood: Venzon, Moolgavkar, "A method for computing
//! profile-likelihood-based confidence intervals", Applied Statistics 37(1), 1988), and what the fit does
//! not tell from the best belongs to the intervals.

use rayon::prelude::*;

use super::Value;
use super::candidate::Place;
use super::fit::Fit;
use super::independent::{LEVEL, independent};
use super::refine;
use super::trial::{self, Trial};
use crate::statistics::normal_quantile;

/// Values along the range, by equal ratios.
const POINTS: usize = 40;
/// Log-likelihood behind the best of an optimum that is looked at, nats.
const CLOSE_NATS: f64 = 6.0;
/// Halvings of the distance between two of them, to find where an interval ends.
const HALVINGS: usize = 5;

/// Widens the intervals of cause `i`, where it acts at one joint and has one nonlinear parameter.
pub fn widen(fit: &Fit<'_>, i: usize, values: &mut [Value]) {
    for Span { name, low, high } in spans(fit, i).unwrap_or_default() {
        for value in values.iter_mut().filter(|v| v.name == name) {
            value.low = value.low.min(low);
            value.high = value.high.max(high);
        }
    }
}

/// What the fit does not tell from the best, in the parameter's unit.
#[derive(Debug, Clone, PartialEq)]
struct Span {
    name: &'static str,
    low: f64,
    high: f64,
}

fn spans(fit: &Fit<'_>, i: usize) -> Option<Vec<Span>> {
    let term = &fit.model.causes[i];
    let Place::Joint(joint) = term.candidate.place else { return None };
    let share = independent(fit)[joint];
    let others = Fit::plain(fit.data, fit.model.without(i));
    let (k, mut trials) = along(&others, trial::tried(&others, term))?;
    let best = trials.iter().max_by(|a, b| a.gain.total_cmp(&b.gain))?.clone();
    let room = |t: &Trial| 0.5 * normal_quantile(1.0 - LEVEL).powi(2) - share * best.ahead_of(t);
    trials.extend(edges(&others, &trials, k, |t| room(t) >= 0.0));
    let mut spans: Vec<Span> = Vec::new();
    for (trial, room) in trials.iter().map(|t| (t, room(t))).filter(|(_, room)| *room >= 0.0) {
        let deviations = (2.0 * room / share).sqrt();
        let spread = trial::spread(&others, trial);
        let linear = trial.linear.iter().zip(spread).enumerate();
        let linear = linear.map(|(i, (value, sd))| (i, *value, deviations * sd));
        for (i, value, half) in linear.chain([(term.linear.len() + k, trial.nonlinear[k], 0.0)]) {
            let [min, max] = term.candidate.range(i, fit.data.twin);
            let name = term.candidate.effect.about().parameters[i].name;
            spans.push(Span { name, low: (value - half).max(min), high: (value + half).min(max) });
        }
    }
    Some(spans)
}

/// The trials closest to where those that are `inside` end.
fn edges(
    others: &Fit<'_>,
    trials: &[Trial],
    k: usize,
    inside: impl Fn(&Trial) -> bool + Sync,
) -> Vec<Trial> {
    let edge = |pair: &[Trial]| {
        let [mut within, mut beyond] = [pair[0].clone(), pair[1].clone()];
        if inside(&beyond) {
            std::mem::swap(&mut within, &mut beyond);
        }
        for _ in 0..HALVINGS {
            let mut nonlinear = within.nonlinear.clone();
            nonlinear[k] = (within.nonlinear[k] * beyond.nonlinear[k]).sqrt();
            let middle = trial::evaluate(others, &within, nonlinear);
            let end = if inside(&middle) { &mut within } else { &mut beyond };
            *end = middle;
        }
        within
    };
    let pairs: Vec<&[Trial]> = trials.windows(2).collect();
    pairs.into_par_iter().filter(|p| inside(&p[0]) != inside(&p[1])).map(edge).collect()
}

/// The cause from one end of its nonlinear parameter to the other in order, with itself and the
/// optima that this shows; and which parameter that is. `None` where there is more than one.
fn along(others: &Fit<'_>, now: Trial) -> Option<(usize, Vec<Trial>)> {
    let [k] = now.searched()[..] else { return None };
    let [min, max] = now.candidate.range(now.candidate.linear() + k, others.data.twin);
    if now.candidate.senses() || min <= 0.0 {
        return None;
    }
    let at = |step: usize| {
        let mut nonlinear = now.nonlinear.clone();
        nonlinear[k] = min * (max / min).powf(step as f64 / (POINTS - 1) as f64);
        trial::evaluate(others, &now, nonlinear)
    };
    let mut trials: Vec<Trial> = (0..POINTS).into_par_iter().map(at).collect();
    let found = optima(others, &trials);
    trials.extend(found.into_iter().chain([now]));
    trials.sort_by(|a, b| a.nonlinear[k].total_cmp(&b.nonlinear[k]));
    Some((k, trials))
}

/// Local optima among trials in order, refined, where they are hardly worse than the best.
fn optima(others: &Fit<'_>, trials: &[Trial]) -> Vec<Trial> {
    let gain = |i: usize| trials.get(i).map_or(f64::NEG_INFINITY, |t| t.gain);
    let Some(best) = trials.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)) else { return vec![] };
    let is_one = |i: &usize| gain(*i) > gain(i + 1) && gain(*i) >= gain(i.wrapping_sub(1));
    let close = |i: &usize| best.ahead_of(&trials[*i]) < CLOSE_NATS;
    let places: Vec<usize> = (0..trials.len()).filter(is_one).filter(close).collect();
    places.par_iter().map(|&i| refine::refine(others, &trials[i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::Candidate;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::intervals::of_fit;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::diagnosis::screen::screen;
    use crate::effects::find;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const JOINT: usize = 2;
    const LEVEL_NM: f64 = 5.0;
    const WIDTH_RAD: f64 = 0.004;

    /// One spring alone is the first at four times its width, the second, or the third at a quarter.
    #[test]
    fn springs_that_may_change_places_are_all_told() {
        let twin = Twin::default();
        let mut made = samples(6, 4000, |j, t| 0.6 * ((0.9 + 0.1 * j as f64) * t).sin());
        let effect = find("maxwell_slip").unwrap();
        let motion = twin.motion(&made);
        let spring = effect.columns(&motion, JOINT, &[WIDTH_RAD]).remove(1);
        made.torque = twin.torque(&motion);
        let torque = made.torque.joint_mut(JOINT);
        torque.iter_mut().zip(&spring).for_each(|(t, z)| *t += LEVEL_NM * z);
        noisy(&mut made, 0.5);
        let observed = Observed::new(0, &twin, &made, &noise_floor(&made, &twin)).unwrap();
        let data = Data::plain(vec![&observed]);
        let fit = Fit::plain(&data, Model::of(&twin));
        let candidate = Candidate::new(effect, Place::Joint(JOINT));
        let start = screen(&fit, &[candidate]).remove(0).trial;
        let fit = Fit::plain(&data, Model::of(&twin).with(refine::refine(&fit, &start).term()));
        let mut values = of_fit(&fit).remove(0);
        let told = |values: &[Value]| {
            let width = &values[3];
            let levels = values[..3].iter().all(|v| v.low < 1.0 && v.high > 0.9 * LEVEL_NM);
            levels && width.low < 0.3 * WIDTH_RAD && width.high > 3.5 * WIDTH_RAD
        };
        assert!(!told(&values), "{values:?}");
        widen(&fit, 0, &mut values);
        assert!(told(&values), "{values:?}");
    }
}
