//! `armtwin identify`.

use std::path::PathBuf;

use serde_json::Value;

use crate::armtwin;
use crate::browser::assert_sound;

const FOLDER: &str = "recordings/kkufieta-ur5_modeling_force_estimate";

/// The UR5 recordings, where they are; they are not part of the repository.
fn recordings() -> Option<[String; 2]> {
    let shared = std::env::var_os("ARMTWIN_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let folder = shared.join(FOLDER);
    let both = ["Movement_No6_Acc_slow_Verify_Model", "Movement_No7_Acc_slow_Verify_Model_short"]
        .map(|name| folder.join(name));
    if !both.iter().all(|p| p.is_dir()) {
        eprintln!("skipped: no recordings under {}", folder.display());
        return None;
    }
    Some(both.map(|p| p.display().to_string()))
}

fn identify(more: &[&str]) -> Option<Value> {
    let [fit, check] = recordings()?;
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("out.json");
    let mut arguments = vec!["identify", &fit, "--check", &check, "--json", json.to_str().unwrap()];
    arguments.extend(more);
    let out = armtwin(&arguments);
    assert_eq!(out.code, 0, "{}", out.stderr);
    Some(serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap())
}

fn check_r2(document: &Value, method: usize) -> Vec<f64> {
    let joints = document["methods"][method]["joints"].as_array().unwrap();
    joints.iter().map(|j| j["check"]["r2"].as_f64().unwrap()).collect()
}

#[test]
fn a_real_ur5_is_explained_on_a_recording_that_was_not_fitted() {
    let Some(document) = identify(&[]) else { return };
    assert_eq!(document["schema"], "armtwin.identification/1");
    let r2 = check_r2(&document, 1);
    for (joint, (r2, least)) in r2.iter().zip([0.99, 0.99, 0.99, 0.94, 0.96, 0.93]).enumerate() {
        assert!(*r2 >= least, "joint {}: {r2} is below {least}", joint + 1);
    }
    for joint in 0..6 {
        let cost = |m: usize| document["methods"][m]["joints"][joint]["cost"].as_f64().unwrap();
        assert!(cost(1) <= cost(0) * 1.0001, "joint {}: NLSE above PSO", joint + 1);
    }
}

#[test]
fn without_rotor_inertia_the_big_joints_are_explained_worse() {
    // Every sliding sample, as where .93 .95 .93 was measured: a guard around standstill leaves out
    // reversals, where the arm accelerates most.
    let more = ["--method", "nlse", "--terms", "paper,offset", "--guard", "0"];
    let Some(document) = identify(&more) else { return };
    for (r2, expected) in check_r2(&document, 0).iter().zip([0.93, 0.95, 0.93]) {
        assert!((r2 - expected).abs() < 0.02, "{r2} instead of about {expected}");
    }
}

/// Ten seconds of six joints swinging, with Coulomb and viscous friction and nothing else.
fn swinging(phase: f64) -> String {
    let stems = ["actual_q", "actual_qd", "joint_torque"];
    let names = stems.iter().flat_map(|s| (0..6).map(move |j| format!(",{s}_{j}")));
    let mut text = "timestamp".to_string() + &names.collect::<String>() + "\n";
    for k in 0..1250 {
        let t = f64::from(k) * 0.008;
        let w = |j: i32| 1.0 + 0.2 * f64::from(j);
        let q = (0..6).map(|j| 0.5 * (w(j) * t + phase).sin());
        let qd: Vec<f64> = (0..6).map(|j| 0.5 * w(j) * (w(j) * t + phase).cos()).collect();
        let torque = qd.iter().map(|v| 5.0 * v.signum() + 8.0 * v);
        let row: String =
            q.chain(qd.iter().copied()).chain(torque).map(|v| format!(",{v:.9}")).collect();
        text += &format!("{t:.3}{row}\n");
    }
    text
}

#[test]
fn bad_usage_gets_one_message_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (fit, same, json) = (path("fit.csv"), path("same.csv"), path("out.json"));
    std::fs::write(&fit, swinging(0.0)).unwrap();
    std::fs::write(&same, swinging(0.0)).unwrap();
    let cases: [(&[&str], i32, &str); 7] = [
        (&["identify", &fit, "--check", &fit, "--json", &json], 1, "another recording"),
        (&["identify", &fit, "--check", &same, "--json", &json], 1, "same samples"),
        (&["identify", &fit, "--bounds", "coulomb=5:1"], 2, "wrong way round"),
        (&["identify", &fit, "--bounds", "coulomb=5"], 2, "MIN:MAX"),
        (&["identify", &fit, "--bounds", "backlash=0:1"], 1, "no parameter `backlash`"),
        (&["identify", &fit, "--with", "nonsense"], 1, "no term `nonsense`"),
        (&["identify", &fit, "--standstill", "99"], 1, "no joint slides"),
    ];
    for (arguments, code, message) in cases {
        let out = armtwin(arguments);
        assert_eq!(out.code, code, "{arguments:?}: {}", out.stderr);
        assert!(out.stderr.contains(message), "{arguments:?}: {}", out.stderr);
    }
    assert!(!PathBuf::from(json).exists());
}

