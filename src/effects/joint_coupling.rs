//! Torque from a neighbour's motion: tau = ci qd_inner + co qd_outer.
//!
//! Inner is the joint before (towards the base), outer the one after; at the ends there is none.

use super::{
    About, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Shown, Worked,
};

pub struct JointCoupling;

static ABOUT: About = About {
    name: "joint_coupling",
    law: "tau = ci qd_inner + co qd_outer",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "coupling_inner",
            symbol: "ci",
            unit: "N.m.s/rad",
            min: -50.0,
            max: 50.0,
            typical: 1.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "coupling_outer",
            symbol: "co",
            unit: "N.m.s/rad",
            min: -50.0,
            max: 50.0,
            typical: 0.8,
            null: 0.0,
            role: Role::Linear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "belts, bevel gears or cables that run over a neighbouring joint",
    remedy: "add the coupling to the joint's torque (MuJoCo: a fixed tendon with damping over both joints)",
    source: "Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 5.1: coupled transmissions",
};

impl Effect for JointCoupling {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let speed = |at: Option<usize>| {
            let at = at.filter(|&j| j < motion.qd.joints());
            at.map_or(vec![0.0; motion.samples()], |j| motion.qd.joint(j).to_vec())
        };
        vec![speed(joint.checked_sub(1)), speed(Some(joint + 1))]
    }

    /// By either neighbour: the first joint and the last have one only.
    fn is_itself(&self, linear: &[f64]) -> bool {
        linear.iter().any(|drag| *drag != 0.0)
    }

    fn feels_other_joints(&self) -> bool {
        true
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        let speed = |at: Option<usize>| at.and_then(|j| state.arm.qd.get(j)).unwrap_or(&0.0);
        load.torque += values[0] * speed(state.joint.checked_sub(1))
            + values[1] * speed(Some(state.joint + 1));
    }

    fn worked(&self) -> Option<Worked> {
        let values = [("coupling_inner", 2.0), ("coupling_outer", -3.0)];
        Some(Worked::of("2 x 0.5 - 3 x 0.2", (0.4, "N.m"), &values, Shown::Between([0.5, 0.2])))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["coupling_outer"]))
    }
}
