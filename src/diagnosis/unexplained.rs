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

/// A recording, what is left of it (N.m at its rows) and the load of the twin.
pub struct Left<'a> {
    pub observed: &'a Observed<'a>,
    pub residual: &'a Blocks,
}

/// `before`, `beyond` (within the twin's tolerances) and `left[1]` are of the check recording, `left[0]` of the one
/// that was fitted; `last` has the discrepancy beside all causes.
pub fn unexplained(
    left: &[Left<'_>; 2],
    before: &Blocks,
    beyond: Option<&Blocks>,
    floor: &[Floor],
    last: &Fit<'_>,
    criteria: &Criteria,
) -> Unexplained {
    let check = &left[1];
    // Every joint counts alike, as in the gap.
    let mean_square = |blocks: &Blocks| {
        let rows = check.observed.rows.iter().map(|rows| rows.len().max(1) as f64);
        let joints = blocks.squares().into_iter().zip(rows).map(|(sum, rows)| sum / rows);
        joints.sum::<f64>() / floor.len().max(1) as f64
    };
    let (b, a) = (mean_square(before), mean_square(check.residual));
    let joints: Vec<UnexplainedJoint> =
        (0..floor.len()).into_par_iter().map(|j| joint(left, j, &floor[j], last)).collect();
    let loud =
        |j: &UnexplainedJoint| j.rms_nm.powi(2) > criteria.above_noise * j.noise_floor_nm.powi(2);
    Unexplained {
        rms_nm: a.sqrt(),
        fraction: if b > 0.0 { a / b } else { 0.0 },
        beyond_tolerances_nm: beyond.map(|b| mean_square(b).sqrt()),
        above_noise: last.evidence_of_discrepancy() > 0.0 || joints.iter().any(loud),
        joints,
    }
}

fn joint(left: &[Left<'_>; 2], j: usize, floor: &Floor, last: &Fit<'_>) -> UnexplainedJoint {
    let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len().max(1) as f64).sqrt();
    UnexplainedJoint {
        joint: j + 1,
        rms_nm: rms(left[1].residual.joint(j)),
        noise_floor_nm: floor.noise_nm,
        discrepancy_nm: rms(&last.discrepancy(j)),
        depends_on: depends_on(left, j),
    }
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
