//! Numbers worked out by hand: the one of every effect, and longer ones of those that need more.

use nalgebra::Vector3;

use super::samples::random_arm;
use super::*;
use crate::robot::{Workspace, gravity_torque};

#[test]
fn agrees_with_numbers_worked_out_by_hand() {
    for effect in CATALOGUE {
        let name = effect.about().name;
        let worked = effect.worked();
        let worked = worked.unwrap_or_else(|| panic!("{name}: work out a number by hand"));
        for found in shown(*effect, &worked) {
            let error = (found - worked.result).abs();
            assert!(error <= worked.within * worked.result.abs(), "{name}: {found}, {worked:?}");
        }
    }
}

/// What an effect makes of what a number is held against: explained, and injected where that is not a degree
/// of freedom of its own.
fn shown(effect: &dyn Effect, worked: &Worked) -> Vec<f64> {
    let values = worked.values_of(effect);
    match &worked.of {
        Shown::Pendulum(rows) => torques(effect, &values, &Samples::rows(rows), 0),
        Shown::Between([inner, outer]) => {
            let turning = [*inner, 0.0, *outer].map(|qd| vec![qd; 3]);
            let qd = JointSeries::from_joints(&turning);
            torques(effect, &values, &Samples { qd, ..Samples::random(5) }.first(3), 1)
        }
        Shown::Ramp(channel) => {
            let mut seen = channels(|t| [0.0, 3.0 * t, 3.0, 2.0 * t]);
            effect.measure(&values, &mut seen);
            vec![channel(&seen)[50]]
        }
        Shown::Mechanism(part) => {
            let mut mechanism = Mechanism::new(pendulum());
            effect.build(&values, 0, &mut mechanism);
            vec![part(&mechanism)]
        }
    }
}

/// N.m at the end of the motion.
fn torques(effect: &dyn Effect, values: &[f64], samples: &Samples, joint: usize) -> Vec<f64> {
    let mut all = vec![samples.explained(effect, values, joint)];
    if !is_structural(effect) {
        all.push(samples.injected(effect, values, joint));
    }
    all.iter().map(|torque| *torque.joint(joint).last().unwrap()).collect()
}

/// A wheel without gravity on a spring: the motor feels I (qdd - w''), w = c I qdd. For
/// q = cos(W t) that is I W^2 c I W^2 cos(W t) more negative, from the equation of two masses.
#[test]
fn an_elastic_wheel_answers_as_two_masses_do() {
    let mut robot = pendulum();
    (robot.gravity, robot.bodies[0].inertia.com) = (Vector3::zeros(), Vector3::zeros());
    let (inertia, omega, c) = (0.01, 3.0, 1e-4);
    let wave = |size: f64| {
        JointSeries::from_joints(&[(0..200)
            .map(|k| size * (omega * k as f64 * 0.001).cos())
            .collect()])
    };
    let (q, qd, qdd) = (wave(1.0), wave(0.0), wave(-omega * omega));
    let motion = Motion::new(&robot, 0.001, &q, &qd, &qdd);
    let nonlinear = [0.0, 2.0, 0.0, 1e-3, c];
    let column = &find("joint_flexibility").unwrap().columns(&motion, 0, &nonlinear)[0];
    let expected = -inertia * inertia * omega.powi(4) * (omega * 0.1).cos();
    assert!((column[100] - expected).abs() < 1e-2 * expected.abs(), "{} {expected}", column[100]);
    let spring = Transmission { stiffness: 1.0 / c, gap: 2e-3, ..Transmission::default() };
    assert!((spring.torque(3e-3) - 2e-3 / c).abs() < 1e-9);
    assert_eq!(spring.torque(-9e-4), 0.0);
    assert!((spring.wind_up(-20.0) + 3e-3).abs() < 1e-9);
}

/// Held still under 11.772 N.m cos q, wound up from zero: K w + K3 w^3 + h (1 - exp(-w / width)).
#[test]
fn a_hardening_joint_with_hysteresis_winds_up_less() {
    let (q, c, k3, h, width) = (1.0_f64, 1e-3, 1e8, 2.0, 2e-3);
    let samples = Samples::rows(&[[q, 0.0, 0.0]; 90]);
    let nonlinear = [k3, 20.0, h, width, c];
    let column = &find("joint_flexibility").unwrap().columns(&samples.motion(), 0, &nonlinear)[0];
    let w = column[80] * c / (11.772 * q.sin());
    let (load, law) = (11.772 * q.cos(), Transmission::default());
    let law = Transmission { stiffness: 1.0 / c, hardening: k3, ..law };
    // The bristle starts unbent where the spring alone carries the load, and bends on from there
    // as the link sinks to where it hangs.
    let bent = w - law.wind_up(load);
    let carried = law.torque(w) + h * bent.signum() * (1.0 - (-bent.abs() / width).exp());
    let hangs = 11.772 * (q - w).cos();
    assert!((carried - hangs).abs() < 1e-4 * hangs, "{w} {bent}: {carried} {hangs}");
}

