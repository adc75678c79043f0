//! Is what a model leaves noise that has a colour, or something that the arm's motion makes?
//!
//! What depends on the motion can be learnt from one recording and predicted on another; noise
//! cannot. So a linear model of many plain features of the motion is fitted to what is left of the
//! first recording and held against what is left of the second (ridge regression: Hoerl, Kennard,
//! Technometrics 12(1), 1970). Where it predicts next to nothing of even the quietest joint, that
//! joint's level is noise: slower than white, and as much slower at the other joints, whose sensors
//! are alike.

use std::sync::OnceLock;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::columns::Blocks;
use super::evidence::Evidence;
use super::features::features;
use super::leftover::in_motion_band;
use crate::kernels;

/// Power in the motion's band over the noise up to which noise counts as white.
const WHITE: f64 = 1.5;
/// Share of a joint's power in the motion's band up to which it counts as unpredictable.
const LEARNT: f64 = 0.25;
/// Penalties on the features, in units of their mean square; the one that predicts best is taken.
const PENALTIES: [f64; 4] = [1e-3, 1e-2, 1e-1, 1.0];

/// Noise in the motion's band over its level where nothing moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour {
    /// In power; 1 for white noise.
    pub in_motion_band: f64,
    /// Of the mean square over all frequencies, over what white noise would come to.
    pub mean_square: f64,
}

pub const WHITE_NOISE: Colour = Colour { in_motion_band: 1.0, mean_square: 1.0 };

/// Learns from one recording and predicts on another.
pub struct Colours<'a, 'e> {
    fit: &'a Evidence<'e>,
    check: &'a Evidence<'e>,
    learners: Vec<OnceLock<Learner>>,
}

/// The features of one joint in both recordings, scaled to mean square 1 over the first.
struct Learner {
    fit: Vec<Vec<f64>>,
    check: Vec<Vec<f64>>,
    /// One per penalty.
    factors: Vec<Cholesky<f64, Dyn>>,
}

impl<'a, 'e> Colours<'a, 'e> {
    pub fn new(fit: &'a Evidence<'e>, check: &'a Evidence<'e>) -> Self {
        let learners = (0..fit.joints()).map(|_| OnceLock::new()).collect();
        Self { fit, check, learners }
    }

    /// Of the noise, where `fit` and `check` are what is left of the two recordings, N.m.
    pub fn of(&self, fit: &Blocks, check: &Blocks) -> Colour {
        let levels = in_motion_band(self.check, check);
        let counts = |j: &usize| check.touches(*j) && fit.touches(*j);
        let joints = (0..levels.len()).filter(counts);
        let quietest = joints.min_by(|a, b| levels[*a].total_cmp(&levels[*b]));
        let Some(quietest) = quietest.filter(|j| levels[*j] > WHITE) else { return WHITE_NOISE };
        if self.learnt(quietest, fit, check, levels[quietest]) > LEARNT {
            return WHITE_NOISE;
        }
        let rows = check.joint(quietest);
        let mean_square = kernels::dot(rows, rows) / rows.len() as f64;
        Colour {
            in_motion_band: levels[quietest],
            mean_square: (mean_square / self.check.sigma[quietest].powi(2)).max(1.0),
        }
    }

    /// Share of a joint's power in the motion's band on the second recording that a model learnt on
    /// the first predicts.
    fn learnt(&self, joint: usize, fit: &Blocks, check: &Blocks, level: f64) -> f64 {
        // No parallel work in here: a worker that waits for the lock may not be given more of it.
        let learner =
            self.learners[joint].get_or_init(|| Learner::new(self.fit, self.check, joint));
        let share = |predicted: Vec<f64>| {
            let mut left = check.clone();
            left.0[joint].iter_mut().zip(&predicted).for_each(|(l, p)| *l -= p);
            1.0 - in_motion_band(self.check, &left)[joint] / level
        };
        learner.predictions(fit.joint(joint)).map(share).fold(0.0, f64::max)
    }
}

