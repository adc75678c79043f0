//! The jobs as a library user calls them.

use super::*;
use crate::follow::Token;
use crate::identification::Method;
use crate::motion::{Kind, Settings};

/// A UR5 with friction, moved for a few seconds.
fn moved() -> (Twin, Simulated) {
    let motion = Settings { kind: Kind::RandomFrequency, duration_s: 8.0, ..Settings::default() };
    let mut twin = Twin::default();
    twin.drive.rotor_inertia = vec![1.1, 1.1, 1.1, 0.14, 0.14, 0.14];
    let hidden: [(&str, &[(&str, f64)]); 3] = [
        ("coulomb", &[("coulomb", 5.0)]),
        ("viscous", &[("viscous", 8.0)]),
        ("payload", &[("mass", 2.0)]),
    ];
    let simulated = simulate(&twin, &motion, &hidden).unwrap();
    (twin, simulated)
}

#[test]
fn the_jobs_work_on_each_other_and_end_when_told() {
    let (twin, made) = moved();
    let [fit, check] = [&made.fit.recording, &made.check.recording];
    let truth = serde_json::to_value(made.truth()).unwrap();
    let effects = truth["effects"].as_array().unwrap();
    assert!(effects.iter().any(|e| e["effect"] == "payload"), "{truth}");

    let how = Identify::default().methods([Method::Nlse]).with(["payload"]);
    let found = how.run(&twin, fit, check, &()).unwrap();
    let mass = found.preferred().unwrap().arm.iter().find(|p| p.name == "payload_mass").unwrap();
    assert!((mass.value - 2.0).abs() < 0.2, "{}", mass.value);
    let (fitted, _) = found.fitted().unwrap().unwrap();
    let predicted = predict(&fitted, check, &SignalOptions::default()).unwrap();
    assert_eq!(predicted.torque.samples(), predicted.time.len());

    let same = identify(&twin, fit, fit).err().unwrap().to_string();
    assert!(same.contains("same samples"), "{same}");
    let token = Token::default();
    token.stop();
    let ends = [
        how.run(&twin, fit, None, &token).err().unwrap(),
        Diagnose::default().run(&twin, fit, check, &token).err().unwrap(),
        Simulate::default().run(&twin, &token).err().unwrap(),
    ];
    assert!(ends.iter().all(WorkflowError::is_interruption), "{ends:?}");
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    let (twin, made) = moved();
    let fit = &made.fit.recording;
    let said = |how: Diagnose| how.run(&twin, fit, None, &()).err().unwrap().to_string();
    assert!(said(Diagnose::default().without(["payloat"])).contains("no such effect"));
    assert!(said(Diagnose::default().mass_error(7.0)).contains("mass_error 7"));
    let mut milli = fit.clone();
    for c in milli.channels.iter_mut().filter(|c| c.name.starts_with("actual_current")) {
        c.values.iter_mut().for_each(|v| *v *= 1000.0);
    }
    let doubted = identify(&twin, &milli, None).err().unwrap();
    assert!(matches!(doubted, WorkflowError::Doubted { .. }), "{doubted}");
    let nothing = Simulate::default().hide("payload", [("moment_x", 0.0)]);
    assert!(nothing.is_ok());
    let unknown = Simulate::default().hide("payload", [("weight", 2.0)]).err().unwrap().to_string();
    assert!(unknown.contains("payload_mass"), "{unknown}");
}
