//! Presliding after LuGre: a bristle whose level follows a Stribeck curve, with damping of its own.
//!
//! With the bristle's deflection w z: dz/dt = (qd - |qd| z / g(qd)) / w, g = 1 + e exp(-|qd / qd_s|).

use super::hysteresis::dahl;
use super::{About, Effect, JointLoad, JointState, Motion, Parameter, Role, Scope, starts};

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
        let (q, qd) = (motion.q.joint(joint), motion.qd.joint(joint));
        let mut z = 0.0;
        let bristle = |k: usize| {
            z = bent(z, q[k] - q[k.max(1) - 1], *width, level(qd[k]));
            z
        };
        let z: Vec<f64> = (0..q.len()).map(bristle).collect();
        let rate = qd.iter().zip(&z).map(|(&qd, z)| qd - qd.abs() * z / level(qd)).collect();
        vec![z, rate]
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, z: &mut [f64], load: &mut JointLoad) {
        let qd = state.qd;
        let level = curve(qd, values[3], values[4]);
        z[0] = bent(z[0], qd * state.dt, values[2], level);
        load.torque += values[0] * z[0] + values[1] * (qd - qd.abs() * z[0] / level);
    }
}

/// g(qd)
fn curve(qd: f64, excess: f64, qd_s: f64) -> f64 {
    1.0 + excess * (-(qd / qd_s).abs()).exp()
}

/// The bristle after `dx` more at constant speed: Dahl's, scaled to the level.
fn bent(z: f64, dx: f64, width: f64, level: f64) -> f64 {
    level * dahl(z / level, dx, width * level)
}
