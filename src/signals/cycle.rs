//! Cycles of a recording: the lag after which the same motion comes again.

use rayon::prelude::*;

use super::Samples;

/// Rate of the samples and lags in the coarse search, Hz; motion of an arm is slower than a quarter of this.
const COARSE_HZ: f64 = 20.0;
/// Lags looked at in the coarse search; longer recordings are looked at more coarsely.
const MOST_LAGS: usize = 1500;
/// Shorter motions come again by chance (a rest, a single sweep), s.
const SHORTEST_S: f64 = 1.0;
/// Shares of their standard deviations by which position and velocity of two cycles may differ: what is recorded of the
/// torque then differs by its noise.
pub const SAME: [f64; 2] = [0.01, 0.03];
/// Where they differ by a tenth at most a model lacks much the same in both; how much so, what it leaves has to say.
pub const ALIKE: [f64; 2] = [0.1, 0.1];

/// The shortest lag (in samples) after which all joints repeat their position and velocity, `within` such shares, all
/// through the recording, which holds at least two cycles. `None` where nothing repeats.
pub fn cycle(samples: &Samples, within: [f64; 2]) -> Option<usize> {
    let n = samples.len();
    let shortest = (SHORTEST_S / samples.dt).ceil() as usize;
    let stride = ((1.0 / (COARSE_HZ * samples.dt)) as usize).max(n / 2 / MOST_LAGS).max(1);
    let lags: Vec<usize> = (shortest..=n / 2).step_by(stride).collect();
    let far: Vec<f64> =
        lags.par_iter().map(|&lag| mismatch(samples, lag, stride).iter().sum()).collect();
    let valley = |i: &usize| {
        let beside = |k: Option<&f64>| k.is_none_or(|k| *k >= far[*i]);
        beside(i.checked_sub(1).map(|k| &far[k])) && beside(far.get(i + 1))
    };
    let refined = |i: usize| {
        let around = lags[i].saturating_sub(stride).max(1)..=(lags[i] + stride).min(n / 2);
        let sum = |lag: &usize| mismatch(samples, *lag, 1).iter().sum::<f64>();
        around.min_by(|a, b| sum(a).total_cmp(&sum(b)))
    };
    let same = |lag: &usize| {
        let differs = mismatch(samples, *lag, 1);
        differs.iter().zip(within).all(|(differs, within)| *differs < within)
    };
    // Between coarse lags lies up to half a stride, so a valley may be higher by ten times what is the same.
    let coarse: f64 = within.iter().chain(&[10.0 * SAME[0], 10.0 * SAME[1]]).sum();
    let valleys = (0..lags.len()).filter(|i| valley(i) && far[*i] < coarse);
    valleys.filter_map(refined).find(same)
}

/// Root mean square change of position and of velocity over `lag`, relative to its standard
/// deviation over the recording times sqrt 2 (what unrelated motions differ by); the worst joint.
/// Joints that never move do not count; 1 where none does.
fn mismatch(samples: &Samples, lag: usize, stride: usize) -> [f64; 2] {
    let moves = |j: &usize| {
        let threshold = samples.conditioning.standstill_rad_s.max(1e-3);
        samples.qd.joint(*j).iter().any(|qd| qd.abs() > threshold)
    };
    let moving: Vec<usize> = (0..samples.joints()).filter(moves).collect();
    if moving.is_empty() {
        return [1.0; 2];
    }
    [&samples.q, &samples.qd].map(|series| {
        let of_joint = |&j: &usize| relative_change(series.joint(j), &samples.usable, lag, stride);
        moving.iter().map(of_joint).fold(0.0, f64::max)
    })
}

fn relative_change(x: &[f64], usable: &[bool], lag: usize, stride: usize) -> f64 {
    let (mut change, mut pairs) = (0.0, 0usize);
    for k in (0..x.len() - lag).step_by(stride).filter(|&k| usable[k] && usable[k + lag]) {
        change += (x[k + lag] - x[k]).powi(2);
        pairs += 1;
    }
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let variance = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / x.len() as f64;
    match pairs {
        0 => 1.0,
        pairs => (change / pairs as f64 / (2.0 * variance)).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::signals::testing::samples;

    fn wave(cycle_s: f64, slip: f64) -> Samples {
        samples(2, 5000, |j, t| {
            let w = TAU / cycle_s;
            (w * t + j as f64).sin() + 0.4 * ((2.0 + slip) * w * t).cos()
        })
    }

    #[test]
    fn the_period_of_a_periodic_motion_is_found() {
        assert_eq!(cycle(&wave(8.0, 0.0), SAME), Some(1000));
        assert_eq!(cycle(&wave(3.2, 0.0), SAME), Some(400));
    }

    #[test]
    fn what_does_not_come_again_has_no_period() {
        assert_eq!(cycle(&wave(8.0, 0.31), SAME), None);
        assert_eq!(cycle(&wave(25.0, 0.0), SAME), None, "less than two cycles");
        assert_eq!(cycle(&samples(2, 2000, |_, _| 0.3), SAME), None, "nothing moves");
    }
}
