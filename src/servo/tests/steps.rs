//! How finely an arm is simulated.

use super::*;

/// Servos with heavy rotors, recorded 50 times a second.
fn slow() -> String {
    SERVOS
        .replace("rate_hz = 250", "rate_hz = 50")
        .replace("inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]", "inertia = 1.2")
        .replace("gain = [9000, 9000, 6000, 900, 900, 900]", "gain = 300")
        .replace("damping = [500, 500, 400, 40, 40, 40]", "damping = 20")
        .replace("coulomb = [9, 10, 8, 3, 2, 2]", "coulomb = 1")
}

/// Time constants of stiff servos are 12 ms, those of slow ones 63 ms and more: ten steps of each, or steps of 2 ms.
#[test]
fn steps_are_a_tenth_of_what_the_stiffest_servo_takes() {
    let (_, stiff) = by_rapier(SERVOS);
    assert_eq!((stiff.dt, stiff.steps), (0.004, 2));
    let (_, slow) = by_rapier(&slow());
    assert_eq!((slow.dt, slow.steps), (0.02, 4));
}

/// Finer steps hardly lead an arm elsewhere, beside how far it lags its command.
#[test]
fn finer_steps_lead_to_the_same_place() {
    let (twin, track) = by_rapier(&slow());
    let whole = track.stretches(f64::INFINITY);
    let fine = Track { steps: 10 * track.steps, ..track.clone() };
    let [usual, fine] = [&track, &fine].map(|track| replay(&twin, track, &whole).unwrap());
    let lags = PositionGap::new(&track, &track.told.command).rms_rad();
    let finely = Track { q: fine, ..track.clone() };
    let off = PositionGap::new(&finely, &usual).rms_rad();
    assert!(off < 2e-3 * lags, "{off} of {lags}");
}

/// The last joint alone, where nothing weighs or sticks: it swings as a spring of sqrt(K/I), from the state that is given, and steps
/// half as long lead a quarter as far off.
#[test]
fn a_joint_on_a_spring_swings_as_it_should() {
    let (mut twin, _) = by_rapier(&slow().replace("damping = 20", "damping = 0"));
    twin.robot.gravity.fill(0.0);
    twin.effects.clear();
    let swung = |steps: i32| {
        let (mut plant, v) = (Plant::new(&twin, 0.0).unwrap(), 0.5);
        let (gain, h) = (plant.servo().gain.clone(), 0.1 / f64::from(steps));
        plant.set_state(0.0, &[0.0; 6], &[0.0, 0.0, 0.0, 0.0, 0.0, v]);
        (0..steps).for_each(|_| plant.step(h, &[0.0; 6], &gain));
        let w = (gain[5] / plant.yields(5).inertia).sqrt();
        (plant.shown(5) - v / w * (w * 0.1).sin()).abs()
    };
    let [usual, half] = [10, 20].map(swung);
    assert!(usual < 1e-4 && (half / usual - 0.25).abs() < 0.01, "{usual} {half}");
}
