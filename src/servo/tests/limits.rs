//! What does nothing until something comes near it.

use super::*;

/// A servo that gives a tenth of what is assumed, which the twin never asks for: found from where a search has it.
#[test]
fn a_limit_that_the_twin_never_comes_near_is_found() {
    let strong = SERVOS
        .replace("delay = 0.012", "delay = 0.012\nmax_torque = [4000, 4000, 500, 400, 400, 400]");
    let weak = "[effects.servo_max_torque]\nmax_torque_error = [0, 0, -0.9, 0, 0, 0]\n";
    let changes = [
        change("viscous_cubic", &[2], &[("viscous_cubic", 0.1)]),
        change("servo_max_torque", &[3], &[("max_torque_error", -0.93)]),
    ];
    let found = sifted(&format!("{strong}{weak}"), "servo_max_torque", &[], &changes);
    assert_eq!(found.stand, [Stands { index: 1, equals: vec![] }]);
    let error = found.mended[0].values["max_torque_error"][2];
    assert!((error + 0.9).abs() < 0.02, "{error}");
}
