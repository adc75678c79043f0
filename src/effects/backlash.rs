//! Backlash: the link hangs half a gap behind the side its load pulls to, tau_load = K x beyond it.
//!
//! Positions are the motor's. How the link crosses the gap while its load passes through zero, and
//! how it winds the touching teeth up, is not linear in the gap: the columns are worked out at gap0
//! with all of that and hold where the fitted gap comes near it (fit again with gap0 = gap). Felt by
//! all joints. Of several slack joints each column comes on top of those before it
//! ([`Motion::giving`]). Injecting takes the gap alone.
//!
//! What recordings show: the gap wherever the load passes through zero while the joint moves. The
//! stiffness only where a load winds the touching teeth up (a shoulder's; an elbow's or a base's
//! hardly), the damping of the teeth not at all: blows end above the usual low-passes. An arm held
//! where its load stays about zero floats in the gap; on what path, no recording foretells.

use super::wind_up::lagging;
use super::{
    About, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Transmission, Worked,
    starts,
};
use crate::series::JointSeries;

pub struct Backlash;

static ABOUT: About = About {
    name: "backlash",
    law: "tau = ID(q - w) - ID(q),  |w| = gap/2 + |tau_load|/K",
    scope: Scope::Link,
    parameters: &[
        Parameter {
            name: "backlash_gap",
            symbol: "gap",
            unit: "rad",
            min: 0.0,
            max: 0.05,
            typical: 0.001,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "backlash_stiffness",
            symbol: "K",
            unit: "N.m/rad",
            min: 100.0,
            max: 1e6,
            typical: 2e4,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "backlash_damping",
            symbol: "D",
            unit: "N.m.s/rad",
            min: 0.0,
            max: 500.0,
            typical: 20.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "gap_reference",
            symbol: "gap0",
            unit: "rad",
            min: 1e-12,
            max: 0.05,
            typical: 0.001,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "worn or loosely set gears, keys and couplings",
    remedy: "adjust or replace the gear; in the simulator a dead zone between motor and link",
    source: "Nordin, Gutman, Controlling mechanical systems with backlash: a survey, Automatica 38(10), 2002, dead-zone model",
};

impl Effect for Backlash {
    /// Too little to search anew for it: the stiffness that is found is refined with the load.
    fn depends_on_load(&self) -> bool {
        false
    }

    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn outruns_motion(&self) -> bool {
        true
    }

    fn gives_way(&self) -> bool {
        true
    }

    fn starts(&self, motion: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        let axes = [
            ("backlash_stiffness", vec![1e4, 5e4]),
            ("gap_reference", starts::between(2e-4, 0.02, 6)),
        ];
        starts::grid_on(motion, ABOUT.parameters, &axes)
    }

    fn reach(&self, motion: &Motion<'_>, from: usize, nonlinear: &[f64]) -> Vec<JointSeries> {
        let [stiffness, damping, gap] = *nonlinear else { return vec![] };
        let known = motion.giving.get(from).copied().flatten();
        vec![lagging(motion, from, teeth(gap, stiffness, damping).before(known), gap)]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        let law = teeth(values[0], values[1], values[2]);
        mechanism.give_way(joint, values[0], law.before(mechanism.transmission[joint]));
    }

    fn worked(&self) -> Option<Worked> {
        let (load, slope) = (11.772 * f64::cos(1.0), 11.772 * f64::sin(1.0));
        let text =
            "held at 1 rad: 11.772 sin(1) x (2e4 x 0.0005 + 11.772 cos(1)) / (2e4 - 11.772 sin(1))";
        let values =
            [("backlash_gap", 1e-3), ("backlash_stiffness", 2e4), ("backlash_damping", 20.0)];
        let torque = slope * (10.0 + load) / (2e4 - slope);
        let held = Worked::along(text, torque, &values, vec![[1.0, 0.0, 0.0]; 90]);
        // Gravity is taken as a line over the wind-up.
        Some(Worked { within: 1e-3, ..held })
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted_wind_up(&["backlash_gap"]))
    }
}

fn teeth(gap: f64, stiffness: f64, damping: f64) -> Transmission {
    Transmission { stiffness, damping, gap, ..Transmission::default() }
}