#[test]
fn a_saved_twin_holds_the_fitted_values_and_seeds_repeat() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (fit, twin) = (path("fit.csv"), path("twin.toml"));
    std::fs::write(&fit, swinging(0.3)).unwrap();
    let run = |json: &str| {
        let out = armtwin(&["identify", &fit, "--json", json, "--save-twin", &twin, "--seed", "7"]);
        assert_eq!(out.code, 0, "{}", out.stderr);
        let text = std::fs::read_to_string(json).unwrap();
        text.lines().filter(|l| !l.contains("\"seconds\"")).collect::<String>()
    };
    assert_eq!(run(&path("a.json")), run(&path("b.json")));
    let saved = armtwin::twin::Twin::load(twin.as_ref()).unwrap();
    for name in ["coulomb", "viscous", "current_offset", "stribeck_excess"] {
        assert_eq!(saved.values[name].len(), 6, "{name}");
    }
    let again = armtwin(&["identify", &fit, "--twin", &twin, "--terms", "viscous"]);
    assert_eq!(again.code, 0, "{}", again.stderr);
}

/// The folder that holds both may go anywhere.
#[test]
fn a_saved_twin_moves_with_its_urdf() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::create_dir_all(path("here/twins")).unwrap();
    assert_eq!(armtwin(&["urdf", "-o", &path("here/arm.urdf")]).code, 0);
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/ur5_friction.toml");
    let made = armtwin(&["simulate", scenario, "--out", &path("."), "--duration", "16"]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    let drive = "[drive]\ngear_ratio = 100\ntorque_constant = 0.1\n";
    std::fs::write(path("twin.toml"), format!("robot = \"here/arm.urdf\"\n{drive}")).unwrap();
    let (fit, twin) = (path("fit.csv"), path("twin.toml"));
    let save = ["--save-twin", &path("here/twins/fitted.toml")];
    let run =
        armtwin(&[&["identify", &fit, "--twin", &twin, "--method", "nlse"], &save[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let out = ["--twin", &twin, "--out", &path("here/diagnosis"), "--no-simulation"];
    let run = armtwin(&[&["diagnose", "--fit", &fit], &out[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    std::fs::rename(path("here"), path("there")).unwrap();
    for saved in ["there/twins/fitted.toml", "there/diagnosis/twin.toml"] {
        let text = std::fs::read_to_string(path(saved)).unwrap();
        assert!(text.contains("robot = \"../arm.urdf\""), "{text}");
        let run = armtwin(&["export", "--twin", &path(saved), "--format", "urdf"]);
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
}

#[test]
fn the_report_shows_torque_and_what_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/ur5_friction.toml");
    let made = armtwin(&["simulate", scenario, "--out", &at("."), "--duration", "20"]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    let files = [at("fit.csv"), at("check.csv"), at("report.html")];
    let run = armtwin(&["identify", &files[0], "--check", &files[1], "--report", &files[2]]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let sections = [
        "found",
        "torque",
        "friction",
        "residual",
        "parameters",
        "parameters-2",
        "fit",
        "untestable",
        "about",
    ];
    // Torque of six joints over time and over speed; of the joint that is open: over time, speed, angle.
    assert_sound(&folder.path().join("report.html"), &sections, 6 + 6 + 3);
}
