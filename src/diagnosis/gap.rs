//! Where twin and recording differ: per joint and regime, N.m, beside the noise floor.

use rayon::prelude::*;

use super::bootstrap::interval;
use super::floor::Floor;
use super::regimes::{Condition, conditions, transmitted};
use super::{Gap, JointGap, Regime};
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::twin::Twin;

/// Rows below which a regime says nothing.
const FEWEST_ROWS: usize = 20;

/// `residual` is the recorded torque less the twin's with its fitted friction, N.m, low-passed as
/// a regression uses it, at every sample; it counts where a joint's mask is true. Intervals are 90 %
/// by block bootstrap from `seed`. Regimes with fewer than 20 rows are left out.
pub fn gap(
    samples: &Samples,
    twin: &Twin,
    residual: &JointSeries,
    masks: &[Vec<bool>],
    floor: &[Floor],
    seed: u64,
) -> Gap {
    let load = transmitted(samples, twin);
    let joint = |j: usize| {
        let at = Measured { samples, residual: residual.joint(j), mask: &masks[j], seed };
        let all = at.rms(&masks[j], at.residual);
        let conditions =
            conditions(samples, j, &masks[j], load.joint(j), residual.joint(j), &floor[j]);
        JointGap {
            joint: j + 1,
            rms_nm: all.rms_nm,
            low_nm: all.low_nm,
            high_nm: all.high_nm,
            rms_rad: None,
            noise_floor_rad: None,
            noise_floor_nm: floor[j].noise_nm,
            floor_from: floor[j].from.name().into(),
            share: 0.0,
            regimes: conditions.iter().filter_map(|c| at.regime(c)).collect(),
        }
    };
    let mut joints: Vec<JointGap> = (0..samples.joints()).into_par_iter().map(joint).collect();
    let excess = |g: &JointGap| (g.rms_nm.powi(2) - g.noise_floor_nm.powi(2)).max(0.0);
    let total: f64 = joints.iter().map(excess).sum();
    for joint in joints.iter_mut().filter(|_| total > 0.0) {
        joint.share = excess(joint) / total;
    }
    Gap { joints }
}

/// One joint's residual.
struct Measured<'a> {
    samples: &'a Samples,
    residual: &'a [f64],
    mask: &'a [bool],
    seed: u64,
}

struct Rms {
    rms_nm: f64,
    low_nm: f64,
    high_nm: f64,
    rows: usize,
    fraction: f64,
}

