//! One independent number per effect, worked out by hand: a law that both injects and explains
//! would pass every round trip even when it is wrong.

use nalgebra::Vector3;

use super::samples::random_arm;
use super::*;
use crate::robot::{Workspace, gravity_torque};

/// Values, motion (q, qd, qdd of a pendulum of 3 kg at 0.4 m, flange at 0.5 m, row by row every
/// 20 ms) and the torque at its end worked out by hand. A new effect needs a line here.
fn closed_form(name: &str) -> (Vec<f64>, Vec<[f64; 3]>, f64) {
    let at = |q: f64, qd: f64, qdd: f64| vec![[q, qd, qdd]];
    let (right_angle, e) = (std::f64::consts::FRAC_PI_2, std::f64::consts::E);
    // From rest over 2 mrad in one row.
    let start = vec![[0.0, 0.0, 0.0], [0.002, 0.1, 0.0]];
    match name {
        "coulomb" => (vec![5.0], at(0.0, -0.3, 0.0), -5.0),
        "viscous" => (vec![6.0], at(0.0, -0.5, 0.0), -3.0),
        "viscous_quadratic" => (vec![2.0], at(0.0, -0.5, 0.0), -0.5),
        "viscous_cubic" => (vec![4.0], at(0.0, -0.5, 0.0), -0.5),
        // A Gaussian at twice the Stribeck velocity
        "stribeck" => (vec![2.0, 0.05, 2.0], at(0.0, 0.1, 0.0), 2.0 / e.powi(4)),
        // Half of both, whatever the direction
        "coulomb_asymmetry" => (vec![1.0, 0.6], at(0.0, -0.5, 0.0), 0.5 + 0.15),
        // 20 K above 25 deg C
        "temperature_friction" => (vec![-0.05, -0.1], at(0.0, 0.5, 0.0), -1.0 - 1.0),
        // 1 - 1/e of the level after one width
        "presliding" => (vec![5.0, 0.002], start, 5.0 * (1.0 - 1.0 / e)),
        // Sliding at the Stribeck velocity for 50 widths: the curve, no bristle motion
        "lugre" => {
            let values = vec![5.0, 3.0, 2e-5, 0.3, 0.05];
            (values, vec![[0.0, 0.0, 0.0], [0.001, 0.05, 0.0]], 5.0 * (1.0 + 0.3 / e))
        }
        // The first slips, the second is half, the third an eighth of the way
        "maxwell_slip" => (vec![2.0, 1.0, 4.0, 0.004], start, 2.0 + 0.5 + 0.5),
        "torque_ripple" => (vec![0.3, 0.2, 2.0], at(0.5 * right_angle, 0.1, 0.0), 0.3),
        // 2 N.m/rad over 1 rad from rest angle 0.5, and hysteresis that has not moved
        "cable_spring" => (vec![2.0, 0.4, 0.5, 0.2], at(1.5, 0.0, 0.0), 2.0),
        "rotor_inertia" => (vec![1.1], at(0.3, 1.0, -2.0), -2.2),
        "current_offset" => (vec![-0.7], at(1.0, 1.0, 1.0), -0.7),
        // 0.05 x 3 kg x 9.81 m/s2 x 0.4 m cos 60 deg
        "load_friction" => (vec![0.05], at(std::f64::consts::FRAC_PI_3, 0.1, 0.0), 0.2943),
        // (2 kg x 0.5 m + 0.1 kg.m) x 9.81 m/s2 held level, plus the inertia
        // 2 kg (0.55 m)^2 + 0.02 kg.m2 at 3 rad/s2
        "payload" => {
            let inertia = [0.01, 0.02, 0.015, 0.0, 0.0, 0.0];
            let values = [&[2.0, 0.1, 0.0, 0.0], &inertia[..], &[0.05, 0.0, 0.0]].concat();
            (values, at(0.0, 0.0, 3.0), 10.791 + 1.875)
        }
        // 0.1 kg.m x 9.81 m/s2 held level
        "link_inertia" => (vec![0.0, 0.1, 0.0, 0.0], at(0.0, 0.0, 0.0), 0.981),
        // -20 N at 0.5 m
        "external_contact" => (vec![0.0, 0.0, -20.0, 0.0, 1.0, 1.0], at(0.0, 0.0, 0.0), 10.0),
        // Upright; x dips by 0.1: sin(0.1) x 3 kg x 9.81 m/s2 x 0.4 m pull it over
        "base_tilt" => {
            (vec![0.0, 0.1, 0.0, 0.1], at(right_angle, 0.0, 0.0), 11.772 * f64::sin(0.1))
        }
        // Shown upright, truly 0.1 before it
        "encoder_offset" => (vec![0.1, 0.1], at(right_angle, 0.0, 0.0), 11.772 * f64::sin(0.1)),
        // 10 % of 3 kg x 9.81 m/s2 x 0.4 m
        "torque_constant" => (vec![0.1], at(0.0, 0.0, 0.0), 1.1772),
        // Servos of 20 N.m/rad that are 0.1 rad behind their command: 20 % less of 2 N.m
        "servo_gain" => (vec![-0.2], at(0.3, 0.0, 0.0), 0.4),
        // Off at first, powered at the end
        "servo_damping" => (vec![0.5], vec![[0.0, -2.0, 0.0]; 60], -1.0),
        // 0.03 rad of the error do nothing
        "servo_dead_band" => (vec![0.03, 0.03], at(0.0, 0.0, 0.0), 0.6),
        // 10 ms, half a row, of a command that rises by 0.5 rad/s x 20 ms in the row before: 5 mrad
        "servo_delay" => (vec![0.01, 0.01], vec![[0.0; 3]; 2], 0.1),
        "servo_offset" => (vec![-0.02], at(0.0, 0.0, 0.0), 0.4),
        _ => panic!("{name}: work out a number by hand and put it here"),
    }
}

