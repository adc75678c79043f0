//! A force on the flange for a while or below a height: tau = -J^T F while it touches.
//!
//! F acts on the arm at the flange's origin, in base axes.

use nalgebra::{DVector, Matrix3xX, Vector3};

use super::flange::torque_per_force;
use super::{
    About, ArmState, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope,
    Worked,
};
use crate::robot::{Robot, flange_placement};
use crate::series::JointSeries;

pub struct ExternalContact;

static ABOUT: About = About {
    name: "external_contact",
    law: "tau = -J^T F,  start <= t < start + D,  z <= height",
    scope: Scope::Arm,
    parameters: &[
        Parameter {
            name: "contact_x",
            symbol: "Fx",
            unit: "N",
            min: -500.0,
            max: 500.0,
            typical: 10.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "contact_y",
            symbol: "Fy",
            unit: "N",
            min: -500.0,
            max: 500.0,
            typical: 5.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "contact_z",
            symbol: "Fz",
            unit: "N",
            min: -500.0,
            max: 500.0,
            typical: 20.0,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "contact_start",
            symbol: "start",
            unit: "s",
            min: 0.0,
            max: 1e5,
            typical: 0.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "contact_duration",
            symbol: "D",
            unit: "s",
            min: 0.0,
            max: 1e5,
            typical: 10.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "contact_height",
            symbol: "height",
            unit: "m",
            min: -10.0,
            max: 10.0,
            typical: 10.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "somebody pushes, a tool touches, a hose pulls: in time or in place, not everywhere",
    remedy: "leave the stretch out, or model the contact and the body that is touched",
    source: "Haddadin, De Luca, Albu-Schaffer, Robot collisions: a survey, IEEE Trans. Robotics 33(6), 2017, eq. 1",
};

impl Effect for ExternalContact {
    fn depends_on_load(&self) -> bool {
        false
    }

    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, motion: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        let mut rows: Vec<_> =
            windows(motion).iter().map(|[at, d]| vec![*at, *d, OPEN_M]).collect();
        let whole = (motion.samples() as f64 + 1.0) * motion.dt;
        rows.extend(heights(motion).iter().map(|&height| vec![motion.start, whole, height]));
        rows
    }

    /// Both ends of the window move by up to half its length.
    fn bracket(&self, nonlinear: &[f64], i: usize) -> Option<[f64; 2]> {
        match (i, nonlinear) {
            (0, [start, duration, _]) => Some([start - 0.5 * duration, start + 0.5 * duration]),
            (1, [_, duration, _]) => Some([0.5 * duration, 1.5 * duration]),
            _ => None,
        }
    }

    fn lasts_a_while(&self) -> bool {
        true
    }

    /// When and where it touches: what a simulation says of that changes by jumps, from sample to sample.
    fn kept(&self) -> &'static [&'static str] {
        &["contact_start", "contact_duration", "contact_height"]
    }

    fn reach(&self, motion: &Motion<'_>, _: usize, nonlinear: &[f64]) -> Vec<JointSeries> {
        let flange = motion.flange();
        let touches: Vec<bool> = (0..motion.samples())
            .map(|k| in_time(motion.time(k), nonlinear) && low(flange.height[k], nonlinear))
            .collect();
        let while_it_touches = |all: &JointSeries| {
            let gated = |(torque, touches): (&f64, &bool)| if *touches { *torque } else { 0.0 };
            all.map_joints(|_, torque| torque.iter().zip(&touches).map(gated).collect())
        };
        flange.per_force.iter().map(while_it_touches).collect()
    }

    fn feels_other_joints(&self) -> bool {
        true
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        load.torque += torque(values, state.arm).map_or(0.0, |torque| torque[state.joint]);
    }

    fn act_on_arm(&self, values: &[f64], arm: &ArmState<'_>, loads: &mut [JointLoad]) {
        let Some(torque) = torque(values, arm) else { return };
        loads.iter_mut().zip(&torque).for_each(|(load, torque)| load.torque += torque);
    }

    fn worked(&self) -> Option<Worked> {
        let values = [
            ("contact_z", -20.0),
            ("contact_start", 0.0),
            ("contact_duration", 1.0),
            ("contact_height", 1.0),
        ];
        Some(Worked::torque("20 N x 0.5 m, downwards at the flange", 10.0, &values, [0.0; 3]))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["contact_z"]))
    }
}

/// N.m at every joint; `None` where nothing touches.
fn torque(values: &[f64], arm: &ArmState<'_>) -> Option<DVector<f64>> {
    let force = Vector3::new(values[0], values[1], values[2]);
    Some(touched(arm.robot, arm.q, arm.time, &values[3..])?.tr_mul(&force))
}

/// N.m at every joint (columns) per N along x, y, z (rows); `None` where nothing touches.
fn touched(robot: &Robot, q: &[f64], time: f64, gate: &[f64]) -> Option<Matrix3xX<f64>> {
    let touches = in_time(time, gate)
        && (gate[2] >= OPEN_M || low(flange_placement(robot, q).translation.z, gate));
    touches.then(|| torque_per_force(robot, q))
}

fn in_time(time: f64, gate: &[f64]) -> bool {
    (gate[0]..gate[0] + gate[1]).contains(&time)
}

fn low(height: f64, gate: &[f64]) -> bool {
    gate[2] >= OPEN_M || height <= gate[2]
}

/// Above any arm, m: a contact wherever it is.
const OPEN_M: f64 = 10.0;
/// Shortest window, s.
const SHORTEST_S: f64 = 0.5;
/// Shares of the motion below the heights at which searches begin.
const SHARES: [f64; 7] = [0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9];

/// Start and duration, s: the whole motion, its halves, quarters and so on, each shifted by half
/// its length.
fn windows(motion: &Motion<'_>) -> Vec<[f64; 2]> {
    let whole = motion.samples() as f64 * motion.dt;
    let mut windows = vec![[motion.start, whole + motion.dt]];
    let mut parts = 2;
    while whole / parts as f64 >= SHORTEST_S {
        let length = whole / parts as f64;
        let shifted = (0..2 * parts - 1).map(|i| motion.start + 0.5 * i as f64 * length);
        windows.extend(shifted.map(|start| [start, length]));
        parts *= 2;
    }
    windows
}

/// Heights, m, below which the flange is for given shares of the motion.
fn heights(motion: &Motion<'_>) -> Vec<f64> {
    let mut all = motion.flange().into_owned().height;
    all.sort_by(f64::total_cmp);
    let at = |share: f64| all.get((share * all.len() as f64) as usize).copied();
    SHARES.into_iter().filter_map(at).collect()
}
