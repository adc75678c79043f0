//! `armtwin simulate`: what it writes, and what it says about bad scenarios.

use std::fs;
use std::path::{Path, PathBuf};

use armtwin::effects::{CATALOGUE, DriveKind};
use armtwin::simulation::{Scenario, Simulation};
use armtwin::twin::PerJoint;
use rayon::prelude::*;
use tempfile::TempDir;

use super::{Output, armtwin};

fn simulate(scenario: &Path, out: &Path, more: &[&str]) -> Output {
    let mut arguments =
        vec!["simulate", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()];
    arguments.extend(more);
    armtwin(&arguments)
}

fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name)
}

#[test]
fn every_scenario_of_the_repository_runs() {
    let folder = scenario("");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        let name = file.file_name().unwrap().to_str().unwrap();
        // The DC motor's scenarios are run by the tests of `motor`.
        if !name.ends_with(".toml") || name.starts_with("dc_motor") {
            continue;
        }
        let out = TempDir::new().unwrap();
        let run = simulate(&file, out.path(), &["--duration", "5"]);
        assert_eq!(run.code, 0, "{}: {}", file.display(), run.stderr);
        count += 1;
        let truth = fs::read_to_string(out.path().join("truth.json")).unwrap();
        let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
        assert_eq!(truth["schema"], "armtwin.truth/1");
        let effects = truth["effects"].as_array().unwrap();
        let coulomb = effects.iter().find(|e| e["effect"] == "coulomb").unwrap();
        assert!(coulomb["parameters"][0]["values"][5].as_f64().unwrap() > 0.0);
        let fit = fs::read_to_string(out.path().join("fit.csv")).unwrap();
        assert!(fit.starts_with("timestamp"), "{}", &fit[..80]);
        // Position servos log what they are told and where they are.
        let has_servos = fs::read_to_string(&file).unwrap().contains("\n[servo]");
        let columns: &[&str] = match has_servos {
            true => &["target_q_5", "actual_q_0"],
            false => &["target_qdd_5", "actual_q_0", "actual_qd_3", "actual_current_5"],
        };
        for column in columns {
            assert!(fit.lines().next().unwrap().contains(column), "no {column}");
        }
        assert!(out.path().join("check.csv").is_file());
    }
    assert!(count >= 3);
}

#[test]
fn every_effect_has_a_scenario_that_hides_it() {
    for name in CATALOGUE.iter().map(|e| e.about().name) {
        let file = scenario("effects").join(name).with_extension("toml");
        let text = fs::read_to_string(&file).expect(name);
        assert!(text.starts_with("# ") && text.contains(&format!("[effects.{name}]")), "{name}");
        let out = TempDir::new().unwrap();
        let run = simulate(&file, out.path(), &["--duration", "4"]);
        assert_eq!(run.code, 0, "{name}: {}", run.stderr);
        let truth = fs::read_to_string(out.path().join("truth.json")).unwrap();
        let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
        let hidden = truth["effects"].as_array().unwrap();
        assert!(hidden.iter().any(|e| e["effect"] == name), "{name}");
        assert!(out.path().join("check.csv").is_file());
    }
    let files = fs::read_dir(scenario("effects")).unwrap().count();
    assert_eq!(files, CATALOGUE.len(), "a scenario of an effect that is not in the catalogue");
}

/// The arm with every effect at once moves, and without any one of them otherwise.
#[test]
fn all_effects_act_together() {
    // Servos take the place of the controller that others are about.
    let of_currents = CATALOGUE.iter().filter(|e| e.of_drive() != DriveKind::Servo);
    let names: Vec<&str> = of_currents.map(|e| e.about().name).collect();
    let mut together = effect_scenario(names[0]);
    together.shorten(4.0);
    for name in &names {
        together.effects.extend(effect_scenario(name).effects);
    }
    // So that they act within the first seconds, in which the base stands.
    let mut sooner = |effect: &str, key: &str, value: f64| {
        together.effects.get_mut(effect).unwrap().insert(key.into(), PerJoint::Each(vec![value]));
    };
    sooner("external_contact", "contact_start", 1.0);
    sooner("torque_saturation", "joints", 3.0);
    sooner("torque_saturation", "torque_limit", 9.0);
    let recorded = |scenario: &Scenario| {
        let made = scenario.work_out("test").unwrap();
        let mut simulation = Simulation::new(&made.setup).unwrap();
        simulation.run(&made.fit, 1, 0, &mut |_| true).unwrap().recording.channels
    };
    let all = recorded(&together);
    assert!(all.iter().flat_map(|c| &c.values).all(|x| x.is_finite()));
    names.par_iter().for_each(|name| {
        let mut fewer = together.clone();
        fewer.effects.remove(*name).unwrap();
        assert!(recorded(&fewer) != all, "{name} does nothing beside the others");
    });
}

