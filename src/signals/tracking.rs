//! Motion as commanded plus what the arm is off it: no differentiation noise but in the small part.

use super::{Conditioning, SavitzkyGolay, erode};
use crate::series::JointSeries;

/// Degree of the polynomials that smooth: their second derivative is a parabola.
const DEGREE: usize = 4;
/// What counts as near standstill, and how long the change from one smoother to the other takes, s.
const NEAR_S: f64 = 0.06;
const FADE_S: f64 = 0.07;

/// Commanded motion (q, qd, qdd) plus the smoothed tracking error e = q - q_target and its
/// derivatives; near standstill smoothed less.
pub fn tracked(
    q: &JointSeries,
    target: &[JointSeries; 3],
    dt: f64,
    how: &Conditioning,
) -> [JointSeries; 3] {
    let error = q.map_joints(|j, q| zip(q, target[0].joint(j), |q, t| q - t));
    let usual = if how.motion_cutoff_hz > 0.0 { how.motion_cutoff_hz } else { 0.4 / dt };
    let smoothed = |cutoff: f64| {
        let smoother = SavitzkyGolay::with_cutoff(cutoff, 1.0 / dt, DEGREE);
        [0, 1, 2].map(|order| {
            let corrections = error.map_joints(|_, e| smoother.apply(e, order));
            corrections.map_joints(|j, c| zip(c, target[order].joint(j), |c, t| c + t))
        })
    };
    let slow = smoothed(usual);
    if how.standstill_cutoff_hz <= usual {
        return slow;
    }
    let sharp = smoothed(how.standstill_cutoff_hz);
    let nearness: Vec<Vec<f64>> =
        (0..q.joints()).map(|j| nearness(slow[1].joint(j), how.standstill_rad_s, dt)).collect();
    [0, 1, 2].map(|order| {
        slow[order].map_joints(|j, x| {
            let blend = |(k, (x, s)): (usize, (&f64, &f64))| x + nearness[j][k] * (s - x);
            x.iter().zip(sharp[order].joint(j)).enumerate().map(blend).collect()
        })
    })
}

/// 1 near standstill, 0 away from it, a ramp between.
fn nearness(qd: &[f64], standstill_rad_s: f64, dt: f64) -> Vec<f64> {
    let sliding: Vec<bool> = qd.iter().map(|v| v.abs() > standstill_rad_s).collect();
    let [reach, fade] = [NEAR_S, 0.5 * FADE_S].map(|s| (s / dt).round() as usize);
    let away = erode(&sliding, reach);
    let near: Vec<f64> = away.iter().map(|a| f64::from(u8::from(!a))).collect();
    let mean = |k: usize| {
        let around = &near[k.saturating_sub(fade)..(k + fade + 1).min(near.len())];
        around.iter().sum::<f64>() / around.len() as f64
    };
    (0..near.len()).map(mean).collect()
}

fn zip(a: &[f64], b: &[f64], f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| f(*a, *b)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// e = 1e-4 |t - 1|: a kink of the motion where the joint, commanded at t - 1, stands still.
    fn kinked(standstill_cutoff_hz: f64) -> [JointSeries; 3] {
        let dt = 0.008;
        let time = |k: usize| k as f64 * dt - 1.0;
        let of = |f: &dyn Fn(f64) -> f64| {
            JointSeries::from_joints(&[(0..250).map(|k| f(time(k))).collect::<Vec<f64>>()])
        };
        let q = of(&|t| 0.5 * t * t + 1e-4 * t.abs());
        let target = [of(&|t| 0.5 * t * t), of(&|t| t), of(&|_| 1.0)];
        let how = Conditioning {
            motion_cutoff_hz: 10.0,
            standstill_cutoff_hz,
            standstill_rad_s: 0.03,
            ..Conditioning::default()
        };
        tracked(&q, &target, dt, &how)
    }

    #[test]
    fn a_kink_is_smeared_less_where_smoothing_is_lighter_near_standstill() {
        let smeared = |[_, _, qdd]: [JointSeries; 3]| {
            let beside = (250 / 2 + 5)..(250 / 2 + 12);
            beside.map(|k| (qdd.joint(0)[k] - 1.0).abs()).sum::<f64>()
        };
        assert!(smeared(kinked(20.0)) < 0.6 * smeared(kinked(0.0)));
    }

    #[test]
    fn far_from_standstill_both_smooth_alike() {
        let [usual, lighter] = [kinked(0.0), kinked(20.0)];
        for order in 0..3 {
            let [a, b] = [&usual, &lighter].map(|m| m[order].joint(0)[..95].to_vec());
            assert_eq!(a, b);
        }
    }
}
