//! The noise floor: what recorded torque would differ by from a perfect twin's.

use std::ops::Range;

use rayon::prelude::*;

use super::local_noise::{band_gain, impulse, local_noise, quiet_times};
use crate::robot::{Told, Workspace, mass_matrix};
use crate::series::JointSeries;
use crate::signals::{
    Conditioning, Derivatives, LowPass, Response, SAME, Samples, SavitzkyGolay, central_difference,
    cycle, mean_difference, second_difference,
};
use crate::twin::Twin;

/// Root mean square of a joint's torque noise after the torque low-pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// N.m
    pub noise_nm: f64,
    pub from: FloorFrom,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FloorFrom {
    /// Cycles of the recording held against each other: all that does not repeat.
    Repeats,
    /// The spectrum where nothing moves, taken for white: slower noise and drift are not in it.
    Estimate,
}

impl FloorFrom {
    pub fn name(self) -> &'static str {
        match self {
            Self::Repeats => "repeats",
            Self::Estimate => "estimate",
        }
    }
}

/// Sliding samples two cycles must share.
const FEWEST_PAIRS: usize = 200;
/// Shares of the Nyquist frequency between which current holds noise, no motion; beyond, interpolation damps.
const QUIET: [f64; 2] = [0.5, 0.9];
/// Band, in multiples of the motion's low-pass, where position holds more noise than motion. Below, the
/// motion's own spectrum lies above the encoder's noise; the damping is made good.
const PASSED: [f64; 2] = [1.0, 1.25];
/// No position is recorded or simulated more finely, rad.
const FINEST_RAD: f64 = 1e-5;
/// Poses the mass matrix is averaged over.
const POSES: usize = 64;

/// Noise floor of each joint, on the torque as a regression uses it. From repeats where the motion comes
/// again, else estimated.
pub fn noise_floor(samples: &Samples, twin: &Twin) -> Vec<Floor> {
    if let (Some(response), Some(told)) = (&samples.response, &samples.told) {
        return of_position(samples, response, told);
    }
    let filter = samples.torque_filter().ok().flatten();
    let estimated = estimate(samples, twin, filter.as_ref());
    let repeated = match cycle(samples, SAME) {
        Some(lag) => repeats(samples, twin, filter.as_ref(), lag),
        None => vec![None; samples.joints()],
    };
    let best = |(repeat, noise_nm): (Option<f64>, f64)| match repeat {
        Some(noise_nm) => Floor { noise_nm, from: FloorFrom::Repeats },
        None => Floor { noise_nm, from: FloorFrom::Estimate },
    };
    repeated.into_iter().zip(estimated).map(best).collect()
}

/// Half the mean squared change from cycle to cycle of the torque less the twin's (which takes off
/// what the motions differ by); `None` for joints that slide too little.
fn repeats(
    samples: &Samples,
    twin: &Twin,
    filter: Option<&LowPass>,
    lag: usize,
) -> Vec<Option<f64>> {
    let known = twin.torque(&twin.motion(samples));
    let of_joint = |j: usize| {
        let torque = samples.torque.joint(j).iter().zip(known.joint(j));
        let mut left: Vec<f64> = torque.map(|(t, k)| t - k).collect();
        filter.iter().for_each(|f| f.apply(&mut left));
        let (slides, qd) = (samples.mask(j), samples.qd.joint(j));
        let alike = |k: &usize| slides[*k] && slides[k + lag] && qd[*k] * qd[k + lag] > 0.0;
        let pairs: Vec<usize> = (0..left.len().saturating_sub(lag)).filter(alike).collect();
        let change: f64 = pairs.iter().map(|&k| (left[k + lag] - left[k]).powi(2)).sum();
        (pairs.len() >= FEWEST_PAIRS).then(|| (0.5 * change / pairs.len() as f64).sqrt())
    };
    (0..samples.joints()).map(of_joint).collect()
}

/// White noise of the torque channel through the torque filter, and of the position through
/// differentiation, inertia and the same filter:
/// sigma_i^2 = g_tau s_i^2 + g_qdd sum_j <(M_ij + Ja_i d_ij)^2> p_j^2.
fn estimate(samples: &Samples, twin: &Twin, filter: Option<&LowPass>) -> Vec<f64> {
    let nyquist = 0.5 * samples.rate_hz();
    let quiet = QUIET[0] * nyquist..QUIET[1] * nyquist;
    let motion = match samples.conditioning.motion_cutoff_hz {
        cutoff if cutoff > 0.0 && PASSED[1] * cutoff < QUIET[1] * nyquist => {
            PASSED[0] * cutoff..PASSED[1] * cutoff
        }
        _ => quiet.clone(),
    };
    let source = if from_velocity(samples) { &samples.qd } else { &samples.q };
    let spread = |(series, band): (&JointSeries, &Range<f64>)| -> Vec<f64> {
        let of =
            |j| local_noise(series.joint(j), samples.rate_hz(), band, &quiet_times(samples, j));
        (0..samples.joints()).into_par_iter().map(of).collect()
    };
    let [torque, mut position] = [(&samples.torque, &quiet), (source, &motion)].map(spread);
    let damping = damping(samples, &motion);
    position.iter_mut().for_each(|p| *p /= damping);
    let (g_tau, g_qdd) = (
        noise_gain(filter, |x| x),
        noise_gain(filter, |x| conditioned(&samples.conditioning, samples.dt, x, 1)),
    );
    let inertia = squared_inertia(samples, twin);
    let of_joint = |i: usize| {
        let carried = inertia[i].iter().zip(&position).map(|(m, p)| m * p * p);
        (g_tau * torque[i].powi(2) + g_qdd * carried.sum::<f64>()).sqrt()
    };
    (0..samples.joints()).map(of_joint).collect()
}

