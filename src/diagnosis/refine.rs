//! Nonlinear parameters of a candidate, refined from the best of its starts.

use super::fit::Fit;
use super::likely::INCONSISTENT;
use super::newton::descend;
use super::trial::{Trial, evaluate, neighbours, settled};
use crate::regression::brent;

/// Rounds of refining one nonlinear parameter after the other.
const ROUNDS: usize = 5;
/// Least relative increase of the gain that makes another round worth it.
const WORTH_ANOTHER: f64 = 0.003;
/// Values looked at between the ends of a bracket with several optima.
const SCANNED: usize = 9;
/// Tolerance of a refined parameter, relative to the bracket (of its logarithm where positive).
const TOLERANCE: f64 = 0.01;
/// Rounds of setting references from what was fitted.
const SETTLING: usize = 4;

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
        let goes_on =
            searched.len() > 1 || searched.iter().any(|&i| is_at_end(fit, &began, &best, i));
        if best.gain - before < WORTH_ANOTHER * before || !goes_on {
            break;
        }
    }
    settle(fit, descend(fit, best))
}

/// Did nonlinear parameter `i` come to an end of where it was looked for? It may go on from there.
fn is_at_end(fit: &Fit<'_>, began: &Trial, now: &Trial, i: usize) -> bool {
    let ends = neighbours(began, i, fit.data.twin);
    let near = 2.0 * TOLERANCE * (ends[1] - ends[0]);
    ends.iter().any(|end| (now.nonlinear[i] - end).abs() < near)
}

/// Is reference `i` close to the value it refers to?
fn is_consistent(trial: &Trial, i: usize) -> bool {
    let mut should = trial.nonlinear.clone();
    trial.candidate.settle(&trial.linear, &mut should);
    (should[i] - trial.nonlinear[i]).abs() <= INCONSISTENT * should[i].abs()
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
    let [below, above] = neighbours(&best, i, fit.data.twin);
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
    let ends = |i: usize| neighbours(&best, i, fit.data.twin);
    let ([below_i, above_i], [below_k, above_k]) = (ends(i), ends(k));
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

/// The best trial on a line through the nonlinear parameters, between two ends.
fn line(
    fit: &Fit<'_>,
    best: Trial,
    i: usize,
    ends: [f64; 2],
    at: impl Fn(f64) -> Vec<f64>,
) -> Trial {
    let scan = best.candidate.effect.bracket(&best.nonlinear, i).is_some();
    let first = best.candidate.linear();
    let range = |i: usize| best.candidate.range(first + i, fit.data.twin);
    let ranges: Vec<[f64; 2]> = (0..best.nonlinear.len()).map(range).collect();
    let fixed = best.clone();
    let mut top = best;
    let mut cost = |u: f64| {
        let inside = at(u).iter().zip(&ranges).map(|(v, [min, max])| v.clamp(*min, *max)).collect();
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
    use crate::diagnosis::candidate::{Candidate, Place};
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::diagnosis::screen::screen;
    use crate::diagnosis::trial::linear_bounds;
    use crate::effects::find;
    use crate::signals::testing::samples;
    use crate::twin::Twin;

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
