//! A torque channel that is recorded late: torque(t) = torque_true(t - d).
//!
//! Corrected by delaying the motion as much, so that the model is shifted and not the current.

use super::channels::delayed;
use super::{
    About, Channels, DriveKind, Effect, Motion, Parameter, Role, RoundTrip, Scope, Seen, Shown,
    Worked, starts,
};

pub struct TimeDelay;

static ABOUT: About = About {
    name: "time_delay",
    law: "tau recorded at t = tau at t - d",
    scope: Scope::Joint,
    parameters: &[Parameter {
        name: "time_delay",
        symbol: "d",
        unit: "s",
        min: 0.0,
        max: 0.1,
        typical: 0.01,
        null: 0.0,
        role: Role::Nonlinear,
    }],
    memory: 0,
    dissipates: false,
    cause: "filters and buses that bring current and position with different latency",
    remedy: "shift the channel by the delay, or record both in the same cycle",
    source: "Hollerbach, Khalil, Gautier, Model identification, Handbook of Robotics, 2nd ed., 2016, section 6.3: parallel filtering",
};

impl Effect for TimeDelay {
    fn of_drive(&self) -> DriveKind {
        DriveKind::Current
    }

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
        channels.torque = delayed(&channels.torque, values[0], channels.dt);
    }

    fn correct(&self, values: &[f64], channels: &mut Channels) {
        let Channels { dt, q, qd, qdd, .. } = channels;
        for motion in [q, qd, qdd] {
            *motion = delayed(motion, values[0], *dt);
        }
    }

    fn worked(&self) -> Option<Worked> {
        let text = "a ramp of 2 N.m/s after 0.5 s: 2 (0.5 - 0.013)";
        Some(Worked::of(text, (0.974, "N.m"), &[("time_delay", 0.013)], Shown::Ramp(|c| &c.torque)))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Corrected { of_velocity: false })
    }
}
