//! A recorded velocity that lags: T d(qd_recorded)/dt + qd_recorded = qd.
//!
//! Seen only where velocity and acceleration are made from the recorded velocity.

use super::{About, Channels, Effect, Motion, Parameter, Role, Scope, Seen, starts};

pub struct VelocityLag;

static ABOUT: About = About {
    name: "velocity_lag",
    law: "tau computed from qd that lags: T qd_r' + qd_r = qd",
    scope: Scope::Joint,
    parameters: &[Parameter {
        name: "velocity_lag",
        symbol: "T",
        unit: "s",
        min: 0.0,
        max: 0.2,
        typical: 0.02,
        null: 0.0,
        role: Role::Nonlinear,
    }],
    memory: 0,
    dissipates: false,
    cause: "a low-pass or observer in the drive between encoder and log",
    remedy: "differentiate the recorded position instead, or lead the velocity by the lag",
    source: "Franklin, Powell, Emami-Naeini, Feedback Control of Dynamic Systems: first-order lag, exact step response",
};

impl Effect for VelocityLag {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn seen(&self) -> Seen {
        Seen::Channels
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::spread_over(ABOUT.parameters, 0.001, 0.06)
    }

    fn measure(&self, values: &[f64], channels: &mut Channels) {
        if values[0] > 0.0 {
            channels.qd = lagged(&channels.qd, values[0], channels.dt);
        }
    }

    /// qd = qd_recorded + T d(qd_recorded)/dt, and once more for the acceleration.
    fn correct(&self, values: &[f64], channels: &mut Channels) {
        if !channels.velocity_is_recorded {
            return;
        }
        let Channels { dt, qd, qdd, .. } = channels;
        let jerk = slope(qdd, *dt);
        qd.iter_mut().zip(qdd.iter()).for_each(|(qd, qdd)| *qd += values[0] * qdd);
        qdd.iter_mut().zip(jerk).for_each(|(qdd, jerk)| *qdd += values[0] * jerk);
    }
}

/// The lag's exact answer to the line between neighbouring samples; settled at the first.
fn lagged(x: &[f64], time_constant: f64, dt: f64) -> Vec<f64> {
    let (decay, ratio) = ((-dt / time_constant).exp(), time_constant / dt);
    let mut y = x.first().copied().unwrap_or(0.0);
    let mut before = y;
    let mut next = |&x: &f64| {
        let rise = x - before;
        y = x - ratio * rise + decay * (y - before + ratio * rise);
        before = x;
        y
    };
    x.iter().map(&mut next).collect()
}

/// Central difference, one-sided at the ends.
fn slope(x: &[f64], dt: f64) -> Vec<f64> {
    let last = x.len().saturating_sub(1);
    let at = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
        if b > a { (x[b] - x[a]) / ((b - a) as f64 * dt) } else { 0.0 }
    };
    (0..x.len()).map(at).collect()
}
