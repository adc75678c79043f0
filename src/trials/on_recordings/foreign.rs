//! More effects no catalogue entry describes, as laws along a recorded motion.

use std::f64::consts::TAU;

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use crate::effects::{About, Effect, JointLoad, JointState, Scope};
use crate::trials::foreign::{FOREIGN, about, parameter};
use crate::trials::shapes;

/// Foreign effects that are simulated too, and those for recordings alone.
pub fn all() -> impl Iterator<Item = &'static dyn Effect> {
    FOREIGN.iter().copied().chain(ON_RECORDINGS)
}

pub fn find(name: &str) -> Option<&'static dyn Effect> {
    all().find(|e| e.about().name == name)
}

const ON_RECORDINGS: [&dyn Effect; 3] = [&EccentricFriction, &RoughSector, &CrossedSpeeds];

/// Parameter values at unit size of an effect for recordings alone, at `joint`.
pub fn proportions(
    name: &str,
    joint: usize,
    ground: &shapes::Ground<'_>,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<f64>> {
    match name {
        "eccentric_friction" => {
            Some(vec![1.0, f64::from(rng.random_range(1..=4)), rng.random_range(0.0..TAU)])
        }
        "rough_sector" => Some(vec![1.0, *ground.q.joint(joint).choose(rng)?]),
        "crossed_speeds" => Some(vec![if rng.random_bool(0.5) { 1.0 } else { -1.0 }]),
        _ => None,
    }
}

/// A bearing that is tight on one side of its turn.
struct EccentricFriction;

static ECCENTRIC_FRICTION: About = about(
    "eccentric_friction",
    "tau = F (1 + sin(n q + p)) sign(qd)",
    Scope::Joint,
    &[
        parameter("eccentric_friction", "N.m", 40.0, 2.0),
        parameter("eccentric_order", "1/turn", 10.0, 1.0),
        parameter("eccentric_phase", "rad", TAU, 0.0),
    ],
);

impl Effect for EccentricFriction {
    fn about(&self) -> &'static About {
        &ECCENTRIC_FRICTION
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        load.dry += values[0] * (1.0 + (values[1] * state.q + values[2]).sin());
    }
}

/// Friction that jumps where a worn part of the teeth begins.
struct RoughSector;

static ROUGH_SECTOR: About = about(
    "rough_sector",
    "tau = F sign(qd),  q > q0",
    Scope::Joint,
    &[parameter("rough_friction", "N.m", 40.0, 2.0), parameter("rough_angle", "rad", TAU, 0.0)],
);

impl Effect for RoughSector {
    fn about(&self) -> &'static About {
        &ROUGH_SECTOR
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        if state.q > values[1] {
            load.dry += values[0];
        }
    }
}

/// A torque with the product of a joint's speed and its neighbour's.
struct CrossedSpeeds;

static CROSSED_SPEEDS: About = about(
    "crossed_speeds",
    "tau = c qd qd_neighbour",
    Scope::Joint,
    &[parameter("crossed_speeds", "N.m.s2/rad2", 100.0, 2.0)],
);

impl Effect for CrossedSpeeds {
    fn about(&self) -> &'static About {
        &CROSSED_SPEEDS
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        let neighbour = if state.joint == 0 { 1 } else { state.joint - 1 };
        let speed = state.arm.qd.get(neighbour).copied().unwrap_or(0.0);
        load.torque += values[0] * state.arm.qd[state.joint] * speed;
    }
}
