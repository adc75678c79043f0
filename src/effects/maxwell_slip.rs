//! Hysteresis of presliding as three springs in parallel that slip: tau = sum Fi zi.
//!
//! The springs slip after w/4, w and 4 w; in place of Coulomb friction, or of a part of it.

use super::hysteresis::{along, slip};
use super::{
    About, Curve, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
    starts,
};

pub struct MaxwellSlip;

static ABOUT: About = About {
    name: "maxwell_slip",
    law: "tau = F1 z1 + F2 z2 + F3 z3,  dzi/dq = 1/wi, |zi| <= 1",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "maxwell_1",
            symbol: "F1",
            unit: "N.m",
            min: 0.0,
            max: 30.0,
            typical: 2.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "maxwell_2",
            symbol: "F2",
            unit: "N.m",
            min: 0.0,
            max: 30.0,
            typical: 2.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "maxwell_3",
            symbol: "F3",
            unit: "N.m",
            min: 0.0,
            max: 30.0,
            typical: 1.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "maxwell_width",
            symbol: "w",
            unit: "rad",
            min: 1e-4,
            max: 0.05,
            typical: 0.003,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 3,
    dissipates: false,
    cause: "many contacts in the gear that bend and slip one after the other, with non-local memory",
    remedy: "replace the dry friction by a few elements that slip, or by a Dahl state",
    source: "Al-Bender, Lampaert, Swevers, IEEE Trans. Automatic Control 50(11), 2005: the Maxwell-slip structure",
};

impl Effect for MaxwellSlip {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn law_of(&self) -> Option<Curve> {
        Some(Curve::Reversal)
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        starts::spread_over(ABOUT.parameters, 3e-4, 0.03)
    }

    /// Any of the springs: slips far below what the motion shows are dry friction.
    fn is_itself(&self, linear: &[f64]) -> bool {
        linear.iter().any(|level| *level != 0.0)
    }

    /// The narrowest spring turns around within a sample or two, and the arm jerks.
    fn outruns_motion(&self) -> bool {
        true
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let q = motion.q.joint(joint);
        let element = |share: f64| along(q, |_, z, dq| slip(z, dq, share * nonlinear[0]));
        WIDTHS.map(element).to_vec()
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, z: &mut [f64], load: &mut JointLoad) {
        for ((z, level), share) in z.iter_mut().zip(values).zip(WIDTHS) {
            *z = slip(*z, state.qd * state.dt, share * values[3]);
            load.torque += level * *z;
        }
    }

    fn worked(&self) -> Option<Worked> {
        let values =
            [("maxwell_1", 2.0), ("maxwell_2", 1.0), ("maxwell_3", 4.0), ("maxwell_width", 0.004)];
        let text =
            "the first slips, the second is half, the third an eighth of the way: 2 + 1/2 + 4/8";
        Some(Worked::along(text, 3.0, &values, vec![[0.0, 0.0, 0.0], [0.002, 0.1, 0.0]]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&[]))
    }
}

/// Shares of the width at which the springs slip.
const WIDTHS: [f64; 3] = [0.25, 1.0, 4.0];
