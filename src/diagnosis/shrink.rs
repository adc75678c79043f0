//! How far the gap shrinks on the recording that was not fitted on.

use super::bootstrap::interval;
use super::{Checked, JointShrink, TorqueShrink};
use crate::series::JointSeries;
use crate::signals::Samples;

/// Recorded torque less the twin's on the check recording, N.m at every sample, without and with
/// the causes; each joint counts where its mask is true.
#[derive(Debug, Clone, Copy)]
pub struct BeforeAfter<'a> {
    pub samples: &'a Samples,
    pub before: &'a JointSeries,
    pub after: &'a JointSeries,
    pub masks: &'a [Vec<bool>],
}

/// All causes together. `floor_nm` per joint; the interval is by block bootstrap over time from
/// `seed`, all joints together.
pub fn torque_shrink(pair: &BeforeAfter<'_>, floor_nm: &[f64], seed: u64) -> TorqueShrink {
    let total = pair.checked(seed);
    let (rows, floor) =
        (0..pair.samples.joints()).zip(floor_nm).fold((0.0, 0.0), |(rows, floor), (j, nm)| {
            let of_joint = pair.samples.rows_where(&pair.masks[j]).len() as f64;
            (rows + of_joint, floor + of_joint * nm * nm)
        });
    let noise = if rows > 0.0 { floor / rows } else { 0.0 };
    TorqueShrink {
        before_nm: total.check_before_nm,
        after_nm: total.check_after_nm,
        fraction: total.fraction,
        low: total.low,
        high: total.high,
        noise_floor_nm: noise.sqrt(),
        reducible: reducible(total.check_before_nm, total.check_after_nm, noise),
        joints: (0..pair.samples.joints()).map(|j| pair.joint(j)).collect(),
    }
}

impl TorqueShrink {
    /// Share of the mean square above the noise floor that is taken off, and the ends of its 90 % interval,
    /// the floor taken as known; `None` where nothing was above the floor.
    pub fn above_noise(&self) -> Option<[f64; 3]> {
        let [before, floor] = [self.before_nm, self.noise_floor_nm].map(|nm| nm * nm);
        let whole = before / (before - floor);
        let end = |fraction: f64| (fraction * whole).min(1.0);
        (before > floor).then(|| [self.reducible, end(self.low), end(self.high)])
    }
}

/// 1 - (after^2 - noise) / (before^2 - noise): 1 where all but noise is gone, 0 where there was
/// nothing but noise. `noise` is a mean square.
fn reducible(before: f64, after: f64, noise: f64) -> f64 {
    let above = |rms: f64| (rms * rms - noise).max(0.0);
    if above(before) > 0.0 { 1.0 - above(after) / above(before) } else { 0.0 }
}

/// Share by which a mean square shrinks from `before` to `after`; 0 where there was nothing.
fn fraction(before: f64, after: f64) -> f64 {
    if before > 0.0 { 1.0 - after / before } else { 0.0 }
}

