//! Presliding after LuGre: a bristle whose level follows a Stribeck curve, with damping of its own.
//!
//! With the bristle's deflection w z: dz/dt = (qd - |qd| z / g(qd)) / w, g = 1 + e exp(-|qd / qd_s|).

use super::hysteresis::{along, bent};
use super::{
    About, Curve, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked,
    starts,
};

pub struct Lugre;

static ABOUT: About = About {
    name: "lugre",
    law: "tau = Fl z + D w dz/dt,  g = 1 + e exp(-|qd/qd_s|)",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "lugre",
            symbol: "Fl",
            unit: "N.m",
            min: 0.0,
            max: 60.0,
            typical: 5.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "lugre_damping",
            symbol: "D",
            unit: "N.m.s/rad",
            min: 0.0,
            max: 50.0,
            typical: 5.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "lugre_width",
            symbol: "w",
            unit: "rad",
            min: 1e-4,
            max: 0.05,
            typical: 0.002,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "lugre_excess",
            symbol: "e",
            unit: "-",
            min: 0.0,
            max: 2.0,
            typical: 0.3,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "lugre_velocity",
            symbol: "qd_s",
            unit: "rad/s",
            min: 0.005,
            max: 0.5,
            typical: 0.05,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 1,
    dissipates: false,
    cause: "asperities bend before they slip, and hold less once a lubricant film is there",
    remedy: "let the friction force follow a LuGre state instead of the sign of the velocity",
    source: "Canudas de Wit, Olsson, Astrom, Lischinsky, IEEE Trans. Automatic Control 40(3), 1995, eqs. 1 to 3",
};

impl Effect for Lugre {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn law_of(&self) -> Option<Curve> {
        Some(Curve::Reversal)
    }

    fn starts(&self, _: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        let width = starts::between(3e-4, 0.03, 5);
        let axes = [
            ("lugre_width", width),
            ("lugre_excess", vec![0.1, 0.5]),
            ("lugre_velocity", vec![0.02, 0.1]),
        ];
        starts::grid(ABOUT.parameters, &axes)
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let [width, excess, qd_s] = nonlinear else { return vec![] };
        let level = |qd: f64| curve(qd, *excess, *qd_s);
        let qd = motion.qd.joint(joint);
        let z = along(motion.q.joint(joint), |k, z, dq| bent(z, dq, *width, level(qd[k])));
        let rate = qd.iter().zip(&z).map(|(&qd, z)| qd - qd.abs() * z / level(qd)).collect();
        vec![z, rate]
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, z: &mut [f64], load: &mut JointLoad) {
        let qd = state.qd;
        let level = curve(qd, values[3], values[4]);
        z[0] = bent(z[0], qd * state.dt, values[2], level);
        load.torque += values[0] * z[0] + values[1] * (qd - qd.abs() * z[0] / level);
    }

    fn worked(&self) -> Option<Worked> {
        let values = [
            ("lugre", 5.0),
            ("lugre_damping", 3.0),
            ("lugre_width", 2e-5),
            ("lugre_excess", 0.3),
            ("lugre_velocity", 0.05),
        ];
        let text =
            "after 50 widths at the Stribeck velocity, where no bristle moves: 5 (1 + 0.3 / e)";
        let result = 5.0 * (1.0 + 0.3 * f64::exp(-1.0));
        Some(Worked::along(text, result, &values, vec![[0.0, 0.0, 0.0], [0.001, 0.05, 0.0]]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["lugre"]))
    }
}

/// g(qd)
fn curve(qd: f64, excess: f64, qd_s: f64) -> f64 {
    1.0 + excess * (-(qd / qd_s).abs()).exp()
}
