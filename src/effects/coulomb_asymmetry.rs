//! Unequal friction in the two directions: tau = (dF/2) sign(qd)^2 + (dFv/2) |qd|.
//!
//! On top of Coulomb and viscous friction at least as large as half the difference. While a joint
//! slides, dF cannot be told from a constant torque; standing joints tell them apart.

use super::coulomb::sign;
use super::{
    About, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct CoulombAsymmetry;

static ABOUT: About = About {
    name: "coulomb_asymmetry",
    law: "tau = (dF/2) sign(qd)^2 + (dFv/2) |qd|",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "coulomb_asymmetry",
            symbol: "dF",
            unit: "N.m",
            min: -20.0,
            max: 20.0,
            typical: 1.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "viscous_asymmetry",
            symbol: "dFv",
            unit: "N.m.s/rad",
            min: -20.0,
            max: 20.0,
            typical: 1.0,
            null: 0.0,
            role: Role::Linear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "gears and seals whose teeth or lips run differently forwards and backwards",
    remedy: "give the dry level and the damping of each direction its own value",
    source: "Armstrong-Helouvry, Control of Machines with Friction, 1991, section 4.2: direction-dependent friction",
};

impl Effect for CoulombAsymmetry {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let qd = motion.qd.joint(joint);
        let sliding = qd.iter().map(|&qd| 0.5 * sign(qd).abs()).collect();
        vec![sliding, qd.iter().map(|qd| 0.5 * qd.abs()).collect()]
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        load.dry += 0.5 * values[0] * sign(state.qd);
        load.damping += 0.5 * values[1] * sign(state.qd);
    }

    fn worked(&self) -> Option<Worked> {
        let values = [("coulomb_asymmetry", 1.0), ("viscous_asymmetry", 0.6)];
        Some(Worked::torque("1/2 + 0.6/2 |-0.5|", 0.65, &values, [0.0, -0.5, 0.0]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["coulomb_asymmetry"]))
    }
}
