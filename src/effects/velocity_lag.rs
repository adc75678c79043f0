//! A recorded velocity that lags: T d(qd_recorded)/dt + qd_recorded = qd.
//!
//! Seen only where velocity and acceleration are made from the recorded velocity.

use super::{
    About, Channels, Effect, Motion, Needed, Parameter, Role, RoundTrip, Scope, Seen, Shown,
    Worked, starts,
};

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

    fn needs(&self) -> Option<Needed> {
        Some(Needed::Velocity)
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::spread_over(ABOUT.parameters, 0.001, 0.06)
    }

    fn measure(&self, values: &[f64], channels: &mut Channels) {
        if values[0] > 0.0 {
            channels.qd = lagged(&channels.qd, &channels.qdd, values[0], channels.dt);
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

    fn worked(&self) -> Option<Worked> {
        let result = 3.0 * (0.5 - 0.05 + 0.05 * f64::exp(-10.0));
        let text = "a ramp of 3 rad/s2 after 0.5 s: 3 (0.5 - 0.05 + 0.05 exp(-0.5 / 0.05))";
        Some(Worked::of(text, (result, "rad/s"), &[("velocity_lag", 0.05)], Shown::Ramp(|c| &c.qd)))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Corrected { of_velocity: true })
    }
}

/// The lag's exact answer to the cubic through neighbouring samples with their slopes; settled at the
/// first. Lines between samples would cut the corners of a motion that is bent there: a lag of 60 ms
/// came out 10 us longer at 125 Hz.
fn lagged(x: &[f64], slope: &[f64], time_constant: f64, dt: f64) -> Vec<f64> {
    let decay = (-dt / time_constant).exp();
    let mut y = x.first().copied().unwrap_or(0.0);
    let mut next = |k: usize| {
        if let Some(before) = k.checked_sub(1) {
            let [from, to] = followed(&x[before..=k], &slope[before..=k], time_constant, dt);
            y = to + decay * (y - from);
        }
        y
    };
    (0..x.len()).map(&mut next).collect()
}

/// What a lag T that has settled shows at both ends of a cubic u: u - T u' + T^2 u'' - T^3 u'''.
fn followed(x: &[f64], slope: &[f64], t: f64, dt: f64) -> [f64; 2] {
    let mean = (x[1] - x[0]) / dt;
    let third = 6.0 * (slope[0] + slope[1] - 2.0 * mean) / (dt * dt);
    let second = (6.0 * mean - 4.0 * slope[0] - 2.0 * slope[1]) / dt;
    let bend = [second, second + third * dt];
    [0, 1].map(|i| x[i] - t * (slope[i] - t * (bend[i] - t * third)))
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
