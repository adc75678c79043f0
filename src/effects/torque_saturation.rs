//! A drive that gives no more than a limit: tau_motor = clip(tau_asked, -limit, limit).
//!
//! What was recorded is the clipped torque, and the motion belongs to it.

use super::{
    About, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Seen, Shown, Worked,
    starts,
};

pub struct TorqueSaturation;

static ABOUT: About = About {
    name: "torque_saturation",
    law: "tau asked for is clipped to -limit .. limit",
    scope: Scope::Joint,
    parameters: &[Parameter {
        name: "torque_limit",
        symbol: "limit",
        unit: "N.m",
        min: 1.0,
        max: 1000.0,
        typical: 30.0,
        null: f64::INFINITY,
        role: Role::Nonlinear,
    }],
    memory: 0,
    dissipates: false,
    cause: "current limit of the drive, a weak supply, or a safety setting",
    remedy: "give the actuator its limit (URDF effort, MuJoCo ctrlrange) or ask for slower motion",
    source: "Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 5.2: current limiter of the power amplifier",
};

impl Effect for TorqueSaturation {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn seen(&self) -> Seen {
        Seen::Simulation
    }

    fn starts(&self, motion: &Motion<'_>, joint: usize) -> Vec<Vec<f64>> {
        let torque = motion.drive_torque();
        let peak = torque.joint(joint).iter().fold(0.0, |m: f64, t| m.max(t.abs()));
        let limits =
            [0.5, 0.6, 0.7, 0.8, 0.9, 0.97].map(|share| ABOUT.parameters[0].clamp(share * peak));
        starts::grid(ABOUT.parameters, &[("torque_limit", limits.to_vec())])
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        let limit = &mut mechanism.torque_limit[joint];
        *limit = limit.min(values[0]);
    }

    fn worked(&self) -> Option<Worked> {
        let limit = Shown::Mechanism(|mechanism| mechanism.torque_limit[0]);
        Some(Worked::of(
            "clipped beyond its value",
            (30.0, "N.m"),
            &[("torque_limit", 30.0)],
            limit,
        ))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::Strays { joint: 0, times: 1.5 })
    }
}
