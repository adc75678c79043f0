//! Stretches of a recording whose gap stands out against anything the other recording shows:
//! somebody pushed, something was in the way.
//!
//! Over short windows the root mean square of what is left at each joint is held against the
//! largest of the other recording at that joint. Where a stretch lies beyond it, one force at the
//! flange, constant over it, is fitted to all joints: tau = J^T F (Haddadin, De Luca, Albu-Schaffer,
//! IEEE Trans. Robotics 33(6), 2017, eq. 1). The share it explains tells a contact from a fault of
//! a joint. What comes again with a motion that comes again is no accident.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::observed::Observed;
use crate::regression::Blocks;
use crate::robot::point_jacobian;
use crate::signals::runs;

/// Length of a window, s.
const WINDOW_S: f64 = 0.25;
/// Multiple of the largest window of the other recording from which a window stands out.
const BEYOND: f64 = 1.5;
/// Rows of one joint in a window, least.
const FEWEST: usize = 3;
/// Joints that must slide: fewer are followed by a force of three components whatever pushes.
const FEWEST_JOINTS: usize = 3;
/// Stretches nearer to each other are one, s.
const NEAR_S: f64 = 0.5;
/// Share of a stretch's squares from which one force at the flange, or that it comes again, is its explanation.
const MOST_OF_IT: f64 = 0.5;

/// A stretch of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Episode {
    /// `fit` or `check`.
    pub recording: String,
    /// Time in the recording, s.
    pub start: f64,
    pub end: f64,
    /// Joints that stand out, from 1 at the base.
    pub joints: Vec<usize>,
    /// Largest gap, N.m; beside a kink of the motion by as much as the row counts.
    pub peak_nm: f64,
    /// Force at the flange that fits best, N, in the axes of the base: what the arm pushes against.
    pub force_n: [f64; 3],
    /// Share of the squares of the stretch's gap that this force explains.
    pub explained: f64,
    /// Time after which the same comes again with the motion, s: it is no accident.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub every_s: Option<f64>,
    /// The force from outside over time, where one is more probable than none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub touch: Option<Touch>,
}

/// A force from outside.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// From 1 at the base: the most probable one.
    pub link: usize,
    pub link_probability: f64,
    /// Time in the recording, s.
    pub start_s: f64,
    pub end_s: f64,
    pub peak_time_s: f64,
    /// Largest force, N, and its standard deviation.
    pub peak_n: f64,
    pub peak_sd_n: f64,
}

impl Episode {
    /// Does one force explain most of it, and did it happen once?
    pub fn is_push(&self) -> bool {
        self.explained >= MOST_OF_IT && self.every_s.is_none()
    }
}

