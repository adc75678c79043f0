//! The default for identification: what excites friction, gravity and inertia in one recording.

use rand_chacha::ChaCha8Rng;

use super::path::Path;
use super::plateaus::slow_plateaus;
use super::point_to_point::point_to_point;
use super::waves::{fourier, random_frequency};

/// Plateaus at two poses (Stribeck curve, both directions), sines (inertia, gravity, viscous
/// friction) and moves with rests (breakaway), by share of the time.
pub(super) fn mixed(path: &mut Path, until: f64, rng: &mut ChaCha8Rng) {
    let start = path.now;
    let mut fill = |up_to: f64, phase: fn(&mut Path, f64, &mut ChaCha8Rng)| {
        phase(path, start + up_to * (until - start), rng);
    };
    fill(0.25, slow_plateaus);
    fill(0.48, fourier);
    fill(0.73, slow_plateaus);
    fill(0.92, random_frequency);
    fill(1.0, point_to_point);
}
