//! A twin that is right stays beside its recording; one that is wrong leaves it as it must.

use super::*;
use crate::robot::{Workspace, forward_dynamics_with_rotors, gravity_torque};
use crate::series::JointSeries;
use crate::signals::{Conditioning, Samples, condition};
use crate::simulation::{ControllerSettings, Experiment, Run, Scenario, Simulation};
use crate::twin::Twin;

const SCENARIO: &str = "
    [drive]
    rotor_inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
    [motion]
    kind = \"random_frequency\"
    duration_s = 12
    [effects.coulomb]
    coulomb = [6, 7, 5, 1.5, 1.2, 1]
    [effects.viscous]
    viscous = [8, 9, 7, 1.5, 1.2, 1]
    [effects.payload]
    payload_mass = 2
    payload_moment_x = 0
    payload_moment_y = 0
    payload_moment_z = 0.14";

fn simulated() -> (Experiment, Run) {
    let made = Scenario::parse(SCENARIO, "test").unwrap().work_out("test").unwrap();
    let run = Simulation::new(&made.setup).unwrap().run(&made.fit, 1, 0, &mut |_| true).unwrap();
    (made, run)
}

/// Knows everything but the payload.
fn lacking(made: &Experiment) -> Twin {
    let mut twin = Twin { drive: made.setup.drive.clone(), ..Twin::default() };
    twin.values.insert("coulomb".into(), vec![6.0, 7.0, 5.0, 1.5, 1.2, 1.0]);
    twin.values.insert("viscous".into(), vec![8.0, 9.0, 7.0, 1.5, 1.2, 1.0]);
    twin
}

fn knowing(made: &Experiment) -> Twin {
    let mut twin = lacking(made);
    twin.effects.push("payload".into());
    for (axis, value) in [("mass", 2.0), ("moment_x", 0.0), ("moment_y", 0.0), ("moment_z", 0.14)] {
        twin.values.insert(format!("payload_{axis}"), vec![value]);
    }
    twin
}

#[test]
fn the_twin_that_knows_stays_closer_in_both_loops() {
    let (made, run) = simulated();
    let [lacking, knowing] = [lacking(&made), knowing(&made)];
    let samples = condition(&run.recording, &lacking.drive, 6, &Conditioning::default()).unwrap();
    let q = command(&run.recording, &samples).unwrap().unwrap();
    let of = |twin| {
        let controller = ControllerSettings::default();
        let replayed = closed_loop(twin, &q, &samples, &controller, &mut |_| true).unwrap();
        errors(twin, &replayed, &samples).unwrap()
    };
    let (before, after) = (of(&lacking), of(&knowing));
    assert!(after.position_rad < 0.1 * before.position_rad, "{before:?} {after:?}");
    assert!(after.torque_nm < 0.1 * before.torque_nm, "{before:?} {after:?}");
    assert!(after.open_loop_rad < 0.2 * before.open_loop_rad, "{before:?} {after:?}");
}

/// At rest in `pose` for 2 s under a constant torque.
fn held(pose: &[f64], torque: &[f64]) -> Samples {
    let n = 250;
    let each = |values: &[f64]| {
        JointSeries::from_joints(&values.iter().map(|v| vec![*v; n]).collect::<Vec<_>>())
    };
    Samples {
        dt: 0.008,
        start: 0.0,
        q: each(pose),
        qd: JointSeries::zeros(6, n),
        qdd: JointSeries::zeros(6, n),
        torque: each(torque),
        told: None,
        response: None,
        sensed: None,
        smoothed_further: None,
        temperature: None,
        usable: vec![true; n],
        conditioning: Conditioning::default(),
        notes: Vec::new(),
    }
}

#[test]
fn too_much_torque_moves_the_twin_by_half_its_acceleration_times_time_squared() {
    let mut twin = Twin { effects: Vec::new(), ..Twin::default() };
    twin.drive.rotor_inertia = vec![1.1, 1.1, 1.1, 0.14, 0.14, 0.14];
    let pose = [0.3, -1.2, 0.9, -0.4, 0.8, 0.1];
    let mut workspace = Workspace::new(&twin.robot);
    let mut torque = [0.0; 6];
    gravity_torque(&twin.robot, &mut workspace, &pose, &mut torque);
    assert!(open_loop(&twin, &held(&pose, &torque)).unwrap() < 1e-9);

    torque[0] += 1.0;
    torque[2] += 0.5;
    let mut qdd = [0.0; 6];
    forward_dynamics_with_rotors(
        &twin.robot,
        &mut workspace,
        &twin.drive.rotor_inertia,
        &pose,
        &[0.0; 6],
        &torque,
        &mut qdd,
    );
    let square = |a: &f64| (0.5 * a * WINDOW_S * WINDOW_S).powi(2);
    let expected = (qdd.iter().map(square).sum::<f64>() / 6.0).sqrt();
    let found = open_loop(&twin, &held(&pose, &torque)).unwrap();
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
}

#[test]
fn friction_that_holds_keeps_the_twin_where_it_was() {
    let mut twin = Twin { effects: vec!["coulomb".into()], ..Twin::default() };
    twin.drive.rotor_inertia = vec![1.1, 1.1, 1.1, 0.14, 0.14, 0.14];
    twin.values.insert("coulomb".into(), vec![60.0; 6]);
    assert!(open_loop(&twin, &held(&[0.0, -0.2, 0.1, 0.0, 0.0, 0.0], &[0.0; 6])).unwrap() < 1e-6);
}

#[test]
fn without_a_stretch_in_one_piece_nothing_can_be_driven() {
    let mut samples = held(&[0.0; 6], &[0.0; 6]);
    samples.usable = (0..samples.len()).map(|k| k % 20 != 0).collect();
    let error = open_loop(&Twin::default(), &samples).unwrap_err();
    assert_eq!(error, ResimulationError::NoWindow { seconds: WINDOW_S });
}
