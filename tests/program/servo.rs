//! Arms of position servos: command and position, no torque.

use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use super::armtwin;
use super::guide::{OF_SERVOS, all_typed};
use super::real::recordings;

const TWIN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/twins/desk_arm.toml");

fn json(file: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

/// The guide's chapter on arms without torque, as it stands: half the gain and a tool of 80 g that the twin knows nothing of, from
/// command and position alone, are found and nothing else; with them the twin follows to within a few steps of the encoder, and
/// they go into a MuJoCo model.
#[test]
fn an_arm_without_torque_is_diagnosed_by_simulation() {
    let (folder, printed) = all_typed(&[OF_SERVOS]);
    let at = |name: &str| folder.path().join(name).display().to_string();
    let (fit, check) = (at("desk/fit.csv"), at("desk/check.csv"));
    let head = std::fs::read_to_string(&fit).unwrap();
    let head = head.lines().next().unwrap();
    assert!(head.contains("target_q_5") && !head.contains("current"), "{head}");
    assert!(printed[2].contains("method: by simulation"), "{}", printed[2]);
    let found = json(&folder.path().join("desk_diagnosis/diagnosis.json"));
    assert_eq!(found["by"], "simulation");
    let causes = found["causes"].as_array().unwrap();
    let names: Vec<&str> = causes.iter().map(|c| c["effect"].as_str().unwrap()).collect();
    assert!(names.len() == 2, "{names:?}");
    for (effect, parameter, truth, near) in
        [("servo_gain", "servo_gain_error", -0.5, 0.03), ("payload", "payload_mass", 0.08, 0.01)]
    {
        let cause = causes.iter().find(|c| c["effect"] == effect).unwrap();
        let values = cause["parameters"].as_array().unwrap();
        let value = values.iter().find(|v| v["name"] == parameter).unwrap();
        let value = value["value"].as_f64().unwrap();
        assert!((value - truth).abs() < near, "{parameter}: {value}");
    }
    let [before, after] =
        ["before_rad", "after_rad"].map(|k| found["position"][k].as_f64().unwrap());
    assert!(after < 0.05 * before, "{before} -> {after}");
    assert!(found["gap"]["joints"][1]["rms_rad"].as_f64().unwrap() > 0.0);
    let mjcf = std::fs::read_to_string(at("desk_arm.xml")).unwrap();
    // One with an offset is a `general` actuator, for `position` has none.
    let actuators = mjcf.matches("<position ").count() + mjcf.matches("<general ").count();
    assert_eq!((actuators, mjcf.matches(" kv=").count() > 0), (6, true), "{mjcf}");
    // Torque was asked for where none is.
    let torque =
        armtwin(&["diagnose", "--fit", &fit, "--check", &check, "--twin", TWIN, "--by", "torque"]);
    assert_eq!(torque.code, 1);
    assert!(torque.stderr.contains("actual_current_0"), "{}", torque.stderr);
    // And simulation of servos that nobody described.
    let unknown = armtwin(&["identify", &fit, "--robot", "ur5", "--by", "simulation", "--force"]);
    assert_eq!(unknown.code, 1);
    assert!(unknown.stderr.contains("[servo]"), "{}", unknown.stderr);
}

/// Six servos of an SO-101: what one motion tells predicts another one twice as well, and a load is named. `docs/so101.md` has
/// all pairs.
#[test]
fn a_real_arm_without_torque_is_mended() {
    mended_by("step_response", "chirp_sweep");
}

#[test]
#[ignore = "takes minutes"]
fn a_real_arm_without_torque_is_mended_by_motions_that_tell_more() {
    mended_by("chirp_sweep", "multisine");
    mended_by("multisine", "chirp_sweep");
}

fn mended_by(fit: &str, check: &str) {
    let Some(folder) = recordings("sage-so101") else { return };
    let out = TempDir::new().unwrap();
    let at = |name: &str| out.path().join(name).display().to_string();
    let urdf = folder.join("so101_new_calib.urdf");
    let twin = format!(
        "robot = {urdf:?}\ntip = \"moving_jaw_so101_v1_link\"\nflange = \"gripper_frame_link\"\n[drive]\nrotor_inertia = 0.028\n[servo]\n\
         gain = 17.8\ndamping = 0.55\nmax_torque = 3.35\n[twin]\neffects = [\"coulomb\", \"viscous\"]\n"
    );
    std::fs::write(out.path().join("so101.toml"), twin).unwrap();
    let [fit, check] = [fit, check].map(|name| folder.join(name).display().to_string());
    let (twin, json_file) = (at("so101.toml"), at("found.json"));
    let pair = ["diagnose", "--fit", &fit, "--check", &check, "--from", "5", "--to", "35"];
    let ran = armtwin(&[&pair[..], &["--twin", &twin, "--json", &json_file]].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let found = json(&out.path().join("found.json"));
    let [before, after] =
        ["before_rad", "after_rad"].map(|k| found["position"][k].as_f64().unwrap());
    assert!(after < 0.5 * before, "{fit}: {before} -> {after}");
    let first = &found["causes"][0];
    let equals = first["equivalent"].as_array().unwrap().iter();
    let mut names = equals.chain([first]).map(|cause| &cause["effect"]);
    assert!(names.any(|name| name == "payload"), "{fit}: {first}");
}

/// One servo of hobby size, of Rhoban/bam: what two logs tell predicts a third with another gain register better.
#[test]
fn a_real_servo_is_identified_by_simulation() {
    let Some(folder) = recordings("rhoban-bam_xl330") else { return };
    let log = |name: &str| folder.join(name).display().to_string();
    let out = TempDir::new().unwrap();
    let file = out.path().join("out.json");
    let twin = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/twins/xl330_pendulum.toml");
    let ran = armtwin(&[
        "identify",
        &log("2026-01-15_10h28m10.json.gz"),
        &log("2026-01-15_10h29m14.json.gz"),
        "--check",
        &log("2026-01-15_10h28m42.json.gz"),
        "--twin",
        twin,
        "--terms",
        "servo_gain,encoder_offset,coulomb,viscous,load_friction",
        "--json",
        file.to_str().unwrap(),
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stdout.contains("method: by simulation"), "{}", ran.stdout);
    let found = json(&file);
    let method = &found["methods"][0];
    assert_eq!(method["method"], "simulation");
    let [before, after] = ["before", "after"]
        .map(|k| method["check"][k][0]["joints"][0]["mean_abs_rad"].as_f64().unwrap());
    assert!(after < 0.05 && after < 0.7 * before, "{before} -> {after}");
}

/// Logs of one servo, what each says.
fn servo_logs(folder: &Path) -> Vec<(PathBuf, Value)> {
    let file = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().path();
    let log = |path: PathBuf| {
        let text = flate2::read::GzDecoder::new(std::fs::File::open(&path).unwrap());
        (path, serde_json::from_reader(text).unwrap())
    };
    let all = std::fs::read_dir(folder).unwrap().map(file);
    let mut all: Vec<PathBuf> = all.filter(|f| f.extension().is_some_and(|e| e == "gz")).collect();
    all.sort();
    all.into_iter().map(log).collect()
}

/// Logs that say another gain register than the servo had: that is told, and is no friction.
#[test]
fn another_gain_register_is_no_friction() {
    let Some(folder) = recordings("rhoban-bam_xl330") else { return };
    let out = TempDir::new().unwrap();
    let at = |name: &str| out.path().join(name).display().to_string();
    let logs = servo_logs(&folder);
    let fitted = logs.iter().filter(|(_, log)| {
        let known = ["sin_sin", "lift_and_drop", "sin_time_square"];
        [100, 400].contains(&log["kp"].as_i64().unwrap())
            && known.contains(&log["trajectory"].as_str().unwrap())
    });
    let files: Vec<&str> = fitted.map(|(path, _)| path.to_str().unwrap()).collect();
    let twin = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/twins/xl330_pendulum.toml");
    let terms = "servo_gain,servo_damping,servo_delay,encoder_offset,rotor_inertia,coulomb,viscous,load_friction,\
                 servo_friction";
    let save = at("fitted.toml");
    let how = ["--twin", twin, "--every-row", "--terms", terms, "--save-twin", &save];
    let ran = armtwin(&[&["identify"], &files[..], &how].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for (register, said) in [(200, 400), (800, 400), (200, 100)] {
        let told = |motion: &str| {
            let (_, log) = logs
                .iter()
                .find(|(_, log)| log["kp"] == register && log["trajectory"] == motion)
                .unwrap();
            let mut log = log.clone();
            log["kp"] = said.into();
            let file = at(&format!("{motion}.json"));
            std::fs::write(&file, log.to_string()).unwrap();
            file
        };
        let [fit, check] = ["sin_sin", "sin_time_square"].map(told);
        let file = at("found.json");
        let pair = ["diagnose", "--fit", &fit, "--check", &check, "--twin", &save, "--every-row"];
        let ran = armtwin(&[&pair[..], &["--json", &file]].concat());
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let found = json(Path::new(&file));
        let causes = found["causes"].as_array().unwrap();
        let names: Vec<&str> = causes.iter().map(|c| c["effect"].as_str().unwrap()).collect();
        assert_eq!(names.first(), Some(&"servo_gain"), "{register} for {said}: {names:?}");
        let friction =
            ["friction", "coulomb", "viscous", "stribeck", "lugre", "maxwell", "presliding"];
        let is_friction = |name: &&str| friction.iter().any(|part| name.contains(part));
        assert!(!names.iter().any(is_friction), "{register} for {said}: {names:?}");
    }
}
