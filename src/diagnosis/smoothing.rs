//! What smoothing takes from the motion where it kinks, and how unsure that makes a row of torque.
//!
//! Friction that changes its sign, a stop or a knock bends the motion within a sample or two. The torque of that
//! moment is recorded as it is; the acceleration is made from a smoothed motion and lacks it, so that the rows
//! around show torque that no law explains, always at reversals, and a law of reversals (a bristle) would pass for it.
//! How much is missing is not known, but about how much: of a kink, whose acceleration is white, what half the cutoff
//! takes further is a known part of what the cutoff took. Rows count as if their noise held that, too.

use super::floor::{conditioned, noise_gain};
use super::local_noise::MEDIAN_ABSOLUTE;
use crate::effects::Motion;
use crate::regression::Blocks;
use crate::series::JointSeries;
use crate::signals::{Conditioning, LowPass, Samples, SignalError};
use crate::twin::Twin;

/// Share of a joint's rows from which on that is said.
const TOLD: f64 = 0.05;

/// Torque of the acceleration that smoothing may have taken at every sample, joint by joint, N.m, with the noise that it
/// took; `known` is that of the motion as it is smoothed. `None` where it is not.
pub fn missing(
    samples: &Samples,
    twin: &Twin,
    known: &JointSeries,
) -> Result<Option<JointSeries>, SignalError> {
    let Some(further) = &samples.smoothed_further else { return Ok(None) };
    let filter = samples.torque_filter()?;
    let part = of_kinks(&samples.conditioning, samples.dt, filter.as_ref());
    let sum = |j: usize, a: &[f64]| a.iter().zip(further.joint(j)).map(|(a, b)| a + b).collect();
    let qdd = samples.qdd.map_joints(sum);
    let with = twin.torque(&Motion { qdd: &qdd, ..twin.motion(samples) });
    let joint = |j: usize, with: &[f64]| {
        let less = with.iter().zip(known.joint(j)).map(|(w, k)| part * (w - k));
        let mut torque: Vec<f64> = less.collect();
        filter.iter().for_each(|f| f.apply(&mut torque));
        torque
    };
    Ok(Some(with.map_joints(joint)))
}

/// Standard deviation `sigma` of the noise over that of each of the `rows`, where so much may be `missing` of the
/// samples around (N.m both). What noise reaches by chance, sqrt(2 ln n) standard deviations of n values (Donoho and
/// Johnstone, Biometrika 81, 1994), is none; the median tells how large that is, for kinks are rare.
pub fn sureness(missing: &[f64], rows: &[usize], around: usize, sigma: f64) -> Vec<f64> {
    let mut sizes: Vec<f64> = rows.iter().map(|&k| missing[k].abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let noise = sizes.get(sizes.len() / 2).map_or(0.0, |median| median / MEDIAN_ABSOLUTE);
    let by_chance = noise * (2.0 * (rows.len().max(2) as f64).ln()).sqrt();
    let largest = |k: usize| {
        let near = &missing[k.saturating_sub(around)..(k + around + 1).min(missing.len())];
        near.iter().fold(0.0, |most: f64, m| most.max(m.abs()))
    };
    let sure = |missing: f64| match missing > by_chance {
        true => sigma.max(f64::MIN_POSITIVE) / sigma.hypot(missing),
        false => 1.0,
    };
    rows.iter().map(|&k| sure(largest(k))).collect()
}

/// Joints (from 1) where many rows count by less than half, and how many; `sureness` of each recording's rows.
pub fn kinked(sureness: &[&Blocks]) -> Vec<(usize, f64)> {
    let lost = |j: usize| {
        let rows: Vec<f64> = sureness.iter().flat_map(|s| s.joint(j)).copied().collect();
        let low = rows.iter().filter(|s| s.powi(2) < 0.5).count();
        low as f64 / rows.len().max(1) as f64
    };
    let joints = sureness.first().map_or(0, |s| s.0.len());
    (0..joints).map(|j| (j + 1, lost(j))).filter(|(_, lost)| *lost > TOLD).collect()
}

/// What smoothing takes of a kink, over what half the cutoff takes further; both as the torque filter shows them.
/// A kink is where a joint is near standstill; its acceleration is as strong at every frequency.
fn of_kinks(how: &Conditioning, dt: f64, filter: Option<&LowPass>) -> f64 {
    let cutoff = how.sharpest_cutoff_hz();
    let smoothed = |x: &[f64], cutoff: f64| {
        let how = Conditioning { motion_cutoff_hz: cutoff, ..how.clone() };
        conditioned(&how, dt, x.to_vec(), 0)
    };
    let less = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(a, b)| a - b).collect();
    let taken = noise_gain(filter, |x| less(x.clone(), smoothed(&x, cutoff)));
    let further = noise_gain(filter, |x| less(smoothed(&x, cutoff), smoothed(&x, 0.5 * cutoff)));
    (taken / further).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the zero-phase low-pass leaves of a sine of `hz` at this rate: |H|^2 of one pass.
    fn left(how: &Conditioning, cutoff: f64, hz: f64, rate: f64) -> f64 {
        let warped = |hz: f64| (std::f64::consts::PI * hz / rate).tan();
        1.0 / (1.0 + (warped(hz) / warped(cutoff)).powi(2 * how.filter_order as i32))
    }

    /// Low-passed torque does not hold what smoothing at more than twice its cutoff takes; torque as recorded
    /// holds it all, which frequency by frequency is 1 - H and H - H/2.
    #[test]
    fn kinks_are_missed_where_torque_is_sharper_than_motion() {
        let (usual, rate) = (Conditioning::default(), 500.0);
        let low_pass = LowPass::if_wanted(usual.torque_cutoff_hz, rate, usual.filter_order);
        let filtered = of_kinks(&usual, rate.recip(), low_pass.unwrap().as_ref());
        assert!(filtered < 0.05, "{filtered}");
        let (rate, cutoff) = (125.0, usual.motion_cutoff_hz);
        let mut taken = [0.0; 2];
        for hz in (0..6250).map(|i| 0.01 * (f64::from(i) + 0.5)) {
            let [at, half] = [cutoff, 0.5 * cutoff].map(|cutoff| left(&usual, cutoff, hz, rate));
            taken[0] += (1.0 - at).powi(2);
            taken[1] += (at - half).powi(2);
        }
        let (sharp, expected) = (of_kinks(&usual, rate.recip(), None), taken[0] / taken[1]);
        assert!((sharp / expected.sqrt() - 1.0).abs() < 1e-3, "{sharp} beside {}", expected.sqrt());
    }

    #[test]
    fn rows_beside_a_kink_are_less_sure_and_noise_is_no_kink() {
        let noise = |k: usize| if k.is_multiple_of(2) { 0.1 } else { -0.1 };
        let mut missing: Vec<f64> = (0..100).map(noise).collect();
        missing[50] = 4.0;
        let rows: Vec<usize> = (0..100).collect();
        let sure = sureness(&missing, &rows, 1, 3.0);
        assert!(sure.iter().enumerate().all(|(k, s)| (*s == 0.6) == (49..=51).contains(&k)));
        assert!(sure.iter().filter(|s| **s == 1.0).count() == 97, "{sure:?}");
        let joints = Blocks(vec![sure[46..56].to_vec(), vec![1.0; 10]]);
        assert_eq!(kinked(&[&joints]), [(1, 0.3)]);
    }
}
