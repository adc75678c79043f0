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
use super::{About, Effect, Mechanism, Motion, Parameter, Role, Scope, Transmission, starts};
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

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        let axes = [
            ("backlash_stiffness", vec![1e4, 5e4]),
            ("gap_reference", starts::between(2e-4, 0.02, 6)),
        ];
        starts::grid(ABOUT.parameters, &axes)
    }

    fn settle(&self, linear: &[f64], nonlinear: &mut [f64]) {
        let reference = ABOUT.parameters.iter().rfind(|p| p.is_reference());
        if let (Some(p), Some(gap0)) = (reference, nonlinear.last_mut()) {
            *gap0 = p.clamp(linear[0]);
        }
    }

    fn reach(&self, motion: &Motion<'_>, from: usize, nonlinear: &[f64]) -> Vec<JointSeries> {
        let [stiffness, damping, gap] = *nonlinear else { return vec![] };
        let teeth = Transmission { stiffness, damping, gap, ..Transmission::default() };
        let law = before(motion.giving.get(from).copied().flatten(), teeth);
        vec![lagging(motion, from, law, gap)]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        if values[0] > 0.0 {
            let [gap, stiffness, damping] = [values[0], values[1], values[2]];
            let teeth = Transmission { stiffness, damping, gap, ..Transmission::default() };
            let slot = &mut mechanism.transmission[joint];
            *slot = Some(before(*slot, teeth));
        }
    }
}

/// Slack teeth before an elastic joint: one spring after the other, and what else that has itself.
fn before(elastic: Option<Transmission>, teeth: Transmission) -> Transmission {
    let Some(elastic) = elastic else { return teeth };
    let stiffness = 1.0 / (1.0 / elastic.stiffness + 1.0 / teeth.stiffness);
    Transmission { stiffness, gap: teeth.gap, ..elastic }
}
