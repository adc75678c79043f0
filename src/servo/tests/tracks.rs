//! Recordings as servos saw them.

use super::*;

#[test]
fn every_other_stretch_is_a_half() {
    let (_, track) = by_rapier(SERVOS);
    let halves = track.halves(5.0);
    let usable = |k: usize| halves.each_ref().map(|half| half.usable[k]);
    assert!((0..track.len()).all(|k| usable(k)[0] != usable(k)[1]));
    for half in &halves {
        assert!(half.stretches(f64::INFINITY).len() >= 2, "{:?}", half.stretches(f64::INFINITY));
    }
}

#[test]
fn a_joint_that_stands_has_the_encoder_of_the_other_recording() {
    let (_, mut moves) = by_rapier(SERVOS);
    let mut stands = moves.clone();
    (moves.resolution, stands.resolution) = (vec![1e-3; 6], vec![1e-3; 6]);
    (moves.resolution[4], stands.resolution[1]) = (0.0, 0.0);
    let both = Track::of_one_arm([stands, moves]).map(|track| track.resolution);
    assert_eq!(both, [vec![1e-3; 6], vec![1e-3; 6]]);
}
