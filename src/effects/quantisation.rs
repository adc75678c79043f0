//! Channels rounded to steps: position, velocity and torque.
//!
//! Nothing undoes it; it acts like white noise of step / sqrt(12) where a signal crosses many steps.

use super::{
    About, Channels, Effect, Motion, Parameter, Role, RoundTrip, Scope, Seen, Shown, Worked, starts,
};

pub struct Quantisation;

static ABOUT: About = About {
    name: "quantisation",
    law: "tau recorded = step round(tau / step); q, qd alike",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "position_step",
            symbol: "dq",
            unit: "rad",
            min: 0.0,
            max: 0.1,
            typical: 0.001,
            null: 0.0,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "velocity_step",
            symbol: "dqd",
            unit: "rad/s",
            min: 0.0,
            max: 1.0,
            typical: 0.005,
            null: 0.0,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "torque_step",
            symbol: "dtau",
            unit: "N.m",
            min: 0.0,
            max: 20.0,
            typical: 0.2,
            null: 0.0,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "encoder resolution, converter bits, or a log that prints too few digits",
    remedy: "log more digits; differentiate over longer stretches where the encoder is coarse",
    source: "Widrow, Kollar, Quantization Noise, Cambridge University Press, 2008, chapter 4: variance step^2 / 12",
};

impl Effect for Quantisation {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn seen(&self) -> Seen {
        Seen::Simulation
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::spread_over(ABOUT.parameters, 1e-5, 0.01)
    }

    fn measure(&self, values: &[f64], channels: &mut Channels) {
        let Channels { q, qd, torque, .. } = channels;
        for (channel, step) in [q, qd, torque].into_iter().zip(values).filter(|(_, s)| **s > 0.0) {
            channel.iter_mut().for_each(|x| *x = (*x / step).round() * step);
        }
    }

    fn worked(&self) -> Option<Worked> {
        let values = [("position_step", 0.0), ("velocity_step", 0.4), ("torque_step", 0.3)];
        Some(Worked::of("1.5 in steps of 0.4", (1.6, "rad/s"), &values, Shown::Ramp(|c| &c.qd)))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Steps { channel: "actual_q", joint: 3, parameter: "position_step" })
    }
}
