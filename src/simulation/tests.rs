//! Accuracy against an independent integrator and closed forms; sensors do what they claim.

use nalgebra::{Matrix3, Unit, Vector3};

use super::accuracy::{Bench, Friction, balance, consistency, creep, deviations};
use super::*;
use crate::effects::{JointLoad, Mechanism};
use crate::robot::{Body, Inertia, Joint, Limits, Placement, Robot, builtin};

fn bench(dry: f64, viscous: f64) -> Bench {
    Bench::new(builtin("ur5").unwrap(), Friction { dry, viscous })
}

fn experiment(changes: &str) -> Experiment {
    let text = format!(
        "{changes}
        [drive]
        rotor_inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
        [motion]
        kind = \"random_frequency\"
        duration_s = 10
        [effects.coulomb]
        coulomb = [6, 7, 5, 1.5, 1.2, 1]
        [effects.stribeck]
        stribeck_excess = 0.4
        stribeck_velocity = 0.05
        [effects.viscous]
        viscous = [8, 9, 7, 1.5, 1.2, 1]"
    );
    Scenario::parse(&text, "test").unwrap().work_out("test").unwrap()
}

fn run(made: &Experiment) -> Run {
    Simulation::new(&made.setup).unwrap().run(&made.fit, made.seed, 0, &mut |_| true).unwrap()
}

#[test]
fn error_against_runge_kutta_shrinks_in_proportion_to_the_step() {
    for friction in [bench(0.0, 1.0), bench(1.0, 1.0)] {
        let rows = deviations(&friction, 4.0, &[1e-3, 5e-4]).unwrap();
        let order = rows[1].order.unwrap();
        assert!((0.8..1.4).contains(&order), "{rows:?}");
        assert!(rows[1].position_rad < 5e-3, "{rows:?}");
    }
}

#[test]
fn a_joint_sticks_below_breakaway_and_goes_above_it() {
    let pose = [0.0, -1.6, 1.1, -1.2, -1.5, 0.0];
    let moved = |share| creep(&bench(1.0, 1.0), &pose, share, 2.0, 5e-4).unwrap();
    assert!(moved(0.5) < 1e-6, "crept {} rad", moved(0.5));
    assert!(moved(0.95) < 1e-6, "crept {} rad", moved(0.95));
    assert!(moved(1.05) > 0.05, "moved only {} rad", moved(1.05));
}

#[test]
fn work_of_the_motors_is_stored_or_turned_into_heat() {
    let books = balance(&bench(1.0, 1.0), 4.0, 5e-4).unwrap();
    assert!(books.heat > 10.0, "{books:?}");
    assert!(books.open_share() < 2e-3, "{books:?}");
}

#[test]
fn every_row_of_a_recording_satisfies_the_equation_of_motion() {
    let made = experiment("");
    let rows = consistency(&made.setup, &made.fit).unwrap();
    for (residual, torque) in rows.residual_nm.iter().zip(&rows.torque_nm) {
        assert!(residual < &(5e-4 * torque), "{rows:?}");
    }
}

/// A wheel of 2 kg.m2 without gravity.
fn wheel() -> Mechanism {
    let inertia =
        Inertia { mass: 1.0, com: Vector3::zeros(), about_com: Matrix3::identity() * 2.0 };
    let limits = Limits { lower: -1e9, upper: 1e9, velocity: 1e9, effort: 1e9 };
    let placement = Placement::identity();
    let joint =
        Joint { name: "j".into(), placement, axis: Unit::new_normalize(-Vector3::y()), limits };
    let body = Body { name: "wheel".into(), parent: None, joint, inertia };
    let gravity = Vector3::zeros();
    let (name, bodies) = ("wheel".into(), vec![body]);
    Mechanism::new(Robot { name, bodies, gravity, flange: placement, flange_on: None })
}

