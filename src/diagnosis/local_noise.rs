//! Noise in a band of frequencies, where nothing happens in time.

use std::ops::Range;

use crate::signals::{LowPass, Samples, erode};

const ORDER: usize = 4;
/// Samples of the response to an impulse.
const IMPULSE: usize = 2001;
/// Median of |N(0, 1)|.
pub const MEDIAN_ABSOLUTE: f64 = 0.674_489_750_196_081_7;
/// Nearer to standstill, friction that changes its sign rings in every band, s.
const AWAY_S: f64 = 0.1;
const FEWEST: usize = 200;

/// Where `joint` slides and no reversal is near; where it hardly does, all that is usable.
pub fn quiet_times(samples: &Samples, joint: usize) -> Vec<bool> {
    let away = erode(&samples.sliding(joint), (AWAY_S / samples.dt).round() as usize);
    let quiet: Vec<bool> = away.iter().zip(&samples.usable).map(|(a, u)| *a && *u).collect();
    match quiet.iter().filter(|q| **q).count() {
        FEWEST.. => quiet,
        _ => samples.usable.clone(),
    }
}

/// Standard deviation of white noise whose part in `band_hz` is that of `x` at the `times`: from
/// the median of the band-passed signal, which is deaf to what rings now and then (a spectrum of
/// the whole is not). 0 if the band does not fit the rate or no time is given.
pub fn local_noise(x: &[f64], rate_hz: f64, band_hz: &Range<f64>, times: &[bool]) -> f64 {
    let Some(passed) = band_pass(x, rate_hz, band_hz) else { return 0.0 };
    let of_times = passed.iter().zip(times).filter(|(_, t)| **t);
    let mut sizes: Vec<f64> = of_times.map(|(v, _)| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    median / (MEDIAN_ABSOLUTE * band_gain(&impulse(), rate_hz, band_hz).sqrt())
}

/// Gain of the variance of white noise through a filter with this response to an [`impulse`] and then through
/// the band; 1 if the band does not fit the rate.
pub fn band_gain(response: &[f64], rate_hz: f64, band_hz: &Range<f64>) -> f64 {
    let passed = band_pass(response, rate_hz, band_hz);
    passed.map_or(1.0, |r| r.iter().map(|r| r * r).sum())
}

/// Unit impulse: 1 amid zeros.
pub fn impulse() -> Vec<f64> {
    let mut impulse = vec![0.0; IMPULSE];
    impulse[IMPULSE / 2] = 1.0;
    impulse
}

fn band_pass(x: &[f64], rate_hz: f64, band_hz: &Range<f64>) -> Option<Vec<f64>> {
    let edges = [band_hz.start, band_hz.end].map(|hz| LowPass::new(hz, rate_hz, ORDER));
    let [Ok(low), Ok(high)] = &edges else { return None };
    let (mut below, mut slow) = (x.to_vec(), x.to_vec());
    high.apply(&mut below);
    low.apply(&mut slow);
    Some(below.iter().zip(&slow).map(|(b, s)| b - s).collect())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn steps_and_slow_motion_do_not_count_as_noise() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let x: Vec<f64> = (0..6000)
            .map(|k| {
                let noise: f64 = StandardNormal.sample(&mut rng);
                let t = k as f64 * 0.008;
                30.0 * (TAU * 0.4 * t).sin() + 5.0 * (TAU * 0.4 * t).cos().signum() + 0.1 * noise
            })
            .collect();
        let no_step = |k: usize| (TAU * 0.4 * k as f64 * 0.008).cos().abs() > 0.3;
        let times: Vec<bool> = (0..6000).map(|k| (60..5940).contains(&k) && no_step(k)).collect();
        let found = local_noise(&x, 125.0, &(31.0..56.0), &times);
        assert!((found / 0.1 - 1.0).abs() < 0.1, "{found}");
        assert_eq!(local_noise(&x, 125.0, &(31.0..80.0), &[true; 6000]), 0.0);
    }
}
