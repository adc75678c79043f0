//! Commands that are noted otherwise in one recording than in another.

use super::super::time_offset::time_offset;
use super::*;
use crate::diagnosis::TimeOffset;

/// By how much commands of another motion are later than those of one, as a twin tells it that was given other friction.
fn told(noted_s: impl Fn(usize) -> f64) -> Option<TimeOffset> {
    let (truth, fit) = by_rapier(SERVOS);
    let (_, mut check) = by_rapier(&SERVOS.replace("duration_s = 6", "duration_s = 6\nseed = 7"));
    for j in 0..6 {
        let sent = check.told.command.joint(j).to_vec();
        let place = |k: usize| k as f64 + noted_s(j) / check.dt;
        let noted: Vec<f64> =
            (0..sent.len()).map(|k| crate::series::at_place(&sent, place(k))).collect();
        check.told.command.joint_mut(j).copy_from_slice(&noted);
    }
    let mut twin = truth;
    twin.values.get_mut("viscous").unwrap().iter_mut().for_each(|v| *v *= 1.5);
    let effects = ["servo_delay", "servo_gain", "coulomb", "viscous"].map(String::from);
    let free = free_parameters(&twin, &effects).unwrap();
    let free: Vec<Free> = free.into_iter().map(|f| f.near_start(&twin)).collect();
    time_offset(&twin, [&fit, &check], &free, &()).unwrap()
}

#[test]
fn commands_that_are_noted_early_are_found_late() {
    let found = told(|_| 3e-3).unwrap();
    assert!((found.late_s - 3e-3).abs() < 2e-4 && found.standard_error_s < 2e-4, "{found:?}");
    let none = told(|_| 0.0).unwrap();
    assert!(none.late_s.abs() < 1e-4, "{none:?}");
}

/// That is of the arm, or nobody knows: what they say scatters by 2 ms about none.
#[test]
fn joints_that_contradict_each_other_tell_little() {
    let found = told(|j| 3e-3 * (j as f64 - 2.5) / 2.5).unwrap();
    let error = found.standard_error_s;
    assert!(error > 5e-4 && found.late_s.abs() < 2.0 * error, "{found:?}");
}

/// A twin that cannot follow both recordings leaves what was told of them before.
#[test]
fn what_tells_nothing_leaves_what_was_told_before() {
    let (_, track) = by_rapier(SERVOS);
    let sent = |late_s: Option<f64>| {
        let time_offset = late_s.map(|late_s| TimeOffset { late_s, standard_error_s: 1e-3 });
        AsSent { track: track.later(late_s.unwrap_or(0.0)), time_offset }
    };
    let before = sent(Some(0.01));
    let late = |told: AsSent| (told.or(&before).track.told.late, before.track.told.late);
    assert_eq!(late(sent(None)), (0.01, 0.01));
    assert_eq!(late(sent(Some(0.02))), (0.02, 0.01));
}
