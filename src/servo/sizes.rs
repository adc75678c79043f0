//! How far the simulated position of a twin is from the recorded one, and whether another twin comes surely nearer.
//!
//! Sizes of errors count, not their squares: what stops the arm for a moment in one recording alone is not simulated here,
//! and squares would let it decide.

use super::{ServoError, Track, replay};
use crate::diagnosis::{Settings, interval};
use crate::series::JointSeries;
use crate::twin::Twin;

/// Sizes of errors along the commands of recordings, rad; infinite where the twin runs away.
#[derive(Clone)]
pub struct Sizes {
    /// Each joint of each recording.
    joints: Vec<Vec<f64>>,
    /// Joints of a recording.
    dof: usize,
    /// What rounding alone leaves of each, rad.
    rounding: Vec<f64>,
    /// s.
    dt: f64,
}

impl Sizes {
    /// Of the samples that count in each of several parts of a recording, the twin led along all of it once.
    ///
    /// # Errors
    /// If the twin cannot be simulated.
    pub fn along<const N: usize>(
        track: &Track,
        parts: [&[bool]; N],
        twin: &Twin,
    ) -> Result<[Self; N], ServoError> {
        let simulated = match replay(twin, track, &track.stretches(f64::INFINITY)) {
            Err(ServoError::Diverged { .. }) => None,
            simulated => Some(simulated?),
        };
        let size = |j: usize, k: usize| {
            let led = |q: &JointSeries| (q.joint(j)[k] - track.q.joint(j)[k]).abs();
            simulated.as_ref().map_or(f64::INFINITY, led)
        };
        let rounding: Vec<f64> = track.resolution.iter().map(|r| r / 12f64.sqrt()).collect();
        Ok(parts.map(|counts| {
            let of = |j| (0..track.len()).filter(|&k| counts[k]).map(|k| size(j, k)).collect();
            let joints = (0..track.joints()).map(of).collect();
            Self { joints, dof: track.joints().max(1), rounding: rounding.clone(), dt: track.dt }
        }))
    }

    /// With errors of other samples of the same recordings.
    pub fn and(mut self, mut others: Self) -> Self {
        let both = self.joints.iter_mut().zip(&mut others.joints);
        both.for_each(|(own, other)| own.append(other));
        self
    }

    /// With errors of another recording.
    pub fn beside(mut self, mut other: Self) -> Self {
        self.joints.append(&mut other.joints);
        self.rounding.append(&mut other.rounding);
        self
    }

    /// What is left of each joint, rad, at least its rounding.
    fn told(&self) -> Vec<f64> {
        let of = |(left, least): (f64, &f64)| left.max(*least);
        self.means().into_iter().zip(&self.rounding).map(of).collect()
    }

    /// How large errors are over all joints, each by the logarithm of its mean, at least its rounding: minus the log-likelihood
    /// of each sample, as errors of unknown scale (Laplace) have it. Infinite where the twin runs away.
    pub fn ln(&self) -> f64 {
        self.told().into_iter().map(f64::ln).sum()
    }

    /// Are these errors surely smaller, and by enough, where so many are looked at? Each joint counts in units of what is
    /// left of it.
    pub fn are_nearer(&self, than: &Self, among: usize, settings: &Settings) -> bool {
        let (before, after) = (than.told(), self.told());
        let moves = |means: &[f64]| means.iter().all(|m| m.is_finite());
        if !(moves(&before) && moves(&after)) {
            return moves(&after);
        }
        let largest = before.iter().zip(&after).map(|(b, a)| share(*b, *a)).fold(0.0, f64::max);
        // No simulation of an arm is exact to less.
        largest >= settings.criteria.least_gain_inexact
            && self.are_surely_nearer(than, among, settings.seed)
    }

    /// Would errors, both finite, shrink along other stretches of this motion?
    fn are_surely_nearer(&self, than: &Self, among: usize, seed: u64) -> bool {
        let units = self.told();
        let [b, a] = [than, self].map(|sizes| sizes.summed(&units));
        let [low, _] = interval(among, [&b, &a], self.dt, seed, share);
        low > 0.0
    }

