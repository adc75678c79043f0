//! Nonlinear parameters of a candidate, refined from the best of its starts.

use std::sync::Arc;

use super::candidate::{Candidate, Term};
use super::fit::{Fit, expected};
use super::newton::descend;
use crate::regression::{Column, Raw, bounds::Bounds, brent};
use crate::twin::Twin;

/// Rounds of refining one nonlinear parameter after the other.
const ROUNDS: usize = 5;
/// Least relative increase of the gain that makes another round worth it.
const WORTH_ANOTHER: f64 = 0.003;
/// Relative difference of a reference from its value that calls for refining.
const INCONSISTENT: f64 = 0.02;
/// Values looked at between the ends of a bracket with several optima.
const SCANNED: usize = 9;
/// Share of the distance between starts: a value that is closer to a start has hardly left it.
const AWAY: f64 = 0.25;
/// Tolerance of a refined parameter, relative to the bracket (of its logarithm where positive).
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
    /// Half the weighted squares of the residual where it acts: no gain is larger.
    pub most: f64,
    /// Where the search began.
    pub starts: Arc<Vec<Vec<f64>>>,
}

impl Trial {
    /// The candidate at one of its starts, not tried yet.
    pub fn at(candidate: Candidate, nonlinear: Vec<f64>, starts: Arc<Vec<Vec<f64>>>) -> Self {
        let (gain, most) = (f64::NEG_INFINITY, 0.0);
        Self { candidate, linear: vec![], nonlinear, gain, most, starts }
    }

    pub fn term(&self) -> Term {
        let held = self.linear.iter().map(|v| *v == 0.0).collect();
        let (candidate, nonlinear) = (self.candidate, self.nonlinear.clone());
        let (linear, searched) = (self.linear.clone(), self.searched());
        let starts = self.starts.len();
        Term { linear, searched, held, starts, ..Term::new(candidate, nonlinear) }
    }

    /// Log-likelihood it is ahead of other values of the same candidate, nats: gains are in units of
    /// what there was before, of which the better one may leave little.
    pub fn ahead_of(&self, other: &Self) -> f64 {
        let left = (self.most - self.gain).max(f64::MIN_POSITIVE);
        (self.gain - other.gain) * (self.most / left).max(1.0)
    }

    /// The nonlinear parameters that are searched: those that differ among the starts.
    pub fn searched(&self) -> Vec<usize> {
        let starts = &self.starts;
        let differs = |i: &usize| starts.iter().any(|s| s[*i] != starts[0][*i]);
        (0..self.nonlinear.len()).filter(differs).collect()
    }
}

/// A term of a model as a trial on the fit without it.
pub fn tried(fit: &Fit<'_>, term: &Term) -> Trial {
    let starts = Arc::new(term.candidate.starts(&fit.motion(), fit.data.twin));
    let at = Trial::at(term.candidate, term.nonlinear.clone(), starts);
    evaluate(fit, &at, term.nonlinear.clone())
}

/// Bounds of the linear parameters.
pub fn linear_bounds(candidate: Candidate, twin: &Twin) -> Bounds {
    let ranges = (0..candidate.linear()).map(|i| candidate.range(i, twin));
    let (lower, upper) = ranges.map(|[min, max]| (min, max)).unzip();
    Bounds::new(lower, upper).unwrap_or_else(|_| Bounds::unbounded(candidate.linear()))
}

/// What is expected of the linear parameters, standard deviations.
pub fn priors(fit: &Fit<'_>, candidate: Candidate, columns: &[Raw]) -> Vec<f64> {
    expected(fit.data, candidate, columns)
}

/// The trial at other nonlinear parameters.
pub fn evaluate(fit: &Fit<'_>, trial: &Trial, nonlinear: Vec<f64>) -> Trial {
    let at = Trial { nonlinear, ..trial.clone() };
    match at.candidate.senses() {
        true => with_sensor(fit, at),
        false => with_columns(fit, at),
    }
}

fn with_columns(fit: &Fit<'_>, at: Trial) -> Trial {
    let raw = fit.raw(at.candidate, &at.nonlinear);
    let columns: Vec<Column> = raw.iter().map(|c| Column::new(c, &fit.metric)).collect();
    let projected = fit.system.project(&columns, &priors(fit, at.candidate, &raw));
    let (linear, gain) = projected.solve(&linear_bounds(at.candidate, fit.data.twin));
    Trial { linear: linear.as_slice().to_vec(), gain, most: most(fit, &columns), ..at }
}

/// Half the weighted squares of what `fit` leaves at the joints that columns touch.
fn most(fit: &Fit<'_>, columns: &[Column]) -> f64 {
    let touched = |j: &usize| columns.iter().any(|c| c.touches(*j));
    let joints = (0..fit.squares.len()).filter(touched);
    joints.map(|j| 0.5 * fit.system.weights[j] * fit.squares[j]).sum()
}