/// Pushed with 5 N.m for 1 s against 3 N.m of dry friction: (5 - 3)/2 = 1 rad/s^2 up to 1 rad/s
/// and 0.5 rad; then 3/2 rad/s^2 down: stands after another 2/3 s and 1/3 rad.
#[test]
fn a_pushed_wheel_stops_where_the_closed_form_says() {
    let load = JointLoad { dry: 3.0, ..JointLoad::default() };
    let push = |t: f64| if t < 1.0 { 5.0 } else { 0.0 };
    let mut reference = Reference::new(wheel(), &[0.0]);
    let mut plant = Plant::new(&wheel(), 1e-3).unwrap();
    for k in 0..2000 {
        let tau = push(f64::from(k) * 1e-3);
        let forces = |_: f64, _: &[f64], _: &[f64], out: &mut [f64], loads: &mut [JointLoad]| {
            (out[0], loads[0]) = (tau, load);
        };
        reference.step(1e-3, &mut { forces });
        plant.step(&[tau], &[load]);
    }
    assert!((reference.q()[0] - 5.0 / 6.0).abs() < 1e-9, "{}", reference.q()[0]);
    assert!(reference.is_stuck(0) && reference.v() == [0.0]);
    assert!((plant.q()[0] - 5.0 / 6.0).abs() < 1e-3, "{}", plant.q()[0]);
    assert!(plant.v()[0].abs() < 1e-9, "{}", plant.v()[0]);
}

#[test]
fn current_noise_has_the_asked_ratio_to_each_joints_own_current() {
    let made = experiment("rate_hz = 500\n[noise]\nsnr_db = 28");
    let run = run(&made);
    for j in 0..6 {
        let seen = run.recording.channel(&format!("actual_current_{j}")).unwrap();
        let ampere = made.setup.drive.torque_per_ampere(j);
        let exact = run.exact.tau.joint(j).iter().map(|tau| tau / ampere);
        let noise: f64 = exact.clone().zip(seen).map(|(x, y)| (x - y).powi(2)).sum();
        let snr_db = 10.0 * (exact.map(|x| x * x).sum::<f64>() / noise).log10();
        assert!((snr_db - 28.0).abs() < 0.3, "joint {j}: {snr_db} dB");
    }
}

#[test]
fn recorded_values_lie_on_the_steps_of_their_sensors() {
    let steps = "[quantisation]\nposition_rad = 1e-3\ncurrent_a = 0.01";
    let run = run(&experiment(steps));
    for (name, step) in [("actual_q_1", 1e-3), ("actual_current_2", 0.01)] {
        let values = run.recording.channel(name).unwrap();
        let off = values.iter().map(|x| (x / step - (x / step).round()).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9, "{name}");
        assert!(values.iter().any(|x| *x != values[0]), "{name} is constant");
    }
}

#[test]
fn a_simulation_can_be_used_again_and_sent_to_another_thread() {
    let made = experiment("[noise]\nsnr_db = 30\n[controller]\nfeedback = \"sensors\"");
    let mut simulation = Simulation::new(&made.setup).unwrap();
    let mut run = |number| simulation.run(&made.fit, 7, number, &mut |_| true).unwrap();
    let (first, other, again) = (run(0), run(1), run(0));
    assert_eq!(first, again);
    assert_ne!(first.recording.channels, other.recording.channels);
    let elsewhere =
        std::thread::spawn(move || simulation.run(&made.fit, 7, 0, &mut |_| true).unwrap());
    assert_eq!(elsewhere.join().unwrap(), first);
}

#[test]
fn samples_lie_in_the_middle_of_what_the_controller_holds() {
    let clock = Clock::new(0.0005, 500.0, 125.0).unwrap();
    assert_eq!((clock.steps_per_hold, clock.steps_per_sample), (4, 16));
    let controls: Vec<usize> = (0..17).filter(|&k| clock.controls(k)).collect();
    assert_eq!(controls, [0, 2, 6, 10, 14]);
    assert!(clock.samples(16) && !clock.samples(14));
    let error = Clock::new(0.0005, 500.0, 120.0).unwrap_err();
    assert!(error.to_string().contains("rate_hz = 120"), "{error}");
}