/// What stands out in either recording: each with what the twin and its causes leave of the torque at
/// its rows, N.m.
pub fn episodes(fit: (&Observed<'_>, &Blocks), check: (&Observed<'_>, &Blocks)) -> Vec<Episode> {
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
fn windows(evidence: &Observed<'_>, residual: &Blocks) -> Vec<Vec<f64>> {
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
    evidence: &'a Observed<'e>,
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
            let own = self.evidence.rows[j].iter().zip(self.evidence.sureness.joint(j));
            let own = own.zip(self.residual.joint(j));
            for ((&k, sure), r) in own.filter(|((k, _), _)| inside.contains(*k)) {
                rows.push((k, j, *sure));
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
            every_s: self.every_s(&inside),
            touch: None,
        })
    }

    /// A cycle of the motion, s, where most of the stretch comes again in the cycles before and after.
    fn every_s(&self, inside: &std::ops::Range<usize>) -> Option<f64> {
        let Observed { samples, rows, again, cycle, .. } = self.evidence;
        let (mut squares, mut alike) = (0.0, 0.0);
        for (j, rows) in rows.iter().enumerate() {
            let left = self.residual.joint(j);
            let mut others: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
            for [a, b] in again[j].iter().flat_map(|&[a, b]| [[a, b], [b, a]]) {
                let sum = others.entry(a).or_default();
                *sum = (sum.0 + left[b], sum.1 + 1.0);
            }
            for i in (0..rows.len()).filter(|i| inside.contains(&rows[*i])) {
                let square = left[i].powi(2);
                let differs = |(sum, count): &(f64, f64)| (left[i] - sum / count).powi(2);
                squares += square;
                alike += square - others.get(&i).map_or(square, differs);
            }
        }
        cycle.filter(|_| alike >= MOST_OF_IT * squares).map(|lag| lag as f64 * samples.dt)
    }

    /// Least squares of the gaps (N.m, at sample and joint, scaled by how sure they are) by one force, and the share of
    /// their squares it explains.
    fn force(&self, rows: &[(usize, usize, f64)], gaps: &[f64]) -> Option<([f64; 3], f64)> {
        let robot = &self.evidence.twin.robot;
        let last = robot.dof().checked_sub(1)?;
        let sliding = (0..robot.dof()).filter(|j| rows.iter().any(|(_, at, _)| at == j)).count();
        if sliding < FEWEST_JOINTS {
            return Some(([0.0; 3], 0.0));
        }
        let mut q = vec![0.0; robot.dof()];
        let mut columns = DMatrix::zeros(rows.len(), 3);
        for (i, &(k, j, sure)) in rows.iter().enumerate() {
            self.evidence.samples.q.sample_into(k, &mut q);
            let jacobian = point_jacobian(robot, &q, last, &robot.flange.translation);
            (0..3).for_each(|axis| columns[(i, axis)] = sure * jacobian[(axis, j)]);
        }
        let gaps = DVector::from_column_slice(gaps);
        let force = columns.clone().svd(true, true).solve(&gaps, 1e-9).ok()?;
        let left = (&gaps - columns * &force).norm_squared();
        let explained = 1.0 - left / gaps.norm_squared().max(f64::MIN_POSITIVE);
        Some(([force[0], force[1], force[2]], explained))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::floor::noise_floor;
    use crate::signals::Samples;
    use crate::signals::testing::samples;
    use crate::twin::Twin;

    const FORCE_N: [f64; 3] = [12.0, -20.0, 8.0];
    const PUSH_S: [f64; 2] = [20.0, 22.0];
    const CYCLE_S: f64 = 16.0;

    fn moving() -> Samples {
        samples(6, 5000, |j, t| {
            0.7 * (0.9 * t + j as f64).sin() + 0.2 * ((2.1 + 0.2 * j as f64) * t).sin()
        })
    }

    /// A motion of two cycles and a half.
    fn cycling() -> Samples {
        let w = std::f64::consts::TAU / CYCLE_S;
        samples(6, 5000, |j, t| {
            0.7 * (2.0 * w * t + j as f64).sin() + 0.2 * ((3 + j) as f64 * w * t).sin()
        })
    }

    /// A little of everything that is not a push, and J^T F while `from` <= t < `until` (s).
    fn left(evidence: &Observed<'_>, when: [f64; 2]) -> Blocks {
        left_at(evidence, &[when])
    }

    /// The same with several pushes.
    fn left_at(evidence: &Observed<'_>, pushes: &[[f64; 2]]) -> Blocks {
        let (samples, robot) = (evidence.samples, &evidence.twin.robot);
        let mut q = vec![0.0; 6];
        let mut gap = |j: usize, k: usize| {
            samples.q.sample_into(k, &mut q);
            let jacobian = point_jacobian(robot, &q, 5, &robot.flange.translation);
            let push: f64 = (0..3).map(|axis| jacobian[(axis, j)] * FORCE_N[axis]).sum();
            let pushed =
                pushes.iter().any(|[from, until]| (*from..*until).contains(&samples.time(k)));
            0.05 * (7.0 * samples.time(k) + j as f64).sin() + if pushed { push } else { 0.0 }
        };
        let joint = |j: usize| evidence.rows[j].iter().map(|&k| gap(j, k)).collect();
        Blocks((0..6).map(joint).collect())
    }

    #[test]
    fn a_push_is_found_in_time_and_weighed() {
        let (twin, samples) = (Twin::default(), moving());
        let floor = noise_floor(&samples, &twin);
        let evidence = Observed::new(0, &twin, &samples, &floor).unwrap();
        let [free, pushed] = [[0.0; 2], PUSH_S].map(|when| left(&evidence, when));
        assert!(episodes((&evidence, &free), (&evidence, &free)).is_empty());
        let found = episodes((&evidence, &free), (&evidence, &pushed));
        let [push] = &found[..] else { panic!("{found:?}") };
        assert!(push.recording == "check" && push.is_push() && push.explained > 0.95, "{push:?}");
        let ends = [push.start - PUSH_S[0], push.end - PUSH_S[1]];
        assert!(ends.iter().all(|off| off.abs() <= WINDOW_S), "{push:?}");
        for (found, force) in push.force_n.iter().zip(FORCE_N) {
            assert!((found - force).abs() < 2.0, "{push:?}");
        }
    }

    #[test]
    fn what_comes_again_with_the_motion_is_no_push() {
        let (twin, samples) = (Twin::default(), cycling());
        let floor = noise_floor(&samples, &twin);
        let evidence = Observed::new(0, &twin, &samples, &floor).unwrap();
        let every = [0.0, CYCLE_S].map(|later| [3.0 + later, 5.0 + later]);
        let [free, once, again] =
            [&[][..], &every[..1], &every].map(|pushes| left_at(&evidence, pushes));
        let found = episodes((&evidence, &free), (&evidence, &once));
        assert!(matches!(&found[..], [push] if push.is_push()), "{found:?}");
        let found = episodes((&evidence, &free), (&evidence, &again));
        let came =
            |e: &Episode| !e.is_push() && e.every_s.is_some_and(|s| (s - CYCLE_S).abs() < 0.1);
        assert!(found.len() == 2 && found.iter().all(came), "{found:?}");
    }
}
