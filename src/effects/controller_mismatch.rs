//! A controller that is not the one assumed: factors on bandwidth, damping, feed-forward; delay.
//!
//! Inverse dynamics of the recorded motion does not know the controller.

use super::{About, Effect, Mechanism, Parameter, Role, RoundTrip, Scope, Seen, Shown, Worked};

pub struct ControllerMismatch;

static ABOUT: About = About {
    name: "controller_mismatch",
    law: "tau asked for by a controller with other gains, d later",
    scope: Scope::Arm,
    parameters: &[
        Parameter {
            name: "controller_bandwidth",
            symbol: "fw",
            unit: "-",
            min: 0.2,
            max: 3.0,
            typical: 0.6,
            null: 1.0,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "controller_damping",
            symbol: "fd",
            unit: "-",
            min: 0.2,
            max: 3.0,
            typical: 0.8,
            null: 1.0,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "controller_friction",
            symbol: "ff",
            unit: "-",
            min: 0.0,
            max: 2.0,
            typical: 0.5,
            null: 1.0,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "controller_delay",
            symbol: "d",
            unit: "s",
            min: 0.0,
            max: 0.02,
            typical: 0.004,
            null: 0.0,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "gains, cycle time and friction compensation of the robot are the maker's secret",
    remedy: "identify the closed loop from command and motion, and give the simulated controller those gains",
    source: "Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 8.5.2: computed torque",
};

impl Effect for ControllerMismatch {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn seen(&self) -> Seen {
        Seen::Simulation
    }

    fn build(&self, values: &[f64], _: usize, mechanism: &mut Mechanism) {
        let control = &mut mechanism.control;
        control.bandwidth *= values[0];
        control.damping *= values[1];
        control.feedforward *= values[2];
        control.delay += values[3];
    }

    fn worked(&self) -> Option<Worked> {
        let values = [
            ("controller_bandwidth", 0.5),
            ("controller_damping", 0.7),
            ("controller_friction", 0.9),
            ("controller_delay", 0.004),
        ];
        let bandwidth = Shown::Mechanism(|m| m.control.bandwidth);
        Some(Worked::of("half of what the twin's controller has", (0.5, "-"), &values, bandwidth))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Strays { joint: 0, times: 1.5 })
    }
}
