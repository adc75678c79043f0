//! Noise of a signal whose motion is slow.

use std::f64::consts::{LN_2, TAU};
use std::ops::Range;

/// Median of |N(0, 1)|.
const MEDIAN_ABSOLUTE: f64 = 0.674_489_750_196_081_7;
/// Frequencies looked at in a band.
const FREQUENCIES: usize = 256;

/// Standard deviation of white noise on a signal smooth over three samples: the second difference
/// x[k-1] - 2 x[k] + x[k+1] has the variance 6 sigma^2; its median is deaf to jumps. 0 where more
/// than half of the differences vanish (a quantised signal at rest); NaN below three samples.
pub fn noise_from_differences(x: &[f64]) -> f64 {
    let differences = x.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).collect();
    median(differences) / (MEDIAN_ABSOLUTE * 6f64.sqrt())
}

/// Standard deviation of white noise from the median periodogram in `band_hz`, where no motion is:
/// with a Hann window I(f) = |sum w x e^(-i 2 pi f t)|^2 / sum w^2 is exponential with mean sigma^2
/// and median sigma^2 ln 2 (Brockwell and Davis, Time Series: Theory and Methods, section 10.3).
/// NaN for an empty band or signal.
pub fn noise_from_periodogram(x: &[f64], rate_hz: f64, band_hz: Range<f64>) -> f64 {
    let n = x.len() as f64;
    let first = (band_hz.start * n / rate_hz).ceil().max(2.0) as usize;
    let last = (band_hz.end.min(0.5 * rate_hz) * n / rate_hz).floor() as usize;
    let stride = last.saturating_sub(first).div_ceil(FREQUENCIES).max(1);
    let mean = x.iter().sum::<f64>() / n;
    let hann = |k: usize| 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / n).cos();
    let windowed: Vec<f64> = x.iter().enumerate().map(|(k, x)| hann(k) * (x - mean)).collect();
    let norm: f64 = (0..x.len()).map(|k| hann(k).powi(2)).sum();
    let power = |m: usize| periodogram(&windowed, m) / norm;
    (median((first..=last).step_by(stride).map(power).collect()) / LN_2).sqrt()
}

/// |sum x[k] e^(-i 2 pi m k / n)|^2
fn periodogram(x: &[f64], m: usize) -> f64 {
    let n = x.len();
    let (mut re, mut im) = (0.0, 0.0);
    for (k, x) in x.iter().enumerate() {
        let (sin, cos) = (TAU * ((m * k) % n) as f64 / n as f64).sin_cos();
        re += x * cos;
        im += x * sin;
    }
    re * re + im * im
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n => 0.5 * (values[(n - 1) / 2] + values[n / 2]),
    }
}
