//! The algorithms against pinocchio's numbers (`tests/golden/dynamics.py` makes them).

use nalgebra::DVector;
use serde::Deserialize;

use super::*;
use crate::robot::builtin;

#[derive(Deserialize)]
struct File {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    robot: String,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    tau: Vec<f64>,
    inverse: Vec<f64>,
    gravity: Vec<f64>,
    forward: Vec<f64>,
    /// Upper triangle, row by row.
    mass_matrix: Vec<f64>,
    kinetic: f64,
    potential: f64,
    /// Y w with w_k = cos k.
    regressor_weighted: Vec<f64>,
    regressor_norm: f64,
    flange_translation: Vec<f64>,
    /// Row by row.
    flange_rotation: Vec<f64>,
    /// Jacobian of the flange's origin, row by row.
    jacobian: Vec<f64>,
}

fn cases() -> Vec<Case> {
    let text = include_str!("../../../tests/golden/dynamics.json");
    serde_json::from_str::<File>(text).unwrap().cases
}

/// Relative to the largest of the expected numbers.
fn assert_close(what: &str, case: &Case, ours: &[f64], golden: &[f64]) {
    assert_eq!(ours.len(), golden.len(), "{what}");
    let scale = golden.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    for (o, g) in ours.iter().zip(golden) {
        assert!((o - g).abs() <= 1e-9 * scale, "{} {what}: {ours:?} {golden:?}", case.robot);
    }
}

#[test]
fn torques_and_accelerations_match_pinocchio() {
    for c in cases() {
        let robot = builtin(&c.robot).unwrap();
        let ws = &mut Workspace::new(&robot);
        let mut out = vec![0.0; 6];
        inverse_dynamics(&robot, ws, &c.q, &c.qd, &c.qdd, &mut out);
        assert_close("inverse dynamics", &c, &out, &c.inverse);
        gravity_torque(&robot, ws, &c.q, &mut out);
        assert_close("gravity", &c, &out, &c.gravity);
        forward_dynamics(&robot, ws, &c.q, &c.qd, &c.tau, &mut out);
        assert_close("forward dynamics", &c, &out, &c.forward);
    }
}

#[test]
fn mass_matrix_and_energy_match_pinocchio() {
    for c in cases() {
        let robot = builtin(&c.robot).unwrap();
        let ws = &mut Workspace::new(&robot);
        let m = mass_matrix(&robot, ws, &c.q);
        let upper: Vec<f64> =
            (0..6).flat_map(|i| (i..6).map(move |j| (i, j))).map(|k| m[k]).collect();
        assert_close("mass matrix", &c, &upper, &c.mass_matrix);
        let e = energy(&robot, ws, &c.q, &c.qd);
        assert_close("energy", &c, &[e.kinetic, e.potential], &[c.kinetic, c.potential]);
    }
}

#[test]
fn regressor_matches_pinocchio() {
    for c in cases() {
        let robot = builtin(&c.robot).unwrap();
        let y = regressor(&robot, &mut Workspace::new(&robot), &c.q, &c.qd, &c.qdd);
        let weighted = &y * DVector::from_fn(60, |k, _| (k as f64).cos());
        assert_close("regressor", &c, weighted.as_slice(), &c.regressor_weighted);
        assert_close("regressor norm", &c, &[y.norm()], &[c.regressor_norm]);
    }
}

#[test]
fn kinematics_match_pinocchio() {
    for c in cases() {
        let robot = builtin(&c.robot).unwrap();
        let flange = flange_placement(&robot, &c.q);
        assert_close("position", &c, flange.translation.as_slice(), &c.flange_translation);
        let rotation = flange.rotation.transpose();
        assert_close("orientation", &c, rotation.as_slice(), &c.flange_rotation);
        let jacobian = point_jacobian(&robot, &c.q, 5, &robot.flange.translation).transpose();
        assert_close("Jacobian", &c, jacobian.as_slice(), &c.jacobian);
    }
}
