//! What the causes leave of the check recording, and on what it depends.
//!
//! A curve over a variable is learned from what is left of the fit recording, and predicts what is
//! left of the check recording: the share of its mean square that this takes off says how far the
//! variable matters, without a law.

use rayon::prelude::*;

use super::answer::{Dependence, Unexplained, UnexplainedJoint};
use super::criteria::Criteria;
use super::fit::Fit;
use super::floor::Floor;
use super::observed::Observed;
use crate::regression::Blocks;
use crate::series::JointSeries;

/// Stretches of a variable's range with one mean each.
const BINS: usize = 24;
/// Variables told of a joint, and the least share of its mean square.
const TOLD: usize = 3;
const LEAST_SHARE: f64 = 0.05;

/// A recording, and what is left of it, N.m at its rows.
pub struct Left<'a> {
    pub observed: &'a Observed<'a>,
    pub residual: Blocks,
}

impl Left<'_> {
    /// Joint by joint, (N.m)^2.
    fn mean_squares(&self) -> Vec<f64> {
        let rows = self.observed.rows.iter().map(|rows| rows.len().max(1) as f64);
        self.residual.squares().into_iter().zip(rows).map(|(sum, rows)| sum / rows).collect()
    }

    /// Every joint counts alike, as in the gap, (N.m)^2.
    pub fn mean_square(&self) -> f64 {
        let joints = self.mean_squares();
        joints.iter().sum::<f64>() / joints.len().max(1) as f64
    }
}

/// Of the recording that was fitted and of the check recording `left` is what the causes leave, and `within` what links
/// and scales of torque within the twin's tolerances leave of that, where they help; `before` is of the check
/// recording. `last` has the discrepancy beside all causes.
pub fn unexplained(
    left: &[Left<'_>; 2],
    within: Option<&[Left<'_>; 2]>,
    before: &Left<'_>,
    floor: &[Floor],
    last: &Fit<'_>,
    criteria: &Criteria,
) -> Unexplained {
    let beyond = within.unwrap_or(left);
    let [after, rest] = [left, beyond].map(|both| both[1].mean_squares());
    let joint = |j: usize| UnexplainedJoint {
        joint: j + 1,
        rms_nm: after[j].sqrt(),
        beyond_tolerances_nm: within.map(|_| rest[j].sqrt()),
        noise_floor_nm: floor[j].noise_nm,
        discrepancy_nm: rms(&last.discrepancy(j)),
        depends_on: depends_on(beyond, j),
    };
    let louder: Vec<f64> = rest.iter().zip(floor).map(|(r, f)| r / f.noise_nm.powi(2)).collect();
    let noise_over_floor = noise_over_floor(&louder);
    let loud = louder.iter().any(|l| *l > criteria.above_noise * noise_over_floor);
    let (b, a) = (before.mean_square(), left[1].mean_square());
    Unexplained {
        rms_nm: a.sqrt(),
        fraction: if b > 0.0 { a / b } else { 0.0 },
        beyond_tolerances_nm: within.map(|both| both[1].mean_square().sqrt()),
        noise_over_floor,
        above_noise: last.evidence_of_discrepancy() > 0.0 || loud,
        joints: (0..floor.len()).into_par_iter().map(joint).collect(),
    }
}

/// Mean square of the noise over that of its floor, from what is left of every joint over its floor: slow noise is not
/// in the floor, and is alike in all of an arm's channels, so that the quietest of several joints has no less of
/// it. What one joint alone has is not told from a gap.
fn noise_over_floor(louder: &[f64]) -> f64 {
    match louder {
        [] | [_] => 1.0,
        all => all.iter().copied().fold(f64::INFINITY, f64::min).max(1.0),
    }
}

fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|v| v * v).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

fn depends_on(left: &[Left<'_>; 2], j: usize) -> Vec<Dependence> {
    let mut all: Vec<Dependence> = variables(&left[0])
        .into_iter()
        .zip(variables(&left[1]))
        .filter_map(|((variable, learned), (_, judged))| {
            let share = share(left, j, &learned, &judged);
            (share >= LEAST_SHARE).then_some(Dependence { variable, share })
        })
        .collect();
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all.truncate(TOLD);
    all
}

/// Every variable's name and its series over all samples.
fn variables(left: &Left<'_>) -> Vec<(String, Vec<f64>)> {
    let samples = left.observed.samples;
    let of = |name: &str, series: &JointSeries| -> Vec<(String, Vec<f64>)> {
        let joint = |j: usize| (format!("{name}_{}", j + 1), series.joint(j).to_vec());
        (0..series.joints()).map(joint).collect()
    };
    let mut all = of("q", &samples.q);
    all.extend(of("qd", &samples.qd));
    all.extend(of("load", &left.observed.known));
    all.extend(samples.temperature.iter().flat_map(|t| of("temperature", t)));
    all.push(("time".into(), (0..samples.len()).map(|k| samples.time(k)).collect()));
    all
}

/// Share of the mean square of joint `j` on the check recording that a curve over the variable takes off.
fn share(left: &[Left<'_>; 2], j: usize, learned: &[f64], judged: &[f64]) -> f64 {
    let rows = |l: &Left<'_>, x: &[f64]| -> Vec<(f64, f64)> {
        let places = &l.observed.rows[j];
        places.iter().zip(l.residual.joint(j)).map(|(&k, r)| (x[k], *r)).collect()
    };
    let (mut learned, judged) = (rows(&left[0], learned), rows(&left[1], judged));
    if learned.len() < 2 * BINS || judged.is_empty() {
        return 0.0;
    }
    learned.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = learned.len().div_ceil(BINS);
    let bins: Vec<(f64, f64)> = learned
        .chunks(size)
        .map(|c| {
            let mean = c.iter().map(|(_, r)| r).sum::<f64>() / c.len() as f64;
            (c[c.len() - 1].0, mean)
        })
        .collect();
    let predicted = |x: f64| {
        let bin = bins.partition_point(|(end, _)| *end < x).min(bins.len() - 1);
        bins[bin].1
    };
    let before: f64 = judged.iter().map(|(_, r)| r * r).sum();
    let after: f64 = judged.iter().map(|(x, r)| (r - predicted(*x)).powi(2)).sum();
    if before > 0.0 { 1.0 - after / before } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_what_the_quietest_of_several_joints_has() {
        assert_eq!(noise_over_floor(&[2.1, 90.0, 2.4]), 2.1);
        assert_eq!(noise_over_floor(&[0.9, 1.1]), 1.0);
        assert_eq!(noise_over_floor(&[90.0]), 1.0);
    }
}
