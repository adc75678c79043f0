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

/// Time constants of stiff servos are 12 ms, those of slow ones 63 ms and more: twenty steps of each, or steps of 2 ms.
#[test]
fn steps_are_a_twentieth_of_what_the_stiffest_servo_takes() {
    let (_, stiff) = by_rapier(SERVOS);
    assert_eq!((stiff.dt, stiff.steps), (0.004, 2));
    let (_, slow) = by_rapier(&slow());
    assert_eq!((slow.dt, slow.steps), (0.02, 7));
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
