//! Samples made by hand for tests.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{Conditioning, Samples, central_difference, second_difference};
use crate::series::JointSeries;

/// `joints` moving by `q(joint, time)` (rad) for `n` samples at 125 Hz, without torque; all usable
/// but half a second at both ends.
pub fn samples(joints: usize, n: usize, q: impl Fn(usize, f64) -> f64) -> Samples {
    let dt = 0.008;
    let at = |j| (0..n).map(|k| q(j, k as f64 * dt)).collect::<Vec<f64>>();
    let q = JointSeries::from_joints(&(0..joints).map(at).collect::<Vec<_>>());
    let margin = 62;
    Samples {
        dt,
        start: 0.0,
        qd: q.map_joints(|_, q| central_difference(q, dt)),
        qdd: q.map_joints(|_, q| second_difference(q, dt)),
        torque: JointSeries::zeros(joints, n),
        q,
        told: None,
        response: None,
        sensed: None,
        smoothed_further: None,
        temperature: None,
        usable: (0..n).map(|k| k >= margin && k < n - margin).collect(),
        conditioning: Conditioning::default(),
        notes: Vec::new(),
    }
}

/// Adds noise of this standard deviation to the torque of every joint, N.m.
pub fn noisy(samples: &mut Samples, sigma: f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for j in 0..samples.joints() {
        for torque in samples.torque.joint_mut(j) {
            let normal: f64 = StandardNormal.sample(&mut rng);
            *torque += sigma * normal;
        }
    }
}