/// Held still, all joints elastic and one slack as well: every link hangs where its transmission
/// carries the gravity torque of the arm that hangs so, which is solved for by iteration.
#[test]
fn links_of_several_elastic_joints_hang_together() {
    let robot = random_arm(3, &mut ChaCha8Rng::seed_from_u64(9));
    let at = [0.4, -0.9, 1.3];
    let still = JointSeries::from_joints(&at.map(|q| vec![q; 300]));
    let samples = Samples::along(robot.clone(), still);
    let (c, gap) = ([2e-4, 3e-4, 1e-4], 3e-3);
    let mut arm = Mechanism::new(robot.clone());
    let mut torque = [0.0; 3];
    let slack = ("backlash", 1, gap, vec![1e4, 20.0, gap]);
    let elastic = |j: usize| ("joint_flexibility", j, c[j], vec![0.0, 20.0, 0.0, 1e-3, c[j]]);
    for (name, joint, linear, nonlinear) in (0..3).map(elastic).chain([slack]) {
        let effect = find(name).unwrap();
        let motion = Motion { giving: &arm.transmission, ..samples.motion() };
        let column = effect.reach(&motion, joint, &nonlinear).remove(0);
        torque.iter_mut().enumerate().for_each(|(j, t)| *t += linear * column.joint(j)[299]);
        effect.build(&[&[linear], &nonlinear[..]].concat(), joint, &mut arm);
    }
    let carried = |q: &[f64]| {
        let mut tau = vec![0.0; 3];
        gravity_torque(&robot, &mut Workspace::new(&robot), q, &mut tau);
        tau
    };
    let mut hanging = at;
    for _ in 0..50 {
        let tau = carried(&hanging);
        let teeth =
            |j: usize| if j == 1 { 0.5 * gap * tau[j].signum() + tau[j] / 1e4 } else { 0.0 };
        hanging = [0, 1, 2].map(|j| at[j] - c[j] * tau[j] - teeth(j));
    }
    let (rigid, hangs) = (carried(&at), carried(&hanging));
    for j in 0..3 {
        let expected = hangs[j] - rigid[j];
        let error = (torque[j] - expected).abs();
        assert!(error < 0.01 * expected.abs() + 1e-4, "{j}: {} {expected}", torque[j]);
    }
}

/// A lag answers motion between samples as well as at them: a sine of frequency w comes out smaller
/// by 1/sqrt(1 + w^2 T^2) and later by atan(w T)/w, to 2e-6 of it at 16 samples per radian.
#[test]
fn a_lag_follows_motion_that_bends_between_samples() {
    let (w, lag) = (6.0, 0.06);
    let mut seen = channels(|t| [0.0, (w * t).sin(), w * (w * t).cos(), 0.0]);
    find("velocity_lag").unwrap().measure(&[lag], &mut seen);
    for k in 90..100 {
        let phase = w * 0.01 * k as f64 - (w * lag).atan();
        let settled = phase.sin() / (1.0 + (w * lag).powi(2)).sqrt();
        assert!((seen.qd[k] - settled).abs() < 2e-6, "{}: {settled}", seen.qd[k]);
    }
}

/// Delay and lag: after the correction motion and torque belong together again.
#[test]
fn corrections_undo_what_sensors_did() {
    let (w, delay) = (4.0, 0.023);
    let truth = |t: f64| {
        let (sin, cos) = f64::sin_cos(w * t);
        [sin, w * cos, -w * w * sin, 5.0 * w * cos]
    };
    for effect in CATALOGUE.iter().filter(|e| e.seen() == Seen::Channels) {
        let mut seen = channels(truth);
        effect.measure(&[delay], &mut seen);
        if effect.about().name == "velocity_lag" {
            seen.qdd = (0..100)
                .map(|k| (seen.qd[(k + 1).min(99)] - seen.qd[k.max(1) - 1]) / 0.02)
                .collect();
        }
        effect.correct(&[delay], &mut seen);
        for k in 30..90 {
            let (torque, qd) = (seen.torque[k], seen.qd[k]);
            assert!((torque - 5.0 * qd).abs() < 0.02, "{}: {torque} {qd}", effect.about().name);
        }
    }
}