/// Noise of the recorded position, no less than its encoder's steps leave, as the torque that servos read it as.
fn of_position(samples: &Samples, response: &Response, told: &Told) -> Vec<Floor> {
    let nyquist = 0.5 * samples.rate_hz();
    let quiet = QUIET[0] * nyquist..QUIET[1] * nyquist;
    let of = |j: usize| {
        let rounding = told.resolution[j] / 12f64.sqrt();
        let q = told.q.joint(j);
        let white = local_noise(q, samples.rate_hz(), &quiet, &quiet_times(samples, j));
        let noise_nm = response.joints[j].scale * white.max(rounding).max(FINEST_RAD);
        Floor { noise_nm, from: FloorFrom::Estimate }
    };
    (0..samples.joints()).into_par_iter().map(of).collect()
}

/// Is the acceleration made from the recorded velocity?
fn from_velocity(samples: &Samples) -> bool {
    matches!(samples.conditioning.derivatives, Derivatives::Recorded | Derivatives::Paper)
}

/// What unit white noise comes to, as variance, after `treat` and the torque filter: the sum of
/// squares of the response to an impulse.
pub(super) fn noise_gain(filter: Option<&LowPass>, treat: impl Fn(Vec<f64>) -> Vec<f64>) -> f64 {
    let mut response = treat(impulse());
    filter.iter().for_each(|f| f.apply(&mut response));
    response.iter().map(|r| r * r).sum()
}

/// What conditioning leaves of unit noise in a band of the recorded position (or velocity).
fn damping(samples: &Samples, band_hz: &Range<f64>) -> f64 {
    let rate = samples.rate_hz();
    let left =
        band_gain(&conditioned(&samples.conditioning, samples.dt, impulse(), 0), rate, band_hz);
    (left / band_gain(&impulse(), rate, band_hz)).sqrt().clamp(1e-3, 1.0)
}

/// The position (or velocity) `x`, sampled every `dt` s, as conditioning smooths it, or with `order` 1 the acceleration
/// that it makes of it.
pub(super) fn conditioned(how: &Conditioning, dt: f64, mut x: Vec<f64>, order: usize) -> Vec<f64> {
    let cutoff = how.motion_cutoff_hz;
    if how.derivatives == Derivatives::TrackingError {
        let cutoff = if cutoff > 0.0 { cutoff } else { 0.4 / dt };
        return SavitzkyGolay::with_cutoff(cutoff, 1.0 / dt, 4).apply(&x, 2 * order);
    }
    if how.derivatives != Derivatives::Paper {
        let filter = LowPass::if_wanted(cutoff, 1.0 / dt, how.filter_order).ok().flatten();
        filter.iter().for_each(|f| f.apply(&mut x));
    }
    match (order, how.derivatives) {
        (0, _) => x,
        (_, Derivatives::Recorded) => central_difference(&x, dt),
        (_, Derivatives::Paper) => mean_difference(&x, dt),
        _ => second_difference(&x, dt),
    }
}