fn effect_scenario(name: &str) -> Scenario {
    Scenario::load(&scenario("effects").join(name).with_extension("toml")).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let make = |name: &str, seed: &str| {
        let out = folder.path().join(name);
        let run =
            simulate(&scenario("ur5_friction.toml"), &out, &["--duration", "4", "--seed", seed]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        ["fit.csv", "check.csv", "truth.json"].map(|file| fs::read(out.join(file)).unwrap())
    };
    let (first, again, other) = (make("a", "5"), make("b", "5"), make("c", "6"));
    assert!(first == again, "the same seed gave different files");
    assert!(first[0] != other[0], "another seed gave the same noise");
}

#[test]
fn bad_scenarios_are_refused_by_key_and_leave_nothing() {
    let cases = [
        ("rat_hz = 125", "rat_hz"),
        ("[motion]\nduration_s = -3", "motion.duration_s = -3"),
        ("[motion]\nkind = \"zigzag\"", "zigzag"),
        ("[check]\nduraton_s = 9", "duraton_s"),
        ("robot = \"ur7\"", "ur7"),
        ("rate_hz = 130", "rate_hz = 130"),
        ("step_s = 0", "step_s = 0"),
        ("seed = \"one\"", "seed"),
        ("[drive]\ngear_ratio = [101, 101]", "gear_ratio has 2 values"),
        ("[drive]\nrotor_inertia = -1", "rotor_inertia of joint 1 is -1"),
        ("[controller]\nbandwidth_rad_s = -1", "controller.bandwidth_rad_s = -1"),
        ("[noise]\nsnr_db = nan", "noise.snr_db"),
        ("[quantisation]\ncurrent_a = -1", "quantisation.current_a = -1"),
        ("[effects.columb]\ncoulomb = 5", "choose from coulomb"),
        ("[effects.coulomb]\nfc = 5", "coulomb has coulomb"),
        ("[effects.stribeck]\nstribeck_excess = 1", "lacks stribeck_velocity"),
        ("[effects.coulomb]\ncoulomb = [5, 6]", "has 2 values for 6"),
        ("[effects.coulomb]\ncoulomb = -5", "effects.coulomb.coulomb = -5 N.m at joint 1"),
        ("[effects.coulomb]\ncoulomb = 5\njoints = [7]", "7 is not a joint"),
        ("[effects.coulomb]\ncoulomb = \"a lot\"", "a number"),
        ("beyond_range = [\"stribeck\"]", "no table [effects.stribeck]"),
        ("[motion", "not a valid scenario"),
    ];
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("bad.toml");
    let out = folder.path().join("out");
    for (text, message) in cases {
        fs::write(&file, text).unwrap();
        let run = simulate(&file, &out, &[]);
        assert_eq!(run.code, 1, "{text}: {}", run.stderr);
        assert!(run.stderr.contains(message), "{text}: {}", run.stderr);
        assert!(run.stderr.contains("bad.toml"), "{text}: {}", run.stderr);
        assert!(!out.exists(), "{text} left {}", out.display());
    }
}

#[test]
fn missing_files_and_taken_names_are_refused() {
    let folder = TempDir::new().unwrap();
    let run = simulate(&folder.path().join("none.toml"), &folder.path().join("out"), &[]);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("none.toml: cannot read it"), "{}", run.stderr);
    let taken = folder.path().join("taken");
    fs::write(&taken, "mine").unwrap();
    let run = simulate(&scenario("ur5_clean.toml"), &taken, &[]);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("is a file"), "{}", run.stderr);
    assert_eq!(fs::read_to_string(&taken).unwrap(), "mine");
    assert_eq!(armtwin(&["simulate", "x.toml"]).code, 2);
}

/// Damping that drives instead of braking: told when and where, before anything is written.
#[test]
fn an_arm_that_runs_away_is_said_to() {
    let out = TempDir::new().unwrap();
    let file = out.path().join("driven.toml");
    let clean = fs::read_to_string(scenario("ur5_clean.toml")).unwrap();
    let driven =
        "[effects.viscous_quadratic]\nviscous_quadratic = [0.0, 0.0, 0.0, -18.0, 0.0, 0.0]\n";
    fs::write(&file, format!("{clean}\n{driven}")).unwrap();
    let folder = out.path().join("made");
    let run = simulate(&file, &folder, &[]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("joint 4 runs away"), "{}", run.stderr);
    assert!(!folder.join("fit.csv").exists());
}