/// A sensor changes every column: everything is fitted again.
fn with_sensor(fit: &Fit<'_>, at: Trial) -> Trial {
    let new = Fit::new(fit.data, fit.model.with(at.term()), fit.sizes.clone());
    let weights = &fit.system.weights;
    let change = fit.squares.iter().zip(&new.squares).zip(weights);
    let gain = change.map(|((before, after), w)| 0.5 * w * (before - after)).sum();
    Trial { gain, ..at }
}

/// Standard deviations of a trial's linear parameters, its nonlinear ones given and all others free,
/// in the noise that the trial leaves.
pub fn spread(fit: &Fit<'_>, trial: &Trial) -> Vec<f64> {
    let columns = fit.columns(trial.candidate, &trial.nonlinear);
    let most = trial.most.max(f64::MIN_POSITIVE);
    let noise = ((trial.most - trial.gain) / most).clamp(0.0, 1.0);
    let projected = fit.system.project(&columns, &vec![f64::INFINITY; columns.len()]);
    projected.variances().into_iter().map(|v| (noise * v).sqrt()).collect()
}

/// Refines the nonlinear parameters that differ among the starts, between the neighbouring
/// starts, and lets references follow from what was fitted. A reference that cannot follow, because
/// other parameters are still off, is refined as they are.
pub fn refine(fit: &Fit<'_>, start: &Trial) -> Trial {
    let searched = start.searched();
    let mut best = settle(fit, start.clone());
    for _ in 0..ROUNDS {
        let (before, began) = (best.gain, best.clone());
        for &i in searched.iter().filter(|&&i| !settled(start, i)) {
            best = along(fit, best, i);
        }
        for (i, k) in pairs_of_a_kind(start, &searched) {
            best = exchange(fit, best, i, k);
        }
        best = settle(fit, best);
        for &i in searched.iter().filter(|&&i| settled(start, i)) {
            if !is_consistent(&best, i) {
                best = along(fit, best, i);
            }
        }
        let goes_on = searched.len() > 1 || searched.iter().any(|&i| is_at_end(&began, &best, i));
        if best.gain - before < WORTH_ANOTHER * before || !goes_on {
            break;
        }
    }
    settle(fit, descend(fit, best))
}

/// Did nonlinear parameter `i` come to an end of where it was looked for? It may go on from there.
fn is_at_end(began: &Trial, now: &Trial, i: usize) -> bool {
    let ends = neighbours(began, i);
    let near = 2.0 * TOLERANCE * (ends[1] - ends[0]);
    ends.iter().any(|end| (now.nonlinear[i] - end).abs() < near)
}

/// Is reference `i` close to the value it refers to?
fn is_consistent(trial: &Trial, i: usize) -> bool {
    let mut should = trial.nonlinear.clone();
    trial.candidate.settle(&trial.linear, &mut should);
    (should[i] - trial.nonlinear[i]).abs() <= INCONSISTENT * should[i].abs()
}

/// Is parameter `i` a reference that follows from the linear ones?
pub fn settled(trial: &Trial, i: usize) -> bool {
    let mut moved = trial.nonlinear.clone();
    let linear: Vec<f64> = trial.linear.iter().map(|v| 1.7 * v + 1e-3).collect();
    trial.candidate.settle(&linear, &mut moved);
    moved[i] != trial.nonlinear[i]
}