/// A motor of 0.5 kg.m2 and a wheel of 2 kg.m2 on a spring of 5000 N.m/rad swing against each
/// other at sqrt(K (1/J + 1/I)); their momentum stays.
#[test]
fn an_elastic_joint_swings_as_two_masses_do() {
    let (motor, wheel_inertia, stiffness, h) = (0.5, 2.0, 5000.0, 1e-4);
    let mut mechanism = wheel();
    mechanism.armature[0] = motor;
    let spring = crate::effects::Transmission { stiffness, ..Default::default() };
    mechanism.transmission[0] = Some(spring);
    let mut plant = Plant::new(&mechanism, h).unwrap();
    let (mut crossings, mut before) = (Vec::new(), 0.0);
    for k in 0..10_000 {
        let push = if k < 200 { 50.0 } else { 0.0 };
        plant.step(&[push], &[JointLoad::default()]);
        let wind_up = plant.q()[0] - plant.link_motion()[0][0];
        let swings = k > 200 && before < 0.0 && wind_up >= 0.0;
        if swings {
            crossings.push((k as f64 - wind_up / (wind_up - before)) * h);
        }
        before = wind_up;
    }
    let swings = (crossings.len() - 1) as f64;
    let period = (crossings[crossings.len() - 1] - crossings[0]) / swings;
    let expected =
        std::f64::consts::TAU / f64::sqrt(stiffness * (1.0 / motor + 1.0 / wheel_inertia));
    assert!(swings > 10.0 && (period / expected - 1.0).abs() < 1e-3, "{period} {expected}");
    // 50 N.m over 20 ms: 1 N.m.s for both together, kept for a second.
    let momentum = motor * plant.v()[0] + wheel_inertia * plant.link_motion()[1][0];
    assert!((momentum - 1.0).abs() < 1e-6, "{momentum}");
}

/// A torque that turns motor and wheel alike: the joint carries 2/2.5 of it. Softly applied, it winds
/// up until K w + K3 w^3 + h (1 - exp(-w / width)) is that much.
#[test]
fn a_joint_hardens_and_holds_back_as_it_winds_up() {
    let mut mechanism = wheel();
    mechanism.armature[0] = 0.5;
    let law = crate::effects::Transmission {
        stiffness: 2000.0,
        hardening: 1e8,
        damping: 200.0,
        hysteresis: 3.0,
        hysteresis_width: 2e-3,
        gap: 0.0,
    };
    mechanism.transmission[0] = Some(law);
    let mut plant = Plant::new(&mechanism, 1e-4).unwrap();
    let mut wind_up = 0.0;
    for k in 0..20_000 {
        plant.step(&[25.0 * (k as f64 / 10_000.0).min(1.0)], &[JointLoad::default()]);
        wind_up = plant.q()[0] - plant.link_motion()[0][0];
    }
    let carried = 2000.0 * wind_up + 1e8 * wind_up.powi(3) + 3.0 * (1.0 - (-wind_up / 2e-3).exp());
    assert!((carried - 20.0).abs() < 0.02, "{wind_up}: {carried}");
}

/// 3 mrad of play: a motor that pushes the wheel one way and the other moves alone in between.
#[test]
fn a_slack_joint_has_a_dead_zone() {
    let mut mechanism = wheel();
    mechanism.armature[0] = 0.5;
    let slack = crate::effects::Transmission {
        stiffness: 5000.0,
        damping: 20.0,
        gap: 3e-3,
        ..Default::default()
    };
    mechanism.transmission[0] = Some(slack);
    let mut plant = Plant::new(&mechanism, 1e-4).unwrap();
    let mut free = 0;
    let mut wind_up = 0.0;
    for k in 0..8000 {
        let push = if k < 4000 { 1.0 } else { -1.0 };
        plant.step(&[push], &[JointLoad::default()]);
        wind_up = plant.q()[0] - plant.link_motion()[0][0];
        // Alone the motor gains 1/0.5 rad/s2, with the wheel 1/2.5.
        free += usize::from((plant.a()[0].abs() - 2.0).abs() < 1e-4);
    }
    assert!(free > 300, "{free} steps without contact");
    // Pushed back at the end, the load being the wheel's 2/2.5 of the torque.
    let expected = -(1.5e-3 + 0.8 / 5000.0);
    assert!((wind_up - expected).abs() < 2e-5, "{wind_up} {expected}");
}
