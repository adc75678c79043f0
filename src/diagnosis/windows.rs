//! Intervals of when a window of time begins and how long it lasts.
//!
//! What a recording says of an end changes by jumps, one at every sample that enters or leaves, and
//! no slope describes it: where a force is weak, or the joints stand, whole stretches are as good
//! as the fitted end. Each end is moved on its own, everything else kept, and the likelihood over
//! its places, all alike beforehand, gives the interval.

use nalgebra::{Matrix3, Vector3};

use super::candidate::Candidate;
use super::fit::Fit;
use super::independent::{LEVEL, independent};
use super::model::Model;
use crate::regression::{Column, Raw};

/// Loss of log-likelihood from which on an end is out of the question, nats.
const BEYOND: f64 = 12.0;
/// Each step of an end is this much longer than the one before, and by a sample at least.
const LONGER: f64 = 1.3;

/// Windows of a search that are tried in full, of each residual.
const PROMISING: usize = 4;

/// Starts of a candidate that lasts for a while: those whose window holds most that its columns explain, of
/// what the model leaves with the discrepancy and without; and those that are no windows.
pub fn promising<'s>(
    fit: &Fit<'_>,
    candidate: Candidate,
    starts: &'s [Vec<f64>],
) -> Vec<&'s Vec<f64>> {
    let longest = |a: &&Vec<f64>, b: &&Vec<f64>| a[1].total_cmp(&b[1]);
    let Some(whole) = starts.iter().max_by(longest) else { return Vec::new() };
    let (windows, others): (Vec<_>, Vec<_>) = starts.iter().partition(|s| s[2..] == whole[2..]);
    let columns = fit.raw_kept(candidate, whole);
    let residuals: [Vec<Vec<f64>>; 2] = [
        (0..fit.data.joints()).map(|j| fit.innovations(j)).collect(),
        fit.system.residual.rows.0.clone(),
    ];
    let mut chosen: Vec<&Vec<f64>> = others;
    for residual in &residuals {
        let sums = Sums::new(fit, candidate, &columns, residual);
        let mut gains: Vec<(f64, &Vec<f64>)> =
            windows.iter().map(|s| (sums.gain(s[0], s[0] + s[1]), *s)).collect();
        gains.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, start) in gains.into_iter().take(PROMISING) {
            if !chosen.contains(&start) {
                chosen.push(start);
            }
        }
    }
    chosen
}

/// Running sums over time of products of the columns with each other and with a residual, so that
/// any window costs two look-ups.
struct Sums {
    /// Time of every row, rising, s.
    time: Vec<f64>,
    /// Sums up to and without that row: C'C and C'r, weighted by 1/s^2.
    running: Vec<(Matrix3<f64>, Vector3<f64>)>,
}

impl Sums {
    fn new(fit: &Fit<'_>, candidate: Candidate, columns: &[Raw], residual: &[Vec<f64>]) -> Self {
        let mut rows: Vec<(f64, Matrix3<f64>, Vector3<f64>)> = Vec::new();
        for (j, residual) in residual.iter().enumerate() {
            let variance = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>() / r.len().max(1) as f64;
            let weight = 1.0 / variance(residual).max(fit.data.least(j)).max(f64::MIN_POSITIVE);
            let mut row = 0;
            for part in &fit.data.parts {
                let here = candidate.is_in(part.index);
                for &k in &part.rows[j] {
                    let at = |c: &Raw| c.rows.0[j].get(row).copied().unwrap_or(0.0);
                    let c = Vector3::from_iterator(columns.iter().map(at));
                    if here {
                        let pull = c * residual[row] * weight;
                        rows.push((part.samples.time(k), c * c.transpose() * weight, pull));
                    }
                    row += 1;
                }
            }
        }
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = (Matrix3::zeros(), Vector3::zeros());
        let mut running = vec![sum];
        for (_, square, pull) in &rows {
            sum = (sum.0 + square, sum.1 + pull);
            running.push(sum);
        }
        Self { time: rows.into_iter().map(|r| r.0).collect(), running }
    }

    /// Half the squares that one force over the window takes off.
    fn gain(&self, from: f64, until: f64) -> f64 {
        let at = |t: f64| self.time.partition_point(|time| *time < t);
        let ((a, b), (c, d)) = (self.running[at(from)], self.running[at(until)]);
        let (square, pull) = (c - a, d - b);
        let ridge = Matrix3::identity() * (1e-9 * square.trace() + f64::MIN_POSITIVE);
        (square + ridge).try_inverse().map_or(0.0, |inverse| 0.5 * pull.dot(&(inverse * pull)))
    }
}

/// Where an end may be.
struct Spread {
    /// Samples from the fitted place, of the first share.
    first: isize,
    /// Probabilities, sample by sample.
    shares: Vec<f64>,
}