impl BeforeAfter<'_> {
    /// Shrink over all joints together; the interval by block bootstrap.
    pub fn checked(&self, seed: u64) -> Checked {
        let (before, after, rows) = self.squares();
        let dt = self.samples.dt * self.decimation();
        let [low, high] = interval(1, [&before, &after], dt, seed, fraction);
        let (b, a): (f64, f64) = (before.iter().sum(), after.iter().sum());
        let rms = |sum: f64| (sum / rows.max(1) as f64).sqrt();
        Checked {
            check_before_nm: rms(b),
            check_after_nm: rms(a),
            fraction: fraction(b, a),
            low: if low.is_finite() { low } else { 0.0 },
            high: if high.is_finite() { high } else { 0.0 },
        }
    }

    fn joint(&self, j: usize) -> JointShrink {
        let rows = self.samples.rows_where(&self.masks[j]);
        let sum = |s: &JointSeries| rows.take(s.joint(j)).iter().map(|r| r * r).sum::<f64>();
        let rms = |sum: f64| (sum / rows.len().max(1) as f64).sqrt();
        let (before, after) = (sum(self.before), sum(self.after));
        JointShrink {
            joint: j + 1,
            before_nm: rms(before),
            after_nm: rms(after),
            fraction: fraction(before, after),
        }
    }

    /// Squares summed over the joints, at every kept instant at which one of them counts, and the
    /// number of all of them.
    fn squares(&self) -> (Vec<f64>, Vec<f64>, usize) {
        let n = self.samples.len();
        let (mut before, mut after, mut rows) = (vec![0.0; n], vec![0.0; n], 0);
        let mut counts = vec![false; n];
        for (j, mask) in self.masks.iter().enumerate() {
            for k in self.samples.rows_where(mask).samples {
                before[k] += self.before.joint(j)[k].powi(2);
                after[k] += self.after.joint(j)[k].powi(2);
                counts[k] = true;
                rows += 1;
            }
        }
        let kept =
            |x: Vec<f64>| x.into_iter().zip(&counts).filter(|(_, c)| **c).map(|(x, _)| x).collect();
        (kept(before), kept(after), rows)
    }

    fn decimation(&self) -> f64 {
        self.samples.decimation() as f64
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::signals::testing::samples;

    /// Residuals of a size per joint at all times, signs as they come.
    fn constant(made: &Samples, size: [f64; 2]) -> JointSeries {
        made.q.map_joints(|j, q| {
            q.iter()
                .enumerate()
                .map(|(k, _)| size[j] * if k % 7 < 3 { 1.0 } else { -1.0 })
                .collect()
        })
    }

    #[test]
    fn closed_forms_of_constant_residuals() {
        let made = samples(2, 4000, |j, t| 0.5 * (TAU * t / (4.0 + j as f64)).sin());
        let (before, after) = (constant(&made, [3.0, 4.0]), constant(&made, [1.0, 4.0]));
        let masks = vec![made.usable.clone(); 2];
        let pair = BeforeAfter { samples: &made, before: &before, after: &after, masks: &masks };
        let shrink = torque_shrink(&pair, &[0.5, 0.5], 1);
        assert!((shrink.before_nm - 12.5f64.sqrt()).abs() < 1e-9);
        assert!((shrink.after_nm - 8.5f64.sqrt()).abs() < 1e-9);
        assert!((shrink.fraction - (1.0 - 8.5 / 12.5)).abs() < 1e-9);
        assert!((shrink.reducible - (1.0 - 8.25 / 12.25)).abs() < 1e-9);
        assert!((shrink.low - shrink.fraction).abs() < 1e-9 && shrink.high >= shrink.low);
        assert!((shrink.joints[0].fraction - 8.0 / 9.0).abs() < 1e-9);
        assert_eq!(shrink.joints[1].fraction, 0.0);
    }

    #[test]
    fn intervals_hold_a_shrink_that_varies_in_time() {
        let made = samples(2, 8000, |j, t| 0.5 * (TAU * t / (4.0 + j as f64)).sin());
        let before = constant(&made, [2.0, 2.0]);
        let after = before.map_joints(|_, r| {
            r.iter().enumerate().map(|(k, r)| if (k / 500) % 2 == 0 { *r } else { 0.0 }).collect()
        });
        let masks = vec![made.usable.clone(); 2];
        let pair = BeforeAfter { samples: &made, before: &before, after: &after, masks: &masks };
        let checked = pair.checked(3);
        assert!((checked.fraction - 0.5).abs() < 0.02, "{checked:?}");
        assert!(checked.low < 0.45 && checked.high > 0.55 && checked.low > 0.2, "{checked:?}");
    }

    #[test]
    fn nothing_shrinks_where_there_was_nothing() {
        let made = samples(2, 1000, |_, _| 0.0);
        let none = JointSeries::zeros(2, 1000);
        let masks = vec![made.usable.clone(), vec![false; 1000]];
        let pair = BeforeAfter { samples: &made, before: &none, after: &none, masks: &masks };
        let shrink = torque_shrink(&pair, &[0.1, 0.1], 1);
        assert_eq!((shrink.fraction, shrink.reducible, shrink.after_nm), (0.0, 0.0, 0.0));
        let never = vec![vec![false; 1000]; 2];
        let checked = BeforeAfter { masks: &never, ..pair }.checked(1);
        assert_eq!((checked.fraction, checked.low, checked.high), (0.0, 0.0, 0.0));
    }
}