fn settle(fit: &Fit<'_>, mut trial: Trial) -> Trial {
    for _ in 0..SETTLING {
        let mut nonlinear = trial.nonlinear.clone();
        trial.candidate.settle(&trial.linear, &mut nonlinear);
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

/// Parameters that can give to each other: of one unit, neither a reference.
fn pairs_of_a_kind(trial: &Trial, searched: &[usize]) -> Vec<(usize, usize)> {
    let of = |i: usize| &trial.candidate.effect.about().parameters[trial.candidate.linear() + i];
    let own = |i: &&usize| !of(**i).is_reference();
    let free: Vec<usize> = searched.iter().filter(own).copied().collect();
    let after = |i: usize| free.iter().copied().filter(move |k| *k > i);
    let pairs = free.iter().flat_map(|&i| after(i).map(move |k| (i, k)));
    pairs.filter(|(i, k)| of(*i).unit == of(*k).unit).collect()
}

/// The best value of nonlinear parameter `i`, the others as they are.
fn along(fit: &Fit<'_>, best: Trial, i: usize) -> Trial {
    let now = best.nonlinear.clone();
    let [below, above] = neighbours(&best, i);
    let by_ratio = below > 0.0 && now[i] > 0.0;
    let to = |x: f64| if by_ratio { x.ln() } else { x };
    let at = |u: f64| {
        let mut nonlinear = now.clone();
        nonlinear[i] = if by_ratio { u.exp() } else { u };
        nonlinear
    };
    line(fit, best, i, [to(below), to(above)], at)
}

/// What nonlinear parameter `i` gains `k` loses, as much as is best: the start of a stretch of time
/// moves while its end stays.
fn exchange(fit: &Fit<'_>, best: Trial, i: usize, k: usize) -> Trial {
    let now = best.nonlinear.clone();
    let ([below_i, above_i], [below_k, above_k]) = (neighbours(&best, i), neighbours(&best, k));
    let low = (below_i - now[i]).max(now[k] - above_k);
    let high = (above_i - now[i]).min(now[k] - below_k);
    let at = |u: f64| {
        let mut nonlinear = now.clone();
        nonlinear[i] += u;
        nonlinear[k] -= u;
        nonlinear
    };
    line(fit, best, i, [low, high], at)
}

/// The starts next to the value of nonlinear parameter `i`, other than one it hardly left; beyond
/// the last one as far as to the one before, within the range.
pub fn neighbours(trial: &Trial, i: usize) -> [f64; 2] {
    let parameter = &trial.candidate.effect.about().parameters[trial.candidate.linear() + i];
    let now = trial.nonlinear[i];
    if let Some(ends) = trial.candidate.effect.bracket(&trial.nonlinear, i) {
        return ends.map(|end| parameter.clamp(end));
    }
    // Evenly spaced in ratio or difference.
    let by_ratio = parameter.min > 0.0;
    let scale = |x: f64| if by_ratio { x.ln() } else { x };
    let mut starts: Vec<f64> = trial.starts.iter().map(|s| scale(s[i])).collect();
    starts.sort_by(f64::total_cmp);
    let gaps = starts.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > 0.0);
    let (now, away) = (scale(now), AWAY * gaps.fold(f64::INFINITY, f64::min));
    let below = starts.iter().rfind(|s| **s < now - away);
    let above = starts.iter().find(|s| **s > now + away);
    let [low, high] = match (below, above) {
        (Some(below), Some(above)) => [*below, *above],
        (Some(below), None) => [*below, 2.0 * now - below],
        (None, Some(above)) => [2.0 * now - above, *above],
        (None, None) => return [parameter.min, parameter.max],
    };
    [low, high].map(|end| parameter.clamp(if by_ratio { end.exp() } else { end }))
}

/// The best trial on a line through the nonlinear parameters, between two ends.
fn line(
    fit: &Fit<'_>,
    best: Trial,
    i: usize,
    ends: [f64; 2],
    at: impl Fn(f64) -> Vec<f64>,
) -> Trial {
    let scan = best.candidate.effect.bracket(&best.nonlinear, i).is_some();
    let parameters = &best.candidate.effect.about().parameters[best.candidate.linear()..];
    let fixed = best.clone();
    let mut top = best;
    let mut cost = |u: f64| {
        let inside = at(u).iter().zip(parameters).map(|(v, p)| p.clamp(*v)).collect();
        let trial = evaluate(fit, &fixed, inside);
        let cost = -trial.gain;
        if trial.gain > top.gain {
            top = trial;
        }
        cost
    };
    let [mut low, mut high] = ends;
    if high > low && scan {
        let step = (high - low) / (SCANNED - 1) as f64;
        let costs = (0..SCANNED).map(|k| low + step * k as f64).map(|u| (u, cost(u)));
        let best = costs.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(low, |(u, _)| u);
        (low, high) = ((best - step).max(low), (best + step).min(high));
    }
    if high > low {
        brent::minimise(&mut cost, low, high, TOLERANCE * (high - low));
    }
    top
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::Place;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::diagnosis::screen::screen;
    use crate::effects::find;
    use crate::signals::testing::samples;

    /// The drive's rotor may be lighter than the twin's; it cannot be lighter than none.
    #[test]
    fn a_rotor_can_lose_what_the_drive_has_of_it() {
        let (has, lost) = (1.0, -0.4);
        let mut twin = Twin::default();
        twin.drive.rotor_inertia = vec![has + lost; 6];
        let mut made = samples(6, 2000, |j, t| 0.6 * ((0.9 + 0.2 * j as f64) * t).sin());
        made.torque = twin.torque(&twin.motion(&made));
        twin.drive.rotor_inertia[3] = has;
        let floor = noise_floor(&made, &twin);
        let evidence = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&evidence]);
        let fit = Fit::plain(&data, Model::of(&twin));
        let effect = find("rotor_inertia").unwrap();
        let candidate = Candidate::new(effect, Place::Joint(3));
        let found = evaluate(&fit, &screen(&fit, &[candidate]).remove(0).trial, vec![]);
        // What is expected of effects pulls a little.
        assert!((found.linear[0] - lost).abs() < 1e-4, "{:?}", found.linear);
        assert_eq!(linear_bounds(candidate, &twin).lower(0), -has);
    }
}
