//! `armtwin contacts` on recordings of real arms. They are not part of the repository: without them
//! these tests say that they are skipped.

use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use crate::armtwin;

fn recordings(folder: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let root = std::env::var_os("ARMTWIN_SHARED").map_or_else(beside, PathBuf::from);
    let found = root.join("recordings").join(folder);
    if !found.is_dir() {
        eprintln!("skipped: {} is not here", found.display());
    }
    found.is_dir().then_some(found)
}

/// Contacts of a recording against a twin fitted on another.
fn contacts(recording: &Path, fit: &Path, more: &[&str]) -> Vec<Value> {
    let out = TempDir::new().unwrap();
    let json = out.path().join("contacts.json");
    let [recording, fit, json] = [recording, fit, &json].map(|p| p.to_str().unwrap().to_string());
    let arguments = ["contacts", &recording, "--fit", &fit, "--json", &json];
    let done = armtwin(&[&arguments, more].concat());
    assert_eq!(done.code, 0, "{}", done.stderr);
    let all: Value = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    all["contacts"].as_array().unwrap().clone()
}

fn number(contact: &Value, key: &str) -> f64 {
    contact[key].as_f64().unwrap()
}

fn at(found: &[Value], [start, end]: [f64; 2]) -> Option<&Value> {
    found.iter().find(|c| number(c, "start_s") <= end && number(c, "end_s") >= start)
}

/// Link 2 of a moving UR10e was touched; when is an estimate. The same path without a contact.
#[test]
fn a_moving_arm_says_when_its_second_link_was_touched() {
    let Some(folder) = recordings("shamilmamedov-dynamic_calibration/collision_detection_data")
    else {
        return;
    };
    let [free, touched] =
        ["free", "2link"].map(|name| folder.join(format!("collision_{name}.csv.gz")));
    let more = [
        "--columns",
        "scenarios/columns/ur10e_shamilmamedov_collision.toml",
        "--twin",
        "scenarios/twins/ur10e.toml",
        "--with",
        "load_friction,offset",
    ];
    assert!(contacts(&free, &free, &more).is_empty());
    let found = contacts(&touched, &free, &more);
    // The controller's clock at the first row, s.
    const START_S: f64 = 1827.608;
    let known = [[2.0, 2.3], [10.2, 10.5], [18.4, 19.0], [27.1, 27.5], [32.0, 32.5], [52.6, 53.1]];
    let hits: Vec<&Value> =
        known.iter().filter_map(|k| at(&found, k.map(|t| t + START_S))).collect();
    assert!(hits.len() >= 5, "{} of {}: {found:?}", hits.len(), known.len());
    let second = hits.iter().filter(|c| c["link"] == 2).count();
    assert!(second >= 4, "link 2 in {second} of {}", hits.len());
}

/// Pushes of more than 20 N at the flange of a standing UR5, as its force sensor has them: when, N.
const PUSHES: [(f64, f64); 6] =
    [(3.39, 36.3), (8.39, 37.1), (11.52, 25.4), (13.52, 31.3), (18.86, 35.4), (20.24, 22.6)];

#[test]
fn a_standing_arm_weighs_what_pushes_at_its_flange() {
    let Some(folder) = recordings("kkufieta-ur5_modeling_force_estimate") else { return };
    let pushed = folder.join("Movement_No10_Standstill_ForceSensor_All");
    let fit = folder.join("Movement_No6_Acc_slow_Verify_Model");
    let more = [
        "--twin",
        "scenarios/twins/ur5.toml",
        "--with",
        "rotor_inertia,load_friction,payload,offset",
        "--at-flange",
    ];
    let found = contacts(&pushed, &fit, &more);
    let mut near = 0;
    for (time, force) in PUSHES {
        let contact = at(&found, [time - 0.5, time]);
        let contact = contact.unwrap_or_else(|| panic!("nothing at {time} s: {found:?}"));
        assert!((number(contact, "peak_time_s") - time).abs() < 0.4, "{contact:?}");
        // The torque per ampere is 22 % off at joints 1 to 3.
        let size = number(contact, "peak_n") / force;
        near += usize::from((0.7..1.5).contains(&size));
    }
    assert!(near >= 5, "{near} of {} peaks: {found:?}", PUSHES.len());
}
