//! What is recorded of one joint, and how it can be shifted in time.

/// A joint's channels on a common, uniform time base.
#[derive(Debug, Clone, PartialEq)]
pub struct Channels {
    /// s
    pub dt: f64,
    /// rad, rad/s, rad/s^2; the acceleration is conditioned, not recorded.
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
    /// Torque of the drive at the joint, N.m.
    pub torque: Vec<f64>,
    /// Do `qd` and `qdd` come from the recorded velocity rather than from the position?
    pub velocity_is_recorded: bool,
}

/// x(t - delay), cubic between samples (Catmull-Rom), the first and last value held beyond the
/// ends. `delay` and `dt` in s; a negative delay advances.
pub(super) fn delayed(x: &[f64], delay: f64, dt: f64) -> Vec<f64> {
    let at = |k: isize| x[k.clamp(0, x.len() as isize - 1) as usize];
    let value = |k: usize| {
        let position = k as f64 - delay / dt;
        let before = position.floor();
        let (k, u) = (before as isize, position - before);
        let [a, b, c, d] = [at(k - 1), at(k), at(k + 1), at(k + 2)];
        let slope = 0.5 * (c - a);
        let curve = a - 2.5 * b + 2.0 * c - 0.5 * d;
        let twist = 0.5 * (d - a) + 1.5 * (b - c);
        b + u * (slope + u * (curve + u * twist))
    };
    (0..x.len()).map(value).collect()
}
