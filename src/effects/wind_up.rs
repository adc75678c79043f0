//! How far the links of an elastic or slack joint lag behind its motor, from the motor's motion.
//!
//! With the other joints as recorded, the wind-up w = q_motor - q_link of one joint follows
//!
//! ```text
//! M_jj(q) w'' = tau_load(t) - T(w, w'),     q_link = q - w
//! ```
//!
//! where tau_load is the rigid arm's torque and T the transmission's (Spong, J. Dyn. Sys. Meas.
//! Control 109(4), 1987, eqs. 2 and 3, for a given motor motion).

use super::{Motion, Transmission};
use crate::series::JointSeries;

/// Longest step of the integration, s.
const STEP_S: f64 = 2.5e-4;
/// Of a link, kg.m2: divides.
const LIGHTEST: f64 = 1e-9;

/// w, w', w'' at the samples: means over the interval around each, as filters see them.
pub(super) struct WindUp([Vec<f64>; 3]);

/// Wind-up of `joint` along the motion, from rest under its load. Links too light for the step
/// are taken heavier: they follow their load within it all the same.
pub(super) fn wind_up(motion: &Motion<'_>, joint: usize, transmission: &Transmission) -> WindUp {
    let (load, slopes) = (motion.rigid_torque(), motion.slopes(joint));
    // M_jj is how the joint's torque grows with its acceleration.
    let (load, inertia) = (load.joint(joint), slopes.0[2].joint(joint));
    let parts = (motion.dt / STEP_S).ceil().max(1.0);
    let h = motion.dt / parts;
    let mut w = transmission.wind_up(load.first().copied().unwrap_or(0.0));
    let (mut rate, mut z) = (0.0, 0.0);
    let stiffest = transmission.stiffest();
    let mut means = [(); 3].map(|()| Vec::with_capacity(load.len()));
    for k in 0..load.len() {
        let mut sums = [0.0; 3];
        for i in 0..parts as usize {
            let along = (i as f64 + 0.5) / parts - 0.5;
            let at = |x: &[f64]| between(x, k, along);
            let damping = transmission.damping_at(w);
            let torque = transmission.torque(w) + transmission.hysteresis * z + damping * rate;
            let lightest = h * (4.0 * h * stiffest).max(2.0 * damping);
            let acceleration = (at(load) - torque) / at(inertia).max(lightest.max(LIGHTEST));
            rate += h * acceleration;
            w += h * rate;
            z = transmission.bent(z, h * rate);
            sums = [sums[0] + w, sums[1] + rate, sums[2] + acceleration];
        }
        means.iter_mut().zip(sums).for_each(|(mean, sum)| mean.push(sum / parts));
    }
    WindUp(means)
}

/// Linear between samples, `along` -0.5 to 0.5 sample away from sample `k`.
fn between(x: &[f64], k: usize, along: f64) -> f64 {
    let next = if along < 0.0 { k.saturating_sub(1) } else { (k + 1).min(x.len() - 1) };
    x[k] + along.abs() * (x[next] - x[k])
}

/// N.m at every joint when the links of `joint` lag by `shape`, per unit of `reference`: linear in
/// the shape.
pub(super) fn lagging(
    motion: &Motion<'_>,
    joint: usize,
    shape: &WindUp,
    reference: f64,
) -> JointSeries {
    let slopes = motion.slopes(joint);
    let mut lag = JointSeries::zeros(motion.q.joints(), motion.samples());
    for (slope, shape) in slopes.0.iter().zip(&shape.0) {
        for j in 0..lag.joints() {
            let terms = slope.joint(j).iter().zip(shape);
            let sum = lag.joint_mut(j).iter_mut().zip(terms);
            sum.for_each(|(lag, (slope, w))| *lag -= slope * w / reference);
        }
    }
    lag
}
