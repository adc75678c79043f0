//! Samples made by hand for the tests of this room.

use crate::series::JointSeries;
use crate::signals::{Conditioning, Samples, central_difference, second_difference};

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
        sensed: None,
        temperature: None,
        usable: (0..n).map(|k| k >= margin && k < n - margin).collect(),
        conditioning: Conditioning::default(),
        notes: Vec::new(),
    }
}
