//! What a URDF holds is read back; nothing of a twin is lost without a word.

use std::collections::BTreeMap;

use super::*;
use crate::effects::{CATALOGUE, Motion, Scope};
use crate::robot::{inverse_dynamics_series, urdf as format};
use crate::series::JointSeries;

/// A UR5 with the typical values of `effects`.
fn twin(effects: &[&str]) -> Twin {
    let mut twin = Twin { effects: Vec::new(), values: BTreeMap::new(), ..Twin::default() };
    for name in effects {
        let about = crate::effects::find(name).unwrap().about();
        let count = if about.scope == Scope::Arm { 1 } else { 6 };
        twin.effects.push(about.name.into());
        for p in about.parameters.iter().filter(|p| !p.is_reference()) {
            twin.values.insert(p.name.into(), vec![p.typical; count]);
        }
    }
    twin
}

/// Alone at typical values, every effect of the catalogue is in the file or named as left out.
#[test]
fn every_effect_is_held_or_named() {
    for target in [Target::Mjcf, Target::Urdf] {
        let bare = export(&twin(&[]), target, "t.toml").text;
        for effect in CATALOGUE {
            let name = effect.about().name;
            let exported = export(&twin(&[name]), target, "t.toml");
            let named = exported.left.iter().any(|l| l.effect == name);
            let body = |text: &str| text.split_once("-->").unwrap().1.to_string();
            let held = body(&exported.text) != body(&bare);
            assert!(held || named, "{name} is lost in {target:?}");
            let partly = ["cable_spring", "coulomb"];
            assert!(!(held && named) || partly.contains(&name), "{name} is both in {target:?}");
            let left =
                exported.left.iter().all(|l| exported.text.contains(&in_comment(&l.to_string())));
            assert!(left, "{}", exported.text);
        }
    }
}

/// Links, payload and tilt come back from the URDF as inverse dynamics of the twin has them.
#[test]
fn a_urdf_holds_links_payload_and_tilt() {
    let twin = twin(&["link_inertia", "payload", "base_tilt", "coulomb", "viscous"]);
    let text = export(&twin, Target::Urdf, "t.toml").text;
    let back = format::read(&text, "t.urdf", &format::Chain::default()).unwrap().robot;
    assert!(text.contains("<dynamics damping=\"6\" friction=\"5\"/>"), "{text}");
    let wave = |s: f64| {
        let rows: Vec<Vec<f64>> =
            (0..6).map(|j| (0..40).map(|k| (s + (j * k) as f64).sin()).collect()).collect();
        JointSeries::from_joints(&rows)
    };
    let (q, qd, qdd) = (wave(0.0), wave(1.0), wave(2.0));
    let tilted = inverse_dynamics_series(&back, &q, &qd, &qdd);
    let expected = inverse_dynamics_series(&twin.laden(), &q, &qd, &qdd);
    for j in 0..6 {
        for (a, b) in tilted.joint(j).iter().zip(expected.joint(j)) {
            assert!((a - b).abs() < 1e-9, "joint {}: {a} {b}", j + 1);
        }
    }
}

#[test]
fn an_open_effect_is_named() {
    let exported = export(&Twin::default(), Target::Mjcf, "t.toml");
    let words: Vec<String> = exported.left.iter().map(ToString::to_string).collect();
    assert_eq!(words.len(), 2, "{words:?}");
    assert!(words[0].starts_with("coulomb: the twin has no values"), "{words:?}");
}

/// The motor's gain and offset turn recorded current into what the joint feels.
#[test]
fn the_gain_is_the_true_one() {
    let twin = twin(&["torque_constant", "current_offset"]);
    let plan = Plan::of(&twin);
    let one = |x: f64| JointSeries::from_joints(&vec![vec![x]; 6]);
    let (q, qd, qdd) = (one(0.4), one(0.2), one(1.0));
    let recorded = twin.torque(&Motion::new(&twin.robot, 0.01, &q, &qd, &qdd));
    let felt = inverse_dynamics_series(&twin.robot, &q, &qd, &qdd);
    for j in 0..6 {
        let current = twin.drive.current(j, recorded.joint(j)[0]);
        let torque = plan.joints[j].gain * current - plan.joints[j].offset;
        assert!((torque - felt.joint(j)[0]).abs() < 1e-9);
    }
}
