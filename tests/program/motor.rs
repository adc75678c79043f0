//! `armtwin motor` on a shortened scenario.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::{armtwin, browser};

/// A shipped scenario with a shorter recording and an easier search.
fn shortened(folder: &Path, number: usize) -> PathBuf {
    let shipped = format!("{}/scenarios/dc_motor_{number}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(shipped).unwrap();
    let text = text
        .replace("sample_time = 0.001", "sample_time = 0.01")
        .replace("starts = 6", "starts = 2")
        .replace("particles_per_parameter = 10", "particles_per_parameter = 2")
        .replace("iterations = 1000", "iterations = 20");
    let path = folder.join("short.toml");
    fs::write(&path, text).unwrap();
    path
}

fn json_of(arguments: &[&str]) -> (String, Value) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("motor.json");
    let ran = armtwin(&[arguments, &["--json", file.to_str().unwrap()]].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    (ran.stdout, serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap())
}

#[test]
fn the_speed_alone_is_told_apart_from_speed_and_current() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = shortened(folder.path(), 1);
    let scenario = scenario.to_str().unwrap();
    let (text, json) = json_of(&["motor", scenario]);
    assert_eq!(json["schema"], "armtwin.motor/1");
    let found = &json["scenarios"][0];
    assert_eq!((&found["scenario"], &found["measured"][0]), (&1.into(), &"omega".into()));
    let members = found["unidentifiable"][0].as_array().unwrap();
    let expected = ["J", "L", "R", "T_s", "T_c", "T_v1", "T_v2", "T_v3"];
    assert_eq!(members, &expected.map(Value::from).to_vec());
    assert_eq!(found["methods"].as_array().unwrap().len(), 2);
    let j = &found["methods"][1]["parameters"][0];
    assert_eq!(
        (&j["name"], &j["identifiable"], &j["low"]),
        (&"J".into(), &false.into(), &Value::Null)
    );
    assert!(text.contains("J * R") && text.contains("T_s = 0.1 < T_c = 0.2"), "{text}");

    let (_, json) =
        json_of(&["motor", scenario, "--measured", "omega,current", "--method", "nlse"]);
    let found = &json["scenarios"][0];
    assert!(found["unidentifiable"].as_array().unwrap().is_empty());
    for parameter in found["methods"][0]["parameters"].as_array().unwrap() {
        let [low, high] = ["low", "high"].map(|k| parameter[k].as_f64().unwrap());
        let (truth, half) = (parameter["truth"].as_f64().unwrap(), 0.5 * (high - low));
        assert!(low - half < truth && truth < high + half, "{parameter}");
    }
}

#[test]
fn the_study_counts_and_writes_markdown() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = shortened(folder.path(), 2);
    let markdown = folder.path().join("study.md");
    let ran = armtwin(&[
        "motor",
        scenario.to_str().unwrap(),
        "--study",
        "--seeds",
        "3",
        "--measured",
        "omega,current",
        "--markdown",
        markdown.to_str().unwrap(),
    ]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let text = fs::read_to_string(markdown).unwrap();
    assert!(text.contains("| T_v2 | no | - | - |") && text.contains("| J | yes |"), "{text}");
    assert!(text.contains("* robust: 24 of 24 true terms kept, "), "{text}");
    assert!(text.contains("* paper: ") && text.contains("of 6 absent ones ("), "{text}");
}

#[test]
fn a_study_takes_up_where_it_was_left() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = shortened(folder.path(), 2);
    let keep = folder.path().join("keep");
    let run = |method: &str, seeds: &str| {
        let more = ["--keep", keep.to_str().unwrap(), "--measured", "omega,current"];
        let seeds = match method {
            "pso" => ["--seeds", "0", "--pso-seeds", seeds],
            _ => ["--pso-seeds", "0", "--seeds", seeds],
        };
        let study = ["motor", scenario.to_str().unwrap(), "--study"];
        json_of(&[&study[..], &seeds, &more].concat()).1["studies"][0].clone()
    };
    for method in ["pso", "nlse"] {
        let before = files_in(&keep);
        run(method, "2");
        assert_eq!(files_in(&keep), before + 2);
        let all = run(method, "3");
        assert_eq!(files_in(&keep), before + 3);
        let again = run(method, "3");
        assert_eq!(again, all, "every search is taken from the folder, its seconds too");
    }
}

fn files_in(folder: &Path) -> usize {
    let names = fs::read_dir(folder).into_iter().flatten().map(|f| f.unwrap().file_name());
    names.filter(|name| name.to_string_lossy().ends_with(".toml")).count()
}

#[test]
fn wrong_usage_and_bad_scenarios_end_with_one_message() {
    for arguments in [
        &["motor", "--given", "Q=1"][..],
        &["motor", "--given", "R"],
        &["motor", "--measured", "speed"],
        &["motor", "--seeds", "3"],
    ] {
        let ran = armtwin(arguments);
        assert_eq!(ran.code, 2, "{arguments:?}: {}", ran.stderr);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.toml");
    fs::write(&path, "scenario = 1\ntitle = 3\n").unwrap();
    let json = folder.path().join("out.json");
    for (arguments, says) in [
        (vec!["motor", path.to_str().unwrap(), "--json", json.to_str().unwrap()], "title"),
        (vec!["motor", "no/such.toml"], "no/such.toml"),
        (vec!["motor", "--given", "R=-1"], "[given] R = -1: must be positive"),
        (vec!["motor", "--measured", "current"], "give omega"),
    ] {
        let ran = armtwin(&arguments);
        assert_eq!(ran.code, 1, "{arguments:?}");
        assert!(ran.stderr.contains(says) && ran.stdout.is_empty(), "{}", ran.stderr);
    }
    assert!(!json.exists());
}

/// Both scenarios' sections, friction and the recording for verification drawn; the other one is
/// there, closed.
#[test]
fn the_report_shows_what_was_measured_and_calculated_over_time() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = shortened(folder.path(), 2);
    let page = folder.path().join("report.html");
    let arguments = ["motor", scenario.to_str().unwrap(), "--report", page.to_str().unwrap()];
    let ran = armtwin(&arguments);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let text = fs::read_to_string(&page).unwrap();
    for recording in ["verification", "identification"] {
        assert!(text.contains(&format!("The recording for {recording}")));
    }
    // Voltage; speed, current and torque, each with its error.
    assert_eq!(text.matches("over time / s\"").count(), 2 * 7);
    assert!(text.contains("<p class=\"plotted\">Speed: error</p>"), "no errors of the speed");
    browser::assert_sound(&page, &["scenario-1", "about"], 1 + 7);
}
