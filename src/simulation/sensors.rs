//! What the recording shows of the true motion: noise and quantisation, seeded.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::robot::Drive;
use crate::series::JointSeries;

/// The `[noise]` table of a scenario: white and Gaussian, independent between channels.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// Signal-to-noise ratio of each joint's current, against the mean square of that current over the
    /// recording, dB; left out: no noise.
    pub snr_db: Option<f64>,
    /// Standard deviation, rad.
    pub position_rad: f64,
    /// Standard deviation, rad/s.
    pub velocity_rad_s: f64,
}

/// The `[quantisation]` table of a scenario: rounding to multiples of a step; 0 is none.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Quantisation {
    pub position_rad: f64,
    pub velocity_rad_s: f64,
    pub current_a: f64,
}

impl Noise {
    pub(super) fn check(&self) -> Result<(), String> {
        if self.snr_db.is_some_and(|db| !(-20.0..=300.0).contains(&db)) {
            return Err("noise.snr_db: give -20 to 300 dB, or leave it out for no noise".into());
        }
        check_level("noise.position_rad", self.position_rad)?;
        check_level("noise.velocity_rad_s", self.velocity_rad_s)
    }
}

impl Quantisation {
    pub(super) fn check(&self) -> Result<(), String> {
        check_level("quantisation.position_rad", self.position_rad)?;
        check_level("quantisation.velocity_rad_s", self.velocity_rad_s)?;
        check_level("quantisation.current_a", self.current_a)
    }
}

fn check_level(key: &str, value: f64) -> Result<(), String> {
    match (0.0..=10.0).contains(&value) {
        true => Ok(()),
        false => Err(format!("{key} = {value}: give 0 (none) to 10")),
    }
}

/// Independent random streams of one seed: what one sensor draws never shifts another's noise.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stream {
    Position = 0,
    Velocity = 1,
    Current = 2,
    Feedback = 3,
}

pub(super) fn stream(seed: u64, recording: u64, which: Stream) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(8 * recording + which as u64);
    rng
}

/// `true_value` + noise of standard deviation `sigma`, rounded to multiples of `step`.
pub(super) fn measured(true_value: f64, sigma: f64, step: f64, rng: &mut impl Rng) -> f64 {
    let noise: f64 = if sigma > 0.0 { StandardNormal.sample(rng) } else { 0.0 };
    quantised(true_value + sigma * noise, step)
}

fn quantised(x: f64, step: f64) -> f64 {
    if step > 0.0 { (x / step).round() * step } else { x }
}

/// A whole channel with noise; `sigma` per joint.
pub(super) fn noisy(exact: &JointSeries, sigma: &[f64], rng: &mut ChaCha8Rng) -> JointSeries {
    exact.map_joints(|j, x| x.iter().map(|&x| measured(x, sigma[j], 0.0, rng)).collect())
}

/// A whole channel rounded to multiples of `step`.
pub(super) fn rounded(series: &JointSeries, step: f64) -> JointSeries {
    series.map_joints(|_, x| x.iter().map(|&x| quantised(x, step)).collect())
}

/// Motor current (A) of the motor torque at the joint (N.m): the torque that turns the link,
/// overcomes friction and accelerates the rotor, all of it.
pub(super) fn current(drive: &Drive, tau: &JointSeries) -> JointSeries {
    tau.map_joints(|j, tau| tau.iter().map(|tau| tau / drive.torque_per_ampere(j)).collect())
}

/// Standard deviation per joint that is `snr_db` below the joint's own mean square.
pub(super) fn sigma_of_snr(signal: &JointSeries, snr_db: Option<f64>) -> Vec<f64> {
    let ratio = snr_db.map_or(0.0, |db| 10f64.powf(-db / 20.0));
    (0..signal.joints()).map(|j| ratio * rms(signal.joint(j))).collect()
}

pub(super) fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt()
}
