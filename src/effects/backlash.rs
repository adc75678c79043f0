//! Backlash: the link hangs half a gap behind the side its load pulls to.
//!
//! Positions are the motor's. The link stands at q - (gap/2) sign(tau_load); it crosses the gap while
//! the load torque passes through zero, which the columns smooth over 1 N.m. Felt by all joints.

use super::joint_flexibility::per_wind_up;
use super::{About, Effect, Mechanism, Motion, Parameter, Role, Scope};
use crate::series::JointSeries;

pub struct Backlash;

static ABOUT: About = About {
    name: "backlash",
    law: "tau = ID(q - (gap/2) sign(tau_load)) - ID(q)",
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
    ],
    memory: 0,
    dissipates: false,
    cause: "worn or loosely set gears, keys and couplings",
    remedy: "adjust or replace the gear; in the simulator a dead zone between motor and link",
    source: "Nordin, Gutman, Controlling mechanical systems with backlash: a survey, Automatica 38(10), 2002, dead-zone model",
};

impl Effect for Backlash {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let all = self.reach(motion, joint, nonlinear);
        all.iter().map(|series| series.joint(joint).to_vec()).collect()
    }

    fn reach(&self, motion: &Motion<'_>, from: usize, _: &[f64]) -> Vec<JointSeries> {
        let load = motion.rigid_torque();
        let side = load.joint(from).iter().map(|tau| 0.5 * (tau / CROSSING_NM).tanh());
        vec![per_wind_up(motion, from, &side.collect::<Vec<f64>>())]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        if values[0] > 0.0 {
            let transmission = mechanism.transmission[joint].get_or_insert_default();
            transmission.gap = values[0];
            if transmission.stiffness == 0.0 {
                (transmission.stiffness, transmission.damping) = (values[1], values[2]);
            }
        }
    }
}

/// Load torque over which the teeth change sides.
const CROSSING_NM: f64 = 1.0;
