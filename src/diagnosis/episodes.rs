//! Stretches of a recording whose gap stands out against anything the other recording shows: somebody
//! pushed, something was in the way.
//!
//! Over short windows the root mean square of what is left at each joint is held against the largest
//! of the other recording at that joint. Where a stretch lies beyond it, one force at the flange, constant over it, is fitted to all joints (tau = J^T F): the share it
//! explains tells a contact from a fault of a joint.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::columns::Blocks;
use super::evidence::Evidence;
use crate::robot::point_jacobian;
use crate::signals::runs;

/// Length of a window, s.
const WINDOW_S: f64 = 0.25;
/// Times the largest of the other recording.
const BEYOND: f64 = 1.5;
/// Rows of one joint in a window, least.
const FEWEST: usize = 3;
/// Joints that must slide: fewer are followed by a force of three components whatever pushes.
const FEWEST_JOINTS: usize = 3;
/// Stretches nearer to each other are one, s.
const NEAR_S: f64 = 0.5;
/// Share of a stretch's squares from which one force at the flange is its explanation.
const PUSHED: f64 = 0.5;

/// A stretch of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Episode {
    /// `fit` or `check`.
    pub recording: String,
    /// In the recording, s.
    pub start: f64,
    pub end: f64,
    /// Joints that stand out, from 1 at the base.
    pub joints: Vec<usize>,
    /// Largest gap, N.m.
    pub peak_nm: f64,
    /// Force at the flange that fits best, N, in the axes of the base: what the arm pushes against.
    pub force_n: [f64; 3],
    /// Of the squares of the stretch's gap, the share that this force explains.
    pub explained: f64,
}

impl Episode {
    pub fn is_push(&self) -> bool {
        self.explained >= PUSHED
    }
}

/// What stands out in either recording; `residuals` are what the twin with its causes leaves.
pub fn episodes(fit: (&Evidence<'_>, &Blocks), check: (&Evidence<'_>, &Blocks)) -> Vec<Episode> {
    let windows = [&fit, &check].map(|(evidence, residual)| windows(evidence, residual));
    let largest = |joint: &Vec<f64>| joint.iter().copied().fold(0.0, f64::max);
    let limits = windows.each_ref().map(|w| w.iter().map(|j| BEYOND * largest(j)).collect());
    let mut found = Vec::new();
    for (which, name) in ["fit", "check"].into_iter().enumerate() {
        let (evidence, residual) = [fit, check][which];
        let limits: &Vec<f64> = &limits[1 - which];
        let beyond =
            |(j, limit): (usize, &f64), w: usize| *limit > 0.0 && windows[which][j][w] > *limit;
        let count = windows[which].first().map_or(0, Vec::len);
        let loud: Vec<bool> =
            (0..count).map(|w| limits.iter().enumerate().any(|joint| beyond(joint, w))).collect();
        for stretch in joined(&loud, (NEAR_S / WINDOW_S) as usize) {
            let stands =
                |&(j, limit): &(usize, &f64)| stretch.clone().any(|w| beyond((j, limit), w));
            let joints = limits.iter().enumerate().filter(stands).map(|(j, _)| j + 1).collect();
            let stretch = Stretch { evidence, residual, windows: stretch.clone() };
            found.extend(stretch.episode(name, joints));
        }
    }
    found
}

/// Root mean square in each window, joint by joint; 0 where the joint hardly slides in it.
fn windows(evidence: &Evidence<'_>, residual: &Blocks) -> Vec<Vec<f64>> {
    let samples = evidence.samples;
    let count = (samples.len() as f64 * samples.dt / WINDOW_S).ceil() as usize;
    let joint = |j: usize| {
        let mut sums = vec![(0.0, 0usize); count];
        for (&k, r) in evidence.rows[j].iter().zip(residual.joint(j)) {
            let sum = &mut sums[(k as f64 * samples.dt / WINDOW_S) as usize];
            *sum = (sum.0 + r * r, sum.1 + 1);
        }
        let rms = |(sum, n): (f64, usize)| if n < FEWEST { 0.0 } else { (sum / n as f64).sqrt() };
        sums.into_iter().map(rms).collect()
    };
    (0..evidence.joints()).map(joint).collect()
}

/// Runs of true, those at most `gap` windows apart taken together.
fn joined(loud: &[bool], gap: usize) -> Vec<std::ops::Range<usize>> {
    let mut all: Vec<std::ops::Range<usize>> = Vec::new();
    for run in runs(loud) {
        match all.last_mut() {
            Some(last) if run.start - last.end <= gap => last.end = run.end,
            _ => all.push(run),
        }
    }
    all
}

struct Stretch<'a, 'e> {
    evidence: &'a Evidence<'e>,
    residual: &'a Blocks,
    windows: std::ops::Range<usize>,
}

impl Stretch<'_, '_> {
    fn episode(&self, recording: &str, joints: Vec<usize>) -> Option<Episode> {
        let samples = self.evidence.samples;
        let at = |window: usize| (window as f64 * WINDOW_S / samples.dt) as usize;
        let inside = at(self.windows.start)..at(self.windows.end);
        let (mut rows, mut gaps) = (Vec::new(), Vec::new());
        for j in 0..self.evidence.joints() {
            let own = self.evidence.rows[j].iter().zip(self.residual.joint(j));
            for (&k, r) in own.filter(|(k, _)| inside.contains(*k)) {
                rows.push((k, j));
                gaps.push(*r);
            }
        }
        let (force_n, explained) = self.force(&rows, &gaps)?;
        Some(Episode {
            recording: recording.into(),
            start: samples.time(inside.start),
            end: samples.time(inside.end.min(samples.len() - 1)),
            joints,
            peak_nm: gaps.iter().fold(0.0, |peak, gap| gap.abs().max(peak)),
            force_n,
            explained,
        })
    }

    /// Least squares of the gaps (N.m, at sample and joint) by one force, and the share of their
    /// squares it explains.
    fn force(&self, rows: &[(usize, usize)], gaps: &[f64]) -> Option<([f64; 3], f64)> {
        let robot = &self.evidence.twin.robot;
        let last = robot.dof().checked_sub(1)?;
        let mut q = vec![0.0; robot.dof()];
        let mut columns = DMatrix::zeros(rows.len(), 3);
        for (i, &(k, j)) in rows.iter().enumerate() {
            self.evidence.samples.q.sample_into(k, &mut q);
            let jacobian = point_jacobian(robot, &q, last, &robot.flange.translation);
            (0..3).for_each(|axis| columns[(i, axis)] = jacobian[(axis, j)]);
        }
        let sliding = (0..robot.dof()).filter(|j| rows.iter().any(|(_, at)| at == j)).count();
        if sliding < FEWEST_JOINTS {
            return Some(([0.0; 3], 0.0));
        }
        let gaps = DVector::from_column_slice(gaps);
        let force = columns.clone().svd(true, true).solve(&gaps, 1e-9).ok()?;
        let left = (&gaps - columns * &force).norm_squared();
        let explained = 1.0 - left / gaps.norm_squared().max(f64::MIN_POSITIVE);
        Some(([force[0], force[1], force[2]], explained))
    }
}
