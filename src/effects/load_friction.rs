//! Load-dependent friction: tau = mu sign(qd) |tau_load|, tau_load what the gear transmits.
//!
//! Explained with the torque of `motion.robot` as the load (what is behind the gear: friction and
//! rotor inertia lie on the motor's side). A payload must be in that robot, or mu comes out too
//! large.

use super::coulomb::sign;
use super::{
    About, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
};

pub struct LoadFriction;

impl Effect for LoadFriction {
    fn depends_on_load(&self) -> bool {
        true
    }

    fn about(&self) -> &'static About {
        &About {
            name: "load_friction",
            law: "tau = mu sign(qd) |tau_load|",
            scope: Scope::Joint,
            parameters: &[Parameter {
                name: "load_friction",
                symbol: "mu",
                unit: "-",
                min: 0.0,
                max: 1.0,
                typical: 0.06,
                null: 0.0,
                role: Role::Linear,
            }],
            memory: 0,
            dissipates: true,
            cause: "teeth and bearings press harder under load: friction grows with the torque",
            remedy: "add mu |joint torque| to the dry level in every step; no simulator format \
                     holds it",
            source: "Hamon, Gautier, Garrec, IROS 2010; Wahrburg et al., ICRA 2018",
        }
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, _: &[f64]) -> Vec<Vec<f64>> {
        let load = motion.rigid_torque();
        let both = load.joint(joint).iter().zip(motion.qd.joint(joint));
        vec![both.map(|(load, &qd)| sign(qd) * load.abs()).collect()]
    }

    fn act(&self, values: &[f64], state: &JointState, _: &mut [f64], load: &mut JointLoad) {
        load.dry += values[0] * state.transmitted.abs();
    }

    fn worked(&self) -> Option<Worked> {
        let level = "0.05 x 3 kg x 9.81 m/s2 x 0.4 m cos(60 deg)";
        let at = [std::f64::consts::FRAC_PI_3, 0.1, 0.0];
        Some(Worked::torque(level, 0.2943, &[("load_friction", 0.05)], at))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["load_friction"]))
    }
}
