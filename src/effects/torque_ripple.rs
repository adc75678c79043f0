//! Torque ripple over the joint angle: tau = a sin(N q) + b cos(N q).
//!
//! Over time it has N qd / (2 pi) Hz: a low-pass below that removes it, and 2.5 samples per wave are
//! needed to follow it. At 125 Hz order 202 (two per motor turn) is followed up to 1.5 rad/s, order 1000
//! up to 0.3 rad/s; below a low-pass at 8 Hz only up to 0.25 and 0.05 rad/s. A search goes as high as is
//! followed at the joint's median speed, at most to order 400: for higher ones move slower. Beyond that it looks at
//! one and two waves per turn of the motor, which slow parts of a motion show.

use std::f64::consts::PI;

use super::{
    About, Effect, JointLoad, JointState, Motion, Parameter, Role, RoundTrip, Scope, Worked, starts,
};
use crate::robot::Robot;

pub struct TorqueRipple;

static ABOUT: About = About {
    name: "torque_ripple",
    law: "tau = a sin(N q) + b cos(N q)",
    scope: Scope::Joint,
    parameters: &[
        Parameter {
            name: "ripple_sine",
            symbol: "a",
            unit: "N.m",
            min: -20.0,
            max: 20.0,
            typical: 0.4,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "ripple_cosine",
            symbol: "b",
            unit: "N.m",
            min: -20.0,
            max: 20.0,
            typical: 0.2,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "ripple_order",
            symbol: "N",
            unit: "1/turn",
            min: 1.0,
            max: 2000.0,
            typical: 202.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "wave generator out of round (2 per motor turn), cogging, bearing of the gear",
    remedy: "add it over the joint angle; no common simulator format holds it",
    source: "Gandhi, Ghorbel, Dabney, Modeling, identification, and compensation of friction in harmonic drives, CDC 2002",
};

impl Effect for TorqueRipple {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn outruns_motion(&self) -> bool {
        true
    }

    fn starts(&self, motion: &Motion<'_>, joint: usize) -> Vec<Vec<f64>> {
        let orders = orders(motion, joint);
        starts::grid(ABOUT.parameters, &[("ripple_order", orders)])
    }

    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        let q = motion.q.joint(joint);
        let wave = |f: fn(f64) -> f64| q.iter().map(|q| f(nonlinear[0] * q)).collect();
        vec![wave(f64::sin), wave(f64::cos)]
    }

    fn expected(&self, _: &Robot, _: usize, _: &[f64]) -> Vec<f64> {
        vec![USUAL_NM, USUAL_NM]
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        let (sin, cos) = (values[2] * state.q).sin_cos();
        load.torque += values[0] * sin + values[1] * cos;
    }

    fn worked(&self) -> Option<Worked> {
        let values = [("ripple_sine", 0.3), ("ripple_cosine", 0.2), ("ripple_order", 2.0)];
        let at = [std::f64::consts::FRAC_PI_4, 0.1, 0.0];
        Some(Worked::torque("0.3 sin(2 x 45 deg) + 0.2 cos(2 x 45 deg)", 0.3, &values, at))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["ripple_sine"]))
    }
}

/// What harmonic drives of arms this size show, N.m: rarely more.
const USUAL_NM: f64 = 1.0;

/// Highest order searched for: twice per motor turn of a gear of 200.
const HIGHEST_ORDER: f64 = 400.0;
/// Finest step between orders.
const FINEST_STEP: f64 = 0.5;
/// Slower joints show no ripple over time.
const STANDING_RAD_S: f64 = 0.02;
/// Share of the sampling rate up to which a ripple is followed at the median speed.
const RESOLVED: f64 = 0.4;

/// Waves per turn of the motor: its bearing, or a gear that is mounted aside; a wave generator, which is oval.
const PER_MOTOR_TURN: [f64; 2] = [1.0, 2.0];

/// As finely as the joint's angular range tells neighbours apart (a quarter turn of phase over
/// it), as high as samples and the torque's filter follow at the joint's median speed; those of the motor's turns beyond that.
fn orders(motion: &Motion<'_>, joint: usize) -> Vec<f64> {
    let [low, high] = starts::range(motion, joint);
    let step = FINEST_STEP.max(0.5 * PI / (high - low).max(1e-6));
    let speeds = motion.qd.joint(joint).iter().map(|qd| qd.abs());
    let mut speeds: Vec<f64> = speeds.filter(|speed| *speed > STANDING_RAD_S).collect();
    speeds.sort_by(f64::total_cmp);
    let median = speeds.get(speeds.len() / 2).copied().unwrap_or(0.0);
    let followed = (RESOLVED / motion.dt).min(motion.band_hz);
    let highest = (2.0 * PI * followed / median.max(1e-6)).min(HIGHEST_ORDER);
    let count = ((highest - 1.0) / step).floor().max(0.0) as usize;
    let mut orders: Vec<f64> = (0..=count).map(|i| 1.0 + i as f64 * step).collect();
    let turns = motion.gear_ratio.get(joint).copied().unwrap_or(0.0);
    let [last, most] = [1.0 + count as f64 * step, ABOUT.parameters[2].max];
    let of_motor = PER_MOTOR_TURN.map(|waves| waves * turns);
    orders.extend(of_motor.into_iter().filter(|order| *order > last && *order <= most));
    orders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tables::ur5::TABLE;
    use crate::series::JointSeries;

    /// At 1 rad/s a low-pass at 8 Hz follows 50 waves a turn.
    #[test]
    fn orders_are_those_that_are_followed_and_those_of_the_motor() {
        let robot = TABLE.robot();
        let q: Vec<f64> = (0..2000).map(|k| 2.0 * (0.5 * 0.01 * f64::from(k)).sin()).collect();
        let q = JointSeries::from_joints(&vec![q; robot.dof()]);
        let qd = q.map_joints(|_, q| vec![1.0; q.len()]);
        let of = |gear_ratio: &[f64]| {
            let motion = Motion::new(&robot, 0.01, &q, &qd, &qd);
            orders(&Motion { band_hz: 8.0, gear_ratio, ..motion }, 0)
        };
        let followed = of(&[]);
        let highest = followed[followed.len() - 1];
        assert!((49.0..51.0).contains(&highest), "{highest}");
        assert_eq!(of(&[101.0]), [&followed[..], &[101.0, 202.0]].concat());
        assert_eq!(of(&[1.0]), followed);
        assert_eq!(of(&[25.0]), followed, "within what is followed");
    }
}
