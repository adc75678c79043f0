//! Sums of sines with random amplitudes and phases, scaled to the limits, faded in and out.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::path::Path;
use super::peaks::peaks;
use super::trajectory::{Piece, Shape, Wave};

const HARMONICS: usize = 10;
/// Longest period of a Fourier series, s.
const PERIOD_S: f64 = 12.0;
const RANDOM_HZ: [f64; 2] = [0.05, 1.2];
const FADE_S: f64 = 2.0;
/// Shortest stretch worth a sum of sines, s.
const MIN_S: f64 = 1.0;
/// Left for what lies between the grid points on which peaks are measured.
const MARGIN: f64 = 0.995;

/// Finite Fourier series, q = q0 + sum over k of a_k sin(k w t + phi_k) (Swevers et al., IEEE
/// Trans. Robotics and Automation 13(5), 1997, Eq. 3), all joints on one base frequency.
pub(super) fn fourier(path: &mut Path, until: f64, rng: &mut ChaCha8Rng) {
    fill(path, until, rng, |k, _| (k + 1) as f64 / PERIOD_S);
}

/// Every sine of every joint has its own random frequency, equally likely per octave: the
/// "random frequency content" of the paper's section 4.2.
pub(super) fn random_frequency(path: &mut Path, until: f64, rng: &mut ChaCha8Rng) {
    let octaves = (RANDOM_HZ[1] / RANDOM_HZ[0]).ln();
    fill(path, until, rng, |_, rng| RANDOM_HZ[0] * (octaves * rng.random_range(0.0..1.0)).exp());
}

/// Goes to the centre and fills the time until `until` with waves of the given frequencies.
fn fill(
    path: &mut Path,
    until: f64,
    rng: &mut ChaCha8Rng,
    frequency: impl Fn(usize, &mut ChaCha8Rng) -> f64,
) {
    if path.here != path.envelope.centre {
        path.go(path.envelope.centre.clone(), 0.7, until - MIN_S);
    }
    let duration = until - path.now;
    if duration < MIN_S || path.here != path.envelope.centre {
        return path.rest_until(until);
    }
    let waves = path.here.iter().map(|_| draw(rng, &frequency)).collect();
    let mut piece = Piece {
        duration,
        from: vec![0.0; path.here.len()],
        shape: Shape::Waves { waves, fade: FADE_S.min(duration / 4.0) },
    };
    scale(&mut piece, path);
    path.push(duration, piece.shape);
}

/// Amplitudes fall with frequency, so that each sine has the same share of the velocity.
fn draw(rng: &mut ChaCha8Rng, frequency: &impl Fn(usize, &mut ChaCha8Rng) -> f64) -> Vec<Wave> {
    let wave = |k| {
        let frequency_hz = frequency(k, rng);
        let amplitude = rng.random_range(0.3..1.0) / frequency_hz;
        Wave { amplitude, frequency_hz, phase: rng.random_range(0.0..TAU) }
    };
    (0..HARMONICS).map(wave).collect()
}

/// Scales each joint to the first of its limits: range, velocity or acceleration.
fn scale(piece: &mut Piece, path: &Path) {
    let e = path.envelope;
    let factors: Vec<f64> = (0..piece.from.len())
        .map(|j| {
            let [q, qd, qdd] = peaks(piece, j);
            (e.range[j] / q).min(e.velocity[j] / qd).min(e.acceleration[j] / qdd) * MARGIN
        })
        .collect();
    if let Shape::Waves { waves, .. } = &mut piece.shape {
        for (waves, factor) in waves.iter_mut().zip(factors) {
            waves.iter_mut().for_each(|w| w.amplitude *= factor);
        }
    }
}
