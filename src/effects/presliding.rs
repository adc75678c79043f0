//! Presliding after Dahl: tau = Fp z, friction that builds up over the distance since a reversal.
//!
//! In place of Coulomb friction, or of a part of it: where both are given, they add up.

use super::hysteresis::{along, dahl};
use super::{
    About, Curve, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
    starts,
};

pub struct Presliding;

static ABOUT: About = About {
    name: "presliding",
    law: "tau = Fp z,  dz/dq = (1 - z sign(dq)) / w",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "presliding",
            symbol: "Fp",
            unit: "N.m",
            min: 0.0,
            max: 60.0,
            typical: 5.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "presliding_width",
            symbol: "w",
            unit: "rad",
            min: 1e-4,
            max: 0.05,
            typical: 0.002,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 1,
    dissipates: false,
    cause: "asperities, seals and flexspline teeth bend before they slip",
    remedy: "let the friction force follow a Dahl or LuGre state instead of the sign of the velocity",
    source: "Dahl, Aerospace Corp. TOR-0158(3107-18), 1968; Armstrong-Helouvry et al., Automatica 30(7), 1994, section 2.1",
};

impl Effect for Presliding {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn law_of(&self) -> Option<Curve> {
        Some(Curve::Reversal)
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::spread_over(ABOUT.parameters, 3e-4, 0.03)
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        vec![along(motion.q.joint(joint), |_, z, dq| dahl(z, dq, nonlinear[0]))]
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, z: &mut [f64], load: &mut JointLoad) {
        z[0] = dahl(z[0], state.qd * state.dt, values[1]);
        load.torque += values[0] * z[0];
    }

    fn worked(&self) -> Option<Worked> {
        let result = 5.0 * (1.0 - f64::exp(-1.0));
        let values = [("presliding", 5.0), ("presliding_width", 0.002)];
        let rows = vec![[0.0, 0.0, 0.0], [0.002, 0.1, 0.0]];
        Some(Worked::along("5 (1 - exp(-0.002 / 0.002))", result, &values, rows))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["presliding"]))
    }
}
