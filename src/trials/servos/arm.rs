//! The arm of a case before anything is hidden in it: servos, friction, encoders, motions.

use std::collections::BTreeMap;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::motion::{Kind, Settings};
use crate::recording::Recording;
use crate::simulation::{ControllerSettings, Noise, Quantisation, Run, Scenario, Setup};
use crate::trials::case::ROBOT;
use crate::twin::{DriveTable, PerJoint, ServoTable, Twin};

/// A desk arm of six servos, as large as those that robot-learning data sets are recorded on.
pub const URDF: &str = include_str!("../../../scenarios/robots/desk_arm.urdf");

/// Forces and masses of that arm beside those of a UR5: 3.3 N.m of 150, 0.5 kg of 18.
pub const SCALE: f64 = 0.025;

/// Such arms are recorded at 50 Hz, and their encoders have 4096 steps a turn.
pub const RATE_HZ: f64 = 50.0;
const STEP_RAD: f64 = std::f64::consts::TAU / 4096.0;
const NOISE_RAD: f64 = 2e-4;

/// What a position is known to, rad: noise, and rounding to steps.
pub fn position_noise() -> f64 {
    (NOISE_RAD * NOISE_RAD + STEP_RAD * STEP_RAD / 12.0).sqrt()
}

/// The desk arm with servos, friction and motions that differ from case to case. Supply, gain register, rotor and
/// friction at each joint lie around those that Rhoban/bam identified of such servos.
pub fn arm(duration_s: f64, rng: &mut ChaCha8Rng) -> Scenario {
    let mut each =
        |low: f64, high: f64| PerJoint::Each((0..6).map(|_| rng.random_range(low..high)).collect());
    let friction = [("coulomb", each(0.03, 0.08)), ("viscous", each(0.03, 0.09))];
    let rotor = each(0.02, 0.035);
    let table = |(name, value): (&str, PerJoint)| {
        (name.to_string(), BTreeMap::from([(name.to_string(), value)]))
    };
    let motion = Settings {
        kind: Kind::Mixed,
        seed: rng.random_range(0..1 << 40),
        duration_s,
        rest_s: 0.5,
        range_rad: rng.random_range(0.5..0.8),
        speed_rad_s: rng.random_range(1.5..2.5),
        acceleration_rad_s2: rng.random_range(6.0..10.0),
        home_rad: None,
        series: None,
    };
    let check = Settings { seed: motion.seed.wrapping_add(1), ..motion.clone() };
    Scenario {
        robot: ROBOT.into(),
        seed: rng.random_range(0..1 << 40),
        rate_hz: RATE_HZ,
        step_s: 0.001,
        drive: DriveTable { rotor_inertia: Some(rotor), ..DriveTable::default() },
        servo: Some(ServoTable {
            model: Some("sts3215".into()),
            volts: Some(PerJoint::Each(vec![rng.random_range(6.5..8.0); 6])),
            gain_register: Some(PerJoint::Each(vec![rng.random_range(16.0_f64..40.0).round(); 6])),
            ..ServoTable::default()
        }),
        check: toml::Table::try_from(&check).unwrap_or_default(),
        motion,
        controller: ControllerSettings { rate_hz: 500.0, ..ControllerSettings::default() },
        noise: Noise { snr_db: None, position_rad: NOISE_RAD, velocity_rad_s: 0.0 },
        quantisation: Quantisation { position_rad: STEP_RAD, velocity_rad_s: 0.0, current_a: 0.0 },
        effects: friction.map(table).into(),
        ..Scenario::default()
    }
}

/// A simulation begins where its command does, and the arm sags from there to where its servos hold it, s.
const SETTLED_S: f64 = 0.3;

/// What the owner of the arm knows. Servos that look at their error now and then are late by half that time.
pub fn twin(setup: &Setup) -> Twin {
    let mut drive = setup.drive.clone();
    if let Some(servo) = &mut drive.servo {
        servo.delay.iter_mut().for_each(|d| *d += 0.5 / setup.controller.rate_hz);
    }
    Twin { source: ROBOT.into(), robot: setup.robot.clone(), drive, ..Twin::default() }
}

/// What is kept of a run.
pub fn settled(run: &Run) -> Recording {
    run.recording.between(Some(SETTLED_S), None)
}
