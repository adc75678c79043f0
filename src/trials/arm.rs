//! The arm of a case before anything is hidden in it: friction, controller, sensors, motions.

use std::collections::BTreeMap;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::motion::{Kind as Shape, Settings};
use crate::simulation::{ControllerSettings, Noise, Quantisation, Scenario, Thermal};
use crate::twin::{DriveTable, PerJoint};

/// Reflected rotor inertia of big joints and wrists, known to the twin, kg.m2.
const ROTOR_INERTIA: [f64; 6] = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14];

/// Step of the simulation, s: three steps per period of the controller. What a row of a recording is off its
/// law at this step is below 1 % of the noise (docs/accuracy.md).
const STEP_S: f64 = 1.0 / 1500.0;

/// Rest at the start, s.
pub const REST_S: f64 = 1.2;

/// A UR5 whose friction, noise and motions differ from case to case.
pub fn arm(duration_s: f64, rng: &mut ChaCha8Rng) -> Scenario {
    let mut each = |big: (f64, f64), wrist: (f64, f64)| {
        let of = |j: usize| if j < 3 { big } else { wrist };
        PerJoint::Each((0..6).map(|j| rng.random_range(of(j).0..of(j).1)).collect())
    };
    let friction =
        [("coulomb", each((3.0, 8.0), (0.7, 2.0))), ("viscous", each((4.0, 11.0), (0.6, 1.9)))];
    let table = |(name, value): (&str, PerJoint)| {
        (name.to_string(), BTreeMap::from([(name.to_string(), value)]))
    };
    let effects = friction.map(table).into();
    let motion = motion(duration_s, rng);
    let check = Settings { seed: motion.seed.wrapping_add(1), ..motion.clone() };
    Scenario {
        seed: rng.random_range(0..1 << 40),
        step_s: STEP_S,
        drive: DriveTable {
            rotor_inertia: Some(PerJoint::Each(ROTOR_INERTIA.into())),
            ..DriveTable::default()
        },
        check: toml::Table::try_from(&check).unwrap_or_default(),
        motion,
        controller: ControllerSettings {
            bandwidth_rad_s: rng.random_range(45.0..75.0),
            friction_feedforward: rng.random_range(0.8..1.2),
            ..ControllerSettings::default()
        },
        noise: Noise {
            snr_db: Some(rng.random_range(24.0..34.0)),
            position_rad: 2e-5,
            velocity_rad_s: 1.5e-3,
        },
        quantisation: Quantisation { position_rad: 1e-5, velocity_rad_s: 0.0, current_a: 0.002 },
        thermal: Thermal {
            ambient_c: 24.0,
            start_c: 24.0,
            rise_k_per_w: rng.random_range(4.0..8.0),
            time_constant_s: rng.random_range(30.0..80.0),
        },
        effects,
        ..Scenario::default()
    }
}

fn motion(duration_s: f64, rng: &mut ChaCha8Rng) -> Settings {
    Settings {
        kind: Shape::Mixed,
        seed: rng.random_range(0..1 << 40),
        duration_s,
        rest_s: REST_S,
        range_rad: rng.random_range(0.8..1.2),
        speed_rad_s: rng.random_range(1.2..1.8),
        acceleration_rad_s2: rng.random_range(4.0..6.0),
        home_rad: None,
        series: None,
    }
}