impl Measured<'_> {
    fn regime(&self, condition: &Condition) -> Option<Regime> {
        let part = condition.part.as_deref().unwrap_or(self.residual);
        let rms = self.rms(&condition.holds, part);
        (rms.rows >= FEWEST_ROWS).then(|| Regime {
            regime: condition.regime.into(),
            rms_nm: rms.rms_nm,
            low_nm: rms.low_nm,
            high_nm: rms.high_nm,
            noise_floor_nm: condition.floor_nm,
            time_fraction: rms.fraction,
        })
    }

    /// Root mean square of `x` where `holds`, 0 if nowhere; whole stretches of the recording are resampled.
    fn rms(&self, holds: &[bool], x: &[f64]) -> Rms {
        let rows = self.samples.rows_where(self.mask);
        let weight: Vec<f64> =
            rows.samples.iter().map(|&k| if holds[k] { 1.0 } else { 0.0 }).collect();
        let square: Vec<f64> =
            rows.samples.iter().zip(&weight).map(|(&k, w)| w * x[k] * x[k]).collect();
        let root = |sum: f64, count: f64| if count > 0.0 { (sum / count).sqrt() } else { 0.0 };
        let count: f64 = weight.iter().sum();
        let dt = self.samples.dt * rows.decimation as f64;
        let [low_nm, high_nm] = match count > 0.0 {
            true => interval(1, [&square, &weight], dt, self.seed, root),
            false => [0.0; 2],
        };
        Rms {
            rms_nm: root(square.iter().sum(), count),
            low_nm,
            high_nm,
            rows: count as usize,
            fraction: count / rows.len().max(1) as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::diagnosis::FloorFrom;
    use crate::signals::testing::samples;

    fn swinging() -> Samples {
        samples(6, 7500, |j, t| 0.7 * (TAU * t / (5.0 + j as f64)).sin())
    }

    fn found(residual: &JointSeries, made: &Samples, noise_nm: f64) -> Gap {
        let masks: Vec<_> = (0..6).map(|j| made.mask(j)).collect();
        let floor = vec![Floor { noise_nm, from: FloorFrom::Estimate }; 6];
        gap(made, &Twin::default(), residual, &masks, &floor, 1)
    }

    fn regime<'a>(joint: &'a JointGap, name: &str) -> &'a Regime {
        joint.regimes.iter().find(|r| r.regime == name).unwrap_or_else(|| panic!("no {name}"))
    }

    #[test]
    fn a_constant_is_found_in_every_regime_and_at_low_frequencies_only() {
        let made = swinging();
        let residual = made.q.map_joints(|j, q| vec![j as f64; q.len()]);
        let gap = found(&residual, &made, 0.5);
        for (j, joint) in gap.joints.iter().enumerate() {
            let size = j as f64;
            assert!((joint.rms_nm - size).abs() < 1e-9);
            assert!(joint.low_nm <= joint.rms_nm && joint.rms_nm <= joint.high_nm);
            let (whole, bands): (Vec<_>, Vec<_>) =
                joint.regimes.iter().partition(|r| !r.regime.ends_with("frequency"));
            assert!(whole.iter().all(|r| (r.rms_nm - size).abs() < 1e-9), "{whole:?}");
            assert!((bands[0].rms_nm - size).abs() < 1e-6 && bands[2].rms_nm < 1e-6);
        }
        // 1 + 4 + 9 + 16 + 25, each less .25
        let expected = [0.0, 0.75, 3.75, 8.75, 15.75, 24.75].map(|x| x / 53.75);
        for (joint, share) in gap.joints.iter().zip(expected) {
            assert!((joint.share - share).abs() < 1e-9, "{share} {}", joint.share);
        }
    }

    #[test]
    fn what_happens_after_reversals_shows_there() {
        let made = swinging();
        let residual = made.qd.map_joints(|_, qd| {
            let acts = |k: usize| k >= 25 && qd[k] * qd[k - 25] < 0.0;
            (0..qd.len()).map(|k| if acts(k) { 3.0 } else { 0.0 }).collect()
        });
        for joint in found(&residual, &made, 0.1).joints {
            let at = regime(&joint, "reversal").rms_nm;
            assert!(at > 3.0 * joint.rms_nm, "{joint:?}");
            assert!(regime(&joint, "fast").rms_nm == 0.0, "{joint:?}");
        }
    }

    #[test]
    fn bands_part_the_squares_between_them() {
        let made = swinging();
        let wave = |hz: f64, k: usize| (TAU * hz * k as f64 * made.dt).sin();
        let at = |k| wave(0.1, k) + 2.0 * wave(1.2, k) + 3.0 * wave(6.0, k);
        let residual = made.q.map_joints(|_, q| (0..q.len()).map(at).collect());
        let masks = vec![made.usable.clone(); 6];
        let floor = vec![Floor { noise_nm: 0.2, from: FloorFrom::Estimate }; 6];
        let gap = gap(&made, &Twin::default(), &residual, &masks, &floor, 1);
        for (name, size) in
            [("low_frequency", 1.0), ("mid_frequency", 2.0), ("high_frequency", 3.0)]
        {
            let band = regime(&gap.joints[0], name);
            assert!((band.rms_nm / (size / 2f64.sqrt()) - 1.0).abs() < 0.06, "{band:?}");
        }
        let floors: f64 = ["low_frequency", "mid_frequency", "high_frequency"]
            .map(|name| regime(&gap.joints[0], name).noise_floor_nm.powi(2))
            .iter()
            .sum();
        // Gentle slopes: a little is lost between the bands.
        assert!((0.8..1.0).contains(&(floors.sqrt() / 0.2)), "{floors}");
    }

    /// Half of the time with twice the torque in it.
    #[test]
    fn time_and_angle_are_told_apart() {
        let made = swinging();
        let n = made.len();
        let residual = made.q.map_joints(|_, q| {
            (0..q.len()).map(|k| if 3 * k >= 2 * n { 1.0 } else { 0.0 }).collect()
        });
        let joint = &found(&residual, &made, 0.01).joints[2];
        assert_eq!(regime(joint, "time_end").rms_nm, 1.0);
        assert_eq!(regime(joint, "time_begin").rms_nm, 0.0);
        assert!((regime(joint, "angle_mid").rms_nm - 1.0 / 3f64.sqrt()).abs() < 0.1);
        assert!((regime(joint, "time_end").time_fraction - 1.0 / 3.0).abs() < 0.03);
    }
}