impl Learner {
    fn new(fit: &Evidence<'_>, check: &Evidence<'_>, joint: usize) -> Self {
        let (mut learn, mut predict) = (features(fit, joint), features(check, joint));
        for (a, b) in learn.iter_mut().zip(&mut predict) {
            let mean_square = kernels::dot(a, a) / a.len() as f64;
            let scale = 1.0 / mean_square.sqrt().max(f64::MIN_POSITIVE);
            a.iter_mut().chain(b).for_each(|x| *x *= scale);
        }
        let n = learn.len();
        let rows = learn.first().map_or(1, Vec::len) as f64;
        let products = DMatrix::from_fn(n, n, |i, k| kernels::dot(&learn[i], &learn[k]) / rows);
        let factor = |penalty: f64| Cholesky::new(&products + DMatrix::identity(n, n) * penalty);
        let factors = PENALTIES.into_iter().filter_map(factor).collect();
        Self { fit: learn, check: predict, factors }
    }

    /// What each penalty predicts on the second recording, from what is left of the first.
    fn predictions<'b>(&'b self, left: &'b [f64]) -> impl Iterator<Item = Vec<f64>> + 'b {
        let rows = left.len().max(1) as f64;
        let pull: Vec<f64> = self.fit.iter().map(|x| kernels::dot(x, left) / rows).collect();
        let pull = DVector::from_vec(pull);
        self.factors.iter().map(move |factor| {
            let weights = factor.solve(&pull);
            let mut predicted = vec![0.0; self.check.first().map_or(0, Vec::len)];
            for (x, w) in self.check.iter().zip(weights.iter()) {
                kernels::axpy(*w, x, &mut predicted);
            }
            predicted
        })
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::diagnosis::floor::{Floor, FloorFrom};
    use crate::diagnosis::testing::samples;
    use crate::signals::Samples;
    use crate::twin::Twin;

    const POLE: f64 = 0.9;

    fn moving(rate: f64) -> Samples {
        samples(6, 4000, |j, t| {
            0.7 * (rate * t + j as f64).sin() + 0.2 * ((2.1 * rate + 0.2 * j as f64) * t).sin()
        })
    }

    /// Half white, half correlated from sample to sample, and `more` of its own for every row.
    fn left(evidence: &Evidence<'_>, seed: u64, more: impl Fn(usize, usize) -> f64) -> Blocks {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut joint = |j: usize| {
            let mut slow = 0.0;
            let all = (0..evidence.samples.len()).map(|k| {
                slow = POLE * slow + (1.0 - POLE * POLE).sqrt() * draw();
                0.5f64.sqrt() * (slow + draw()) + more(j, k)
            });
            let all: Vec<f64> = all.collect();
            evidence.block(j, &all)
        };
        Blocks((0..6).map(&mut joint).collect())
    }

    /// What is found on two motions where the arm's torque holds noise and `more`.
    fn found(more: impl Fn(&Samples, usize, usize) -> f64) -> Colour {
        let twin = Twin::default();
        let (fit, check) = (moving(0.9), moving(1.1));
        let floor = vec![Floor { noise_nm: 0.25, from: FloorFrom::Estimate }; 6];
        let evidence = |samples| Evidence::new(&twin, samples, &floor).unwrap();
        let (fit, check) = (evidence(&fit), evidence(&check));
        let [on_fit, on_check] =
            [(&fit, 1), (&check, 2)].map(|(e, seed)| left(e, seed, |j, k| more(e.samples, j, k)));
        Colours::new(&fit, &check).of(&on_fit, &on_check)
    }

    #[test]
    fn noise_that_no_motion_predicts_has_a_colour() {
        let colour = found(|_, _, _| 0.0);
        assert!(colour.in_motion_band > 2.0, "{colour:?}");
        assert!(colour.mean_square > 1.2, "{colour:?}");
    }

    /// Friction that changes along the travel at every joint: no catalogue holds it, yet it is no
    /// noise.
    #[test]
    fn what_the_motion_makes_is_no_noise() {
        let rubs = |s: &Samples, j: usize, k: usize| {
            let (q, qd) = (s.q.joint(j)[k], s.qd.joint(j)[k]);
            if q > 0.2 { 2.0 * qd.signum() } else { 0.0 }
        };
        assert_eq!(found(rubs), WHITE_NOISE);
    }

    /// One joint that hums does not change what the others show noise to be.
    #[test]
    fn a_hum_at_one_joint_is_not_taken_for_noise() {
        let hums = |s: &Samples, j: usize, k: usize| {
            if j == 2 { 5.0 * (9.0 * s.time(k)).sin() } else { 0.0 }
        };
        let [still, humming] = [found(|_, _, _| 0.0), found(hums)];
        assert!((humming.in_motion_band / still.in_motion_band - 1.0).abs() < 0.3, "{humming:?}");
    }
}