/// Mean over the poses of the recording of the squared mass matrix with rotor inertias, kg2.m4.
fn squared_inertia(samples: &Samples, twin: &Twin) -> Vec<Vec<f64>> {
    let dof = samples.joints();
    let mut mean = vec![vec![0.0; dof]; dof];
    let mut workspace = Workspace::new(&twin.robot);
    let rotors = twin.whole_drive().rotor_inertia;
    let mut q = vec![0.0; dof];
    let poses: Vec<usize> = (0..samples.len()).step_by((samples.len() / POSES).max(1)).collect();
    for &k in &poses {
        samples.q.sample_into(k, &mut q);
        let m = mass_matrix(&twin.robot, &mut workspace, &q);
        for (i, row) in mean.iter_mut().enumerate() {
            for (j, sum) in row.iter_mut().enumerate() {
                let rotor = if i == j { rotors[i] } else { 0.0 };
                *sum += (m[(i, j)] + rotor).powi(2) / poses.len() as f64;
            }
        }
    }
    mean
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    use super::*;
    use crate::recording::{Channel, Provenance, Recording};
    use crate::signals::condition;
    use crate::signals::testing::samples;

    const SIGMA_NM: f64 = 2.0;

    /// The default arm moving by sines of `second` cycles beside one in 8 s, its torque noisy.
    fn moving(second: f64) -> Samples {
        let mut made = samples(6, 6000, |j, t| {
            0.8 * (TAU * t / 8.0 + j as f64).sin() + 0.3 * (second * TAU * t / 8.0).sin()
        });
        let twin = Twin::default();
        made.torque = twin.torque(&twin.motion(&made));
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let noise = Normal::new(0.0, SIGMA_NM).unwrap();
        made.torque = made
            .torque
            .map_joints(|_, tau| tau.iter().map(|t| t + noise.sample(&mut rng)).collect());
        made
    }

    /// White noise through the zero-phase low-pass: sigma sqrt(2 integral of |H|^4 df / f_s).
    fn expected(samples: &Samples) -> f64 {
        let Conditioning { torque_cutoff_hz: cutoff, filter_order: order, .. } =
            samples.conditioning;
        let h4 = |f: f64| {
            let warped = |f: f64| (std::f64::consts::PI * f / samples.rate_hz()).tan();
            (1.0 + (warped(f) / warped(cutoff)).powi(2 * order as i32)).powi(-2)
        };
        let nyquist = 0.5 * samples.rate_hz();
        let integral: f64 = (0..10_000).map(|i| h4((i as f64 + 0.5) * nyquist / 1e4)).sum();
        SIGMA_NM * (integral / 1e4).sqrt()
    }

    #[test]
    fn repeats_give_the_noise_that_is_there() {
        let made = moving(2.0);
        for floor in noise_floor(&made, &Twin::default()) {
            assert_eq!(floor.from, FloorFrom::Repeats);
            assert!((floor.noise_nm / expected(&made) - 1.0).abs() < 0.1, "{floor:?}");
        }
    }

    #[test]
    fn without_repeats_the_spectrum_gives_it() {
        let made = moving(2.3);
        for floor in noise_floor(&made, &Twin::default()) {
            assert_eq!(floor.from, FloorFrom::Estimate);
            assert!((floor.noise_nm / expected(&made) - 1.0).abs() < 0.1, "{floor:?}");
        }
    }

    /// A gap that repeats with the motion is no noise.
    #[test]
    fn what_the_twin_lacks_does_not_raise_the_floor() {
        let mut made = moving(2.0);
        let friction = made.qd.map_joints(|_, qd| qd.iter().map(|w| 5.0 * w.signum()).collect());
        made.torque = made
            .torque
            .map_joints(|j, tau| tau.iter().zip(friction.joint(j)).map(|(t, f)| t + f).collect());
        let floor = noise_floor(&made, &Twin::default());
        assert!(floor.iter().all(|f| f.noise_nm < 1.1 * expected(&made)), "{floor:?}");
    }

    /// Recorded with noise on current and encoder and conditioned: what the right twin leaves.
    #[test]
    fn the_floor_is_what_a_perfect_twin_leaves() {
        use Derivatives::{Position, TrackingError};
        let twin = Twin::default();
        let exact = samples(6, 6000, |j, t| {
            0.8 * (TAU * t / 8.0 + j as f64).sin() + 0.3 * (2.3 * TAU * t / 8.0).sin()
        });
        let tau = twin.torque(&twin.motion(&exact));
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut noisy = |series: &JointSeries, sigma: f64| {
            let noise = Normal::new(0.0, sigma).unwrap();
            series.map_joints(|_, x| x.iter().map(|x| x + noise.sample(&mut rng)).collect())
        };
        let (torque, q) = (noisy(&tau, 0.05), noisy(&exact.q, 1e-4));
        let mut recording = Recording {
            time: (0..6000).map(|k| k as f64 * 0.008).collect(),
            channels: Vec::new(),
            provenance: Provenance::default(),
        };
        for (stem, series) in [
            ("actual_q", &q),
            ("joint_torque", &torque),
            ("target_q", &exact.q),
            ("target_qd", &exact.qd),
            ("target_qdd", &exact.qdd),
        ] {
            for j in 0..6 {
                let (name, values) = (format!("{stem}_{j}"), series.joint(j).to_vec());
                recording.channels.push(Channel { name, values });
            }
        }
        for (derivatives, motion_cutoff_hz) in [(Position, 12.0), (TrackingError, 10.0)] {
            let how = Conditioning { derivatives, motion_cutoff_hz, ..Conditioning::default() };
            let made = condition(&recording, &twin.drive, 6, &how).unwrap();
            let known = twin.torque(&twin.motion(&made));
            let filter = made.torque_filter().unwrap().unwrap();
            for (j, floor) in noise_floor(&made, &twin).iter().enumerate() {
                let mut left: Vec<f64> =
                    made.torque.joint(j).iter().zip(known.joint(j)).map(|(t, k)| t - k).collect();
                filter.apply(&mut left);
                let used: Vec<f64> =
                    (0..6000).filter(|&k| made.usable[k]).map(|k| left[k]).collect();
                let rms = (used.iter().map(|r| r * r).sum::<f64>() / used.len() as f64).sqrt();
                let ratio = floor.noise_nm / rms;
                assert!((ratio - 1.0).abs() < 0.2, "{derivatives:?}, joint {}: {ratio}", j + 1);
            }
        }
    }
}