/// Intervals of cause `i`, which has a window of time: [low, high] of its start and of its length, s; with
/// their places among the nonlinear parameters. `None` where it has none, or where it was not searched.
pub fn intervals(fit: &Fit<'_>, i: usize) -> Option<[(usize, [f64; 2]); 2]> {
    let term = &fit.model.causes[i];
    let (nonlinear, effect) = (&term.nonlinear, term.candidate.effect);
    let is_end = |k: &usize| effect.bracket(nonlinear, *k).is_some() && term.searched.contains(k);
    let ends: Vec<usize> = (0..nonlinear.len()).filter(is_end).collect();
    let [start, length] = ends[..] else { return None };
    let dt = fit.data.parts[0].samples.dt;
    let most = (0.5 * nonlinear[length] / dt) as isize;
    let moved = |by: [f64; 2]| {
        let mut model = fit.model.clone();
        let ends = &mut model.causes[i].nonlinear;
        ends[start] += by[0] * dt;
        ends[length] += (by[1] - by[0]) * dt;
        likelihood(fit, &model)
    };
    let first = Spread::of(most, |n| moved([n as f64, 0.0]));
    let last = Spread::of(most, |n| moved([0.0, n as f64]));
    let around = |k: usize, spread: &Spread| {
        // The end itself lies between two samples.
        let [low, high] = spread.interval();
        (k, [nonlinear[k] + (low - 1) as f64 * dt, nonlinear[k] + (high + 1) as f64 * dt])
    };
    Some([around(start, &first), around(length, &last.less(&first))])
}

/// Log-likelihood of a model, nats, the linear parameters as they are.
fn likelihood(fit: &Fit<'_>, model: &Model) -> f64 {
    let squares = Column::new(&fit.predicted(model), &fit.metric).squares();
    let each = squares.iter().zip(&fit.system.weights).zip(independent(fit));
    -0.5 * each.map(|((square, weight), share)| square * weight * share).sum::<f64>()
}

impl Spread {
    /// The distribution from log-likelihoods at up to `most` samples either way.
    fn of(most: isize, likelihood: impl Fn(isize) -> f64) -> Self {
        let fitted = likelihood(0);
        let walk = |sign: isize| {
            let (mut places, mut top) = (vec![(0, fitted)], fitted);
            let mut n = 0;
            while n < most && top - places[places.len() - 1].1 < BEYOND {
                n = ((LONGER * n as f64) as isize).max(n + 1).min(most);
                places.push((sign * n, likelihood(sign * n)));
                top = top.max(places[places.len() - 1].1);
            }
            places
        };
        let mut places = walk(-1);
        places.reverse();
        places.extend(walk(1).into_iter().skip(1));
        let top = places.iter().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
        let mut shares = Vec::new();
        for pair in places.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            let at = |n: isize| a + (b - a) * (n - from) as f64 / (to - from) as f64;
            shares.extend((from..to).map(|n| (at(n) - top).exp()));
        }
        shares.extend(places.last().map(|p| (p.1 - top).exp()));
        let sum: f64 = shares.iter().sum();
        shares.iter_mut().for_each(|s| *s /= sum);
        Self { first: places[0].0, shares }
    }

    /// Distribution of the difference of two ends that are independent of each other.
    fn less(&self, other: &Self) -> Self {
        let beyond = other.shares.len() - 1;
        let mut shares = vec![0.0; self.shares.len() + beyond];
        for (i, a) in self.shares.iter().enumerate() {
            for (k, b) in other.shares.iter().enumerate() {
                shares[i + beyond - k] += a * b;
            }
        }
        Self { first: self.first - other.first - beyond as isize, shares }
    }

    /// First and last place, in samples, with as much on either side as the level leaves out.
    fn interval(&self) -> [isize; 2] {
        let reached = |part: f64| {
            let mut sum = 0.0;
            let passed = |share: &f64| {
                sum += share;
                sum >= part
            };
            let place = self.shares.iter().position(passed).unwrap_or(self.shares.len() - 1);
            self.first + place as isize
        };
        [reached(0.5 * (1.0 - LEVEL)), reached(0.5 * (1.0 + LEVEL))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve places as good as the fitted one after it, none before it.
    fn plateau() -> Spread {
        Spread::of(100, |n| if (0..=12).contains(&n) { 0.0 } else { -1e3 })
    }

    #[test]
    fn a_sharp_end_is_where_it_is_and_a_plateau_is_as_wide_as_it_is() {
        let sharp = Spread::of(100, |n| -50.0 * (n as f64).abs());
        assert_eq!(sharp.interval(), [0, 0]);
        let [low, high] = plateau().interval();
        assert!((0..=1).contains(&low) && (11..=14).contains(&high), "{low} {high}");
        let long = Spread::of(100, |_| 0.0);
        assert_eq!(long.interval(), [-90, 90]);
    }

    #[test]
    fn a_length_is_as_sure_as_both_its_ends() {
        let weak = Spread::of(1000, |n| -0.1 * (n as f64).abs());
        let sharp = Spread::of(1000, |n| -50.0 * (n as f64).abs());
        assert_eq!(weak.less(&sharp).interval(), weak.interval());
        let [low, high] = plateau().less(&sharp).interval();
        assert_eq!([low, high], plateau().interval());
        let [low, high] = sharp.less(&plateau()).interval();
        assert_eq!([-high, -low], plateau().interval());
        // Laplace's of scale 10: 90 % within 23.
        let [low, high] = weak.interval();
        assert!(low == -high && (22..=24).contains(&high), "{low} {high}");
    }
}
