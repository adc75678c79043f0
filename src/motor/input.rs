//! Random voltage and measurement noise; everything follows from a seed.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use serde::{Deserialize, Serialize};

use super::simulate::{Hold, Input};

/// How a random voltage is drawn, and how noisily its effect is measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Excitation {
    /// Levels are independent and uniform in [-peak, peak], V.
    pub peak: f64,
    /// Shortest and longest time a level is held, s; log-uniform in between.
    pub hold: [f64; 2],
    /// s
    pub duration: f64,
    /// s
    pub sample_time: f64,
    /// Random seed for levels and hold times.
    pub seed: u64,
    /// Signal-to-noise ratio of the measured channels, each against its own power, dB.
    pub snr_db: f64,
}

/// Draws holds until the duration is filled.
pub fn random_voltage(e: &Excitation) -> Input {
    let mut rng = ChaCha8Rng::seed_from_u64(e.seed);
    let mut left = (e.duration / e.sample_time).round() as usize;
    let mut holds = Vec::new();
    let (shortest, ratio) = (e.hold[0], e.hold[1] / e.hold[0]);
    while left > 0 {
        let voltage = e.peak * (2.0 * rng.random::<f64>() - 1.0);
        let time = shortest * ratio.powf(rng.random::<f64>());
        let samples = ((time / e.sample_time).round() as usize).clamp(1, left);
        holds.push(Hold { voltage, samples });
        left -= samples;
    }
    Input { holds, sample_time: e.sample_time }
}

/// Standard deviation of white noise at a signal-to-noise ratio in dB against the signal's own
/// power: sd^2 = mean(y^2) / 10^(snr/10).
pub fn noise_deviation(signal: &[f64], snr_db: f64) -> f64 {
    let power = signal.iter().map(|y| y * y).sum::<f64>() / signal.len().max(1) as f64;
    (power / 10.0_f64.powf(snr_db / 10.0)).sqrt()
}

/// The signal with white Gaussian noise of the given ratio.
pub fn with_noise(signal: &[f64], snr_db: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let deviation = noise_deviation(signal, snr_db);
    let mut draw = || -> f64 { StandardNormal.sample(rng) };
    signal.iter().map(|y| y + deviation * draw()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_ratio_asked_for() {
        let signal: Vec<f64> = (0..50_000).map(|k| 3.0 * (k as f64 * 0.01).sin()).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let noisy = with_noise(&signal, 28.0, &mut rng);
        let power = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>();
        let noise = power(&mut signal.iter().zip(&noisy).map(|(a, b)| b - a));
        let ratio = 10.0 * (power(&mut signal.iter().copied()) / noise).log10();
        assert!((ratio - 28.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn voltage_fills_the_range_and_follows_the_seed() {
        let e = Excitation {
            peak: 5.0,
            hold: [0.1, 1.0],
            duration: 1000.0,
            sample_time: 0.01,
            seed: 1,
            snr_db: 28.0,
        };
        let u = random_voltage(&e);
        assert_eq!(u.samples(), 100_000);
        let volts = u.holds.iter().map(|h| h.voltage);
        let (low, high) = volts.fold((9.0_f64, -9.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        assert!((-5.0..-4.9).contains(&low) && (4.9..=5.0).contains(&high));
        assert!(u.holds.iter().rev().skip(1).all(|h| (10..=100).contains(&h.samples)));
        assert_eq!(u, random_voltage(&e));
        assert_ne!(u, random_voltage(&Excitation { seed: 2, ..e }));
    }
}
