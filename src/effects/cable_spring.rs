//! A cable or hose over the joint, or a spring or gas cylinder that carries the arm there (counterbalance):
//! tau = k (q - q0) + h z, z Dahl's hysteresis over the angle. It gives the rated torque within a radian at most.
//!
//! The rest angle q0 cannot be told from a constant torque.

use super::hysteresis::{along, dahl};
use super::{
    About, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked, starts,
};

pub struct CableSpring;

static ABOUT: About = About {
    name: "cable_spring",
    law: "tau = k (q - q0) + h z,  dz/dq = (1 - z sign(dq)) / w",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "cable_stiffness",
            symbol: "k",
            unit: "N.m/rad",
            min: 0.0,
            max: 150.0,
            typical: 1.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "cable_hysteresis",
            symbol: "h",
            unit: "N.m",
            min: 0.0,
            max: 10.0,
            typical: 0.4,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "cable_rest_angle",
            symbol: "q0",
            unit: "rad",
            min: -6.3,
            max: 6.3,
            typical: 0.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "cable_slip_angle",
            symbol: "w",
            unit: "rad",
            min: 0.01,
            max: 2.0,
            typical: 0.2,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 1,
    dissipates: false,
    cause: "cables, hoses and dress packs that bend and rub as the joint turns; a spring or gas cylinder that carries the \
            arm (counterbalance)",
    remedy: "add a joint spring (MuJoCo stiffness and springref) and dry friction, or reroute the cable; a counterbalance belongs in \
             the twin",
    source: "hysteresis after Dahl, Aerospace Corp. TOR-0158(3107-18), 1968; spring in series with nothing",
};

/// Least stiffness of the spring over the torque of the hysteresis, 1/rad.
const LEAST_STIFFNESS: f64 = 0.1;

impl Effect for CableSpring {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, motion: &Motion<'_>, joint: usize) -> Vec<Vec<f64>> {
        let [low, high] = starts::range(motion, joint);
        let rest = starts::between(low, high.max(low + 1e-6), 3);
        let slip = starts::between(0.05, 0.5, 3);
        starts::grid(ABOUT.parameters, &[("cable_rest_angle", rest), ("cable_slip_angle", slip)])
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let q = motion.q.joint(joint);
        let spring = q.iter().map(|q| q - nonlinear[0]).collect();
        vec![spring, along(q, |_, z, dq| dahl(z, dq, nonlinear[1]))]
    }

    /// A spring first of all: hysteresis over the angle without one is friction that creeps.
    fn is_itself(&self, linear: &[f64]) -> bool {
        linear[0] > 0.0 && linear[0] >= LEAST_STIFFNESS * linear[1]
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, z: &mut [f64], load: &mut JointLoad) {
        z[0] = dahl(z[0], state.qd * state.dt, values[3]);
        load.torque += values[0] * (state.q - values[2]) + values[1] * z[0];
    }

    fn worked(&self) -> Option<Worked> {
        let values = [
            ("cable_stiffness", 2.0),
            ("cable_hysteresis", 0.4),
            ("cable_rest_angle", 0.5),
            ("cable_slip_angle", 0.2),
        ];
        Some(Worked::torque("2 (1.5 - 0.5), nothing bent yet", 2.0, &values, [1.5, 0.0, 0.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["cable_stiffness"]))
    }
}
