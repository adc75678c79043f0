//! Drives whose constants are wrong by known factors.

use super::*;
use crate::signals::testing::{noisy, samples};

const LOAD: Load = Load { mass_kg: 3.0, centre_m: Some([0.0, 0.03, 0.06]) };
/// True torque over what the twin makes of the current.
const GAINS: [f64; 6] = [1.04, 0.93, 1.08, 0.95, 1.06, 1.03];

/// The arm's torque with and without the load, as a twin with wrong constants sees it.
fn runs(twin: &Twin) -> [Samples; 2] {
    [false, true].map(|loaded| {
        let mut arm = twin.clone();
        arm.values.insert("coulomb".into(), vec![5.0, 6.0, 4.0, 1.5, 1.2, 1.0]);
        arm.values.insert("viscous".into(), vec![9.0, 10.0, 7.0, 2.0, 1.5, 1.0]);
        if loaded {
            let [x, y, z] = LOAD.centre_m.unwrap();
            let values = [("mass", 1.0), ("moment_x", x), ("moment_y", y), ("moment_z", z)];
            for (name, value) in values {
                arm.values.insert(format!("payload_{name}"), vec![value * LOAD.mass_kg]);
            }
            arm.effects.push("payload".into());
        }
        let mut made = samples(6, 5000, |j, t| {
            let w = 1.1 + 0.33 * j as f64;
            0.9 * (w * t).sin() + 0.5 * (0.43 * w * t + j as f64).cos()
        });
        made.torque = arm.torque(&arm.motion(&made));
        noisy(&mut made, 0.1);
        made.torque = made.torque.map_joints(|j, x| x.iter().map(|t| t / GAINS[j]).collect());
        made
    })
}

fn found(load: Load) -> TorqueScale {
    let twin = Twin::default();
    let terms = Terms::named(["coulomb", "viscous", "rotor_inertia"]).unwrap();
    let [free, loaded] = runs(&twin);
    torque_scale(&twin, &terms, [&free, &loaded], load).unwrap()
}

#[test]
fn gains_come_back_inside_their_intervals() {
    for centre in [LOAD.centre_m, None] {
        let scale = found(Load { centre_m: centre, ..LOAD });
        assert!(scale.rounds < MOST_ROUNDS);
        let told: Vec<&Gain> = scale.joints.iter().filter(|g| g.identifiable).collect();
        assert!(told.len() >= 5, "{told:?}");
        for gain in told {
            let truth = GAINS[gain.joint - 1];
            assert!(gain.low <= truth && truth <= gain.high, "{gain:?}, {truth}");
        }
        for gain in &scale.joints[1..4] {
            let truth = GAINS[gain.joint - 1];
            assert!((gain.value / truth - 1.0).abs() < 0.02, "{gain:?}, {truth}");
        }
    }
}

/// The centre is found along where it is not given.
#[test]
fn the_loads_centre_is_found() {
    let found = found(Load { centre_m: None, ..LOAD }).centre_m;
    for (found, truth) in found.iter().zip(LOAD.centre_m.unwrap()) {
        assert!((found - truth).abs() < 0.01, "{found} m instead of {truth} m");
    }
}

/// A load twice as heavy as it is said to be makes every torque seem half as large.
#[test]
fn the_scale_is_the_loads() {
    let twice = found(Load { mass_kg: 2.0 * LOAD.mass_kg, centre_m: LOAD.centre_m });
    let shoulder = &twice.joints[1];
    assert!(shoulder.value > 1.3 * GAINS[1], "{shoulder:?}");
}
