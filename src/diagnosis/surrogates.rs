//! Gaps without a cause: what is left, with the same spectrum and random phases.
//!
//! Theiler et al., "Testing for nonlinearity in time series: the method of surrogate data",
//! Physica D 58, 1992. A search that finds as much in them as in the real gap has found nothing.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rustfft::{FftPlanner, num_complex::Complex};

use super::columns::Blocks;

/// `count` surrogates of a residual. Joints get the same phases, so what they have in common stays
/// in common.
pub fn surrogates(residual: &Blocks, count: usize, seed: u64) -> Vec<Blocks> {
    let spectra: Vec<Vec<Complex<f64>>> = residual.0.iter().map(|x| spectrum(x)).collect();
    let longest = spectra.iter().map(Vec::len).max().unwrap_or(0);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let turns: Vec<f64> = (0..longest).map(|_| rng.random::<f64>()).collect();
            Blocks(spectra.iter().map(|s| turned(s, &turns)).collect())
        })
        .collect()
}

fn spectrum(x: &[f64]) -> Vec<Complex<f64>> {
    let mut values: Vec<Complex<f64>> = x.iter().map(|&re| Complex { re, im: 0.0 }).collect();
    if !values.is_empty() {
        FftPlanner::new().plan_fft_forward(values.len()).process(&mut values);
    }
    values
}

/// Frequencies whose size stands for that of the mean.
const BESIDE_MEAN: usize = 4;

/// The real series whose spectrum has these sizes, its phases turned by `turns` of a circle. A mean
/// has no phase to turn: it is drawn with the size of the slowest waves, or every surrogate would
/// hold the offset that is in question.
fn turned(spectrum: &[Complex<f64>], turns: &[f64]) -> Vec<f64> {
    let n = spectrum.len();
    if n == 0 {
        return Vec::new();
    }
    let mut values = spectrum.to_vec();
    let slowest = &spectrum[1.min(n - 1)..(1 + BESIDE_MEAN).min(n)];
    let size = (slowest.iter().map(Complex::norm_sqr).sum::<f64>() / slowest.len() as f64).sqrt();
    let sway = std::f64::consts::SQRT_2 * (std::f64::consts::TAU * turns[0]).cos();
    values[0] = Complex { re: spectrum[0].re.signum() * size * sway, im: 0.0 };
    for k in 1..n.div_ceil(2) {
        values[k] *= Complex::from_polar(1.0, std::f64::consts::TAU * turns[k]);
        values[n - k] = values[k].conj();
    }
    FftPlanner::new().plan_fft_inverse(n).process(&mut values);
    values.iter().map(|v| v.re / n as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surrogates_keep_the_spectrum_and_nothing_else() {
        let x: Vec<f64> = (0..501).map(|k| (0.1 * k as f64).sin() + (k % 7) as f64).collect();
        let residual = Blocks(vec![x.clone(), Vec::new(), x.iter().map(|v| -2.0 * v).collect()]);
        for surrogate in surrogates(&residual, 5, 3) {
            let (before, after) = (spectrum(&x), spectrum(surrogate.joint(0)));
            for (b, a) in before.iter().zip(&after).skip(1) {
                assert!((b.norm() - a.norm()).abs() < 1e-9 * before[0].norm());
            }
            let mean = x.iter().sum::<f64>() / 501.0;
            let common: f64 =
                x.iter().zip(surrogate.joint(0)).map(|(a, b)| (a - mean) * (b - mean)).sum();
            let power: f64 = x.iter().map(|a| (a - mean).powi(2)).sum();
            let mean_after = surrogate.joint(0).iter().sum::<f64>() / 501.0;
            assert!(mean_after.abs() < 0.5 * mean, "the offset stays: {mean_after}");
            assert!(common.abs() < 0.9 * power, "{common} of {power}");
            assert!(surrogate.joint(1).is_empty());
            let together = surrogate.joint(0).iter().zip(surrogate.joint(2));
            assert!(together.into_iter().all(|(a, b)| (b + 2.0 * a).abs() < 1e-9));
        }
    }
}