    /// Mean over all joints, rad.
    pub fn mean_rad(&self) -> f64 {
        self.means().iter().sum::<f64>() / self.joints.len().max(1) as f64
    }

    fn means(&self) -> Vec<f64> {
        self.joints.iter().map(|e| e.iter().sum::<f64>() / e.len().max(1) as f64).collect()
    }

    /// Over all joints, sample by sample, one recording after the other.
    fn summed(&self, units: &[f64]) -> Vec<f64> {
        let of_recording = |(joints, units): (&[Vec<f64>], &[f64])| -> Vec<f64> {
            let samples = joints.first().map_or(0, Vec::len);
            let at = |k: usize| joints.iter().zip(units).map(|(e, unit)| e[k] / unit).sum();
            (0..samples).map(at).collect()
        };
        self.joints.chunks(self.dof).zip(units.chunks(self.dof)).flat_map(of_recording).collect()
    }
}

/// Is a `gain` more than this share of `all`, both differences of logarithms ([`Sizes::ln`])? Where a twin runs away without what is
/// asked about, what is taken off is no measure, and any gain is more.
pub fn is_more(share: f64, [gain, all]: [f64; 2]) -> bool {
    gain > if all.is_finite() { share * all } else { 0.0 }
}

/// Share of a square that is taken off.
fn share(before: f64, after: f64) -> f64 {
    if before > 0.0 { 1.0 - (after / before).powi(2) } else { 0.0 }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Two joints for half a minute, whose errors swing about these means.
    pub fn about(means: [f64; 2]) -> Sizes {
        let swings = |k: usize| 1.0 + 0.5 * (0.7 * k as f64).sin();
        let joints = means.map(|m| (0..3000).map(|k| m * swings(k)).collect());
        Sizes { joints: joints.to_vec(), dof: 2, rounding: vec![1e-4; 2], dt: 0.01 }
    }

    fn are_nearer(with: [f64; 2], without: [f64; 2]) -> bool {
        about(with).are_nearer(&about(without), 1, &Settings::default())
    }

    #[test]
    fn nearer_is_a_tenth_of_the_square_at_a_joint_and_of_all_joints_surely() {
        assert!(are_nearer([0.9e-3, 1e-3], [1e-3, 1e-3]));
        assert!(!are_nearer([0.96e-3, 1e-3], [1e-3, 1e-3]), "a twentieth");
        assert!(!are_nearer([0.9e-3, 1.3e-3], [1e-3, 1e-3]), "what one joint gains another loses");
        assert!(!are_nearer([1e-3, 1e-3], [1e-3, 1e-3]), "the same");
    }

    /// A joint counts by its share, whatever its size; nothing is smaller than rounding.
    #[test]
    fn the_logarithm_of_sizes_is_of_shares() {
        let ln = |means: [f64; 2]| about(means).ln();
        let half = ln([2e-3, 8e-3]) - ln([1e-3, 8e-3]);
        assert!((half - 2f64.ln()).abs() < 1e-12, "{half}");
        assert!((half - (ln([1e-3, 8e-3]) - ln([1e-3, 4e-3]))).abs() < 1e-12);
        assert_eq!(ln([1e-5, 1e-3]), ln([1e-6, 1e-3]));
        assert_eq!(ln([f64::INFINITY, 1e-3]), f64::INFINITY);
    }

    #[test]
    fn more_is_beyond_a_share_of_what_is_taken_off() {
        assert!(is_more(0.1, [0.2 + 1e-12, 2.0]) && !is_more(0.1, [0.2 - 1e-12, 2.0]));
        let away = f64::INFINITY;
        assert!(is_more(0.1, [away, away]) && !is_more(0.1, [0.0, away]), "it ran away");
    }

    #[test]
    fn a_twin_that_no_longer_runs_away_is_nearer() {
        let away = [f64::INFINITY, 1e-3];
        assert!(are_nearer([1.0, 1.0], away));
        assert!(!are_nearer(away, [1.0, 1.0]) && !are_nearer(away, away));
    }
}