#[test]
fn agrees_with_numbers_worked_out_by_hand() {
    let elsewhere = ["joint_coupling", "joint_flexibility", "backlash"];
    for effect in columned().filter(|e| !elsewhere.contains(&e.about().name)) {
        let name = effect.about().name;
        let (values, rows, expected) = closed_form(name);
        let samples = Samples::rows(&rows);
        let mut torques = vec![samples.explained(effect, &values, 0)];
        if !STRUCTURAL.contains(&name) {
            torques.push(samples.injected(effect, &values, 0));
        }
        for torque in torques {
            let last = torque.joint(0)[rows.len() - 1];
            assert!((last - expected).abs() < 1e-6 * expected.abs(), "{name}: {last} {expected}");
        }
    }
}

#[test]
fn a_neighbours_motion_pulls_along() {
    let samples = Samples::random(5);
    let effect = find("joint_coupling").unwrap();
    let torque = samples.explained(effect, &[2.0, -3.0], 1);
    let [inner, outer] = [0, 2].map(|j| samples.qd.joint(j)[7]);
    assert!((torque.joint(1)[7] - (2.0 * inner - 3.0 * outer)).abs() < 1e-12);
    let torque = samples.explained(effect, &[2.0, -3.0], 0);
    assert!((torque.joint(0)[7] + 3.0 * samples.qd.joint(1)[7]).abs() < 1e-12);
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

/// Half a gap and 2e4 N.m/rad under 11.772 N.m cos q: the gravity torque changes by its slope times
/// the wind-up, which holds it where the link hangs.
#[test]
fn backlash_lets_the_link_hang_behind() {
    let q = 1.0;
    let samples = Samples::rows(&[[q, 0.0, 0.0]; 90]);
    let torque = samples.explained(find("backlash").unwrap(), &[1e-3, 2e4, 20.0, 1e-3], 0);
    let (load, slope) = (11.772 * f64::cos(q), -11.772 * f64::sin(q));
    let wind_up = (2e4 * 5e-4 + load) / (2e4 + slope);
    let expected = -slope * wind_up;
    assert!((torque.joint(0)[80] - expected).abs() < 1e-6, "{} {expected}", torque.joint(0)[80]);
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

/// Ramps and steps through the sensors, by closed form.
#[test]
fn sensors_show_what_the_closed_forms_say() {
    let measured = |name: &str, values: &[f64]| {
        let mut seen = channels(|t| [0.0, 3.0 * t, 3.0, 2.0 * t]);
        find(name).unwrap().measure(values, &mut seen);
        seen
    };
    let seen = measured("time_delay", &[0.013]);
    assert!((seen.torque[50] - 2.0 * (0.5 - 0.013)).abs() < 1e-12, "{}", seen.torque[50]);
    let seen = measured("velocity_lag", &[0.05]);
    let lagged = 3.0 * (0.5 - 0.05 + 0.05 * f64::exp(-10.0));
    assert!((seen.qd[50] - lagged).abs() < 1e-12, "{} {lagged}", seen.qd[50]);
    let seen = measured("quantisation", &[0.0, 0.4, 0.3]);
    assert!((seen.qd[50] - 1.6).abs() < 1e-12 && (seen.torque[50] - 0.9).abs() < 1e-12);
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

/// What inverse dynamics cannot see changes the drive or the controller.
#[test]
fn limits_and_gains_are_in_the_mechanism() {
    let mut mechanism = Mechanism::new(pendulum());
    find("torque_saturation").unwrap().build(&[30.0], 0, &mut mechanism);
    find("controller_mismatch").unwrap().build(&[0.5, 0.7, 0.9, 0.004], 0, &mut mechanism);
    assert_eq!(mechanism.torque_limit, [30.0]);
    let control = ControlChange { bandwidth: 0.5, damping: 0.7, feedforward: 0.9, delay: 0.004 };
    assert_eq!(mechanism.control, control);
}
