//! `--json FILE`: what a program reads of the commands whose results are other files.

use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use super::{armtwin, study};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Runs a command with `--json` and takes what it wrote, which must be of `schema`.
#[track_caller]
fn json(folder: &Path, schema: &str, arguments: &[&str]) -> Value {
    let file = folder.join("out.json");
    let run = armtwin(&[arguments, &["--json", file.to_str().unwrap()]].concat());
    assert_eq!(run.code, 0, "{arguments:?}: {}", run.stderr);
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::remove_file(&file).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["schema"], schema);
    assert_eq!(value["version"], env!("CARGO_PKG_VERSION"));
    value
}

#[test]
fn of_files_that_are_written() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let bag = format!("{ROOT}/tests/bags/shuffled.mcap");
    let made = json(
        folder.path(),
        "armtwin.conversion/1",
        &["convert", &bag, "-o", &at("a.parquet"), "--columns", &columns(folder.path())],
    );
    assert_eq!((&made["samples"], &made["out"]), (&24.into(), &at("a.parquet").into()));
    assert_eq!(made["columns"].as_array().unwrap().len(), 18);
    assert!(made["notes"].to_string().contains("effort taken as torque, N.m, as the column map"));
    assert!(made["format"].as_str().unwrap().starts_with("ROS 2 bag (MCAP)"));

    let arm =
        json(folder.path(), "armtwin.arm/1", &["urdf", "--robot", "ur5", "-o", &at("a.urdf")]);
    let joints = arm["joints"].as_array().unwrap();
    assert_eq!((joints.len(), &joints[2]["name"]), (6, &"elbow_joint".into()));
    let masses: f64 = joints.iter().map(|j| j["mass_kg"].as_f64().unwrap()).sum();
    assert!((masses - arm["mass_kg"].as_f64().unwrap()).abs() < 1e-9 && masses > 15.0);

    let twin = at("twin.toml");
    let text = "robot = \"ur5\"\n[twin]\neffects = [\"viscous\", \"current_offset\"]\n\
                [twin.values]\nviscous = 1\ncurrent_offset = [0, 0, 2, 0, 0, 0]\n";
    std::fs::write(&twin, text).unwrap();
    let export = ["export", "--twin", &twin, "--format", "urdf", "-o", &at("b.urdf")];
    let left = json(folder.path(), "armtwin.export/1", &export);
    assert_eq!(left["format"], "urdf");
    let all = left["left"].as_array().unwrap();
    let offset = all.iter().find(|l| l["effect"] == "current_offset").unwrap();
    assert_eq!(offset["joints"], serde_json::json!([3]), "counted from 1: {offset}");
}

fn columns(folder: &Path) -> String {
    let map = folder.join("map.toml");
    std::fs::write(&map, "[bag]\neffort = 'torque'\n").unwrap();
    map.to_str().unwrap().to_string()
}

#[test]
fn of_trials_and_studies() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let cases = at("cases");
    let few = ["--cases", "2", "--only", "clean", "--duration", "12"];
    let draw = [&["trial", "draw", "--out", &cases], &few[..]].concat();
    let drawn = json(folder.path(), "armtwin.draw/1", &draw);
    assert_eq!(drawn["cases"], 2);
    assert!(!drawn.to_string().contains("effect"), "no labels: {drawn}");
    let answer = ["trial", "answer", &cases, "--out", &at("answers")];
    let first = json(folder.path(), "armtwin.answers/1", &answer);
    assert_eq!(first["answers"][1]["case"], "case-0001");
    assert_eq!(first["answers"][1]["kept"], false);
    assert_eq!(json(folder.path(), "armtwin.answers/1", &answer)["answers"][1]["kept"], true);

    let file = study::quick(folder.path());
    let cells = ["study", file.to_str().unwrap(), "--out", &at("study")];
    let ran = json(folder.path(), "armtwin.study/1", &cells);
    assert_eq!((&ran["complete"], &ran["kept"]), (&true.into(), &0.into()));
    assert_eq!(ran["ran"]["cells"], ran["cells"]);
    let again = json(folder.path(), "armtwin.study/1", &cells);
    assert_eq!((&again["kept"], &again["ran"]["cells"]), (&ran["cells"], &0.into()));
    let page = json(folder.path(), "armtwin.study_report/1", &["study", "report", &at("study")]);
    let merge = ["study", "merge", &at("study"), "--out", &at("merged")];
    let merged = json(folder.path(), "armtwin.study_report/1", &merge);
    assert_eq!((&page["files"], &page["cells"]), (&merged["files"], &ran["cells"]));
    for file in merged["files"].as_array().unwrap() {
        assert!(Path::new(&at("merged")).join(file.as_str().unwrap()).is_file(), "{file}");
    }
}

/// Of every command that finds or makes something; `help` knows them all.
#[test]
fn every_command_has_it() {
    let words = |arguments: &[&str]| -> Vec<String> {
        let help = armtwin(&[arguments, &["--help"]].concat()).stdout;
        let listed = help.split("Commands:").nth(1).unwrap_or_default();
        let listed = listed.lines().skip(1).take_while(|l| !l.is_empty());
        let names = listed.filter(|l| l.starts_with("  ") && !l.starts_with("   "));
        names.map(|l| l.split_whitespace().next().unwrap().to_string()).collect()
    };
    // An arm that is served ends when it is told to and finds nothing.
    let plain = ["help", "completions", "man", "serve"];
    let commands: Vec<String> = words(&[]).into_iter().filter(|c| !plain.contains(&&**c)).collect();
    assert!(commands.len() >= 17, "{commands:?}");
    for command in &commands {
        let below = words(&[command]);
        let below = below.iter().filter(|b| *b != "help").map(|b| vec![command.as_str(), b]);
        // A trial is nothing by itself.
        let alone = (command != "trial").then(|| vec![command.as_str()]);
        for arguments in below.chain(alone) {
            let help = armtwin(&[&arguments[..], &["--help"]].concat()).stdout;
            assert!(help.contains("--json [<FILE>]"), "{arguments:?} has no --json");
        }
    }
}

/// Without a file it is all that standard output has, and the same as in a file.
#[test]
fn without_a_file_it_goes_to_standard_output() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let bag = format!("{ROOT}/tests/bags/shuffled.mcap");
    for arguments in [
        &["inspect", &bag][..],
        &["convert", &bag, "-o", &at("a.csv")],
        &["urdf", "--robot", "ur5e"],
        &["robots"],
        &["effects"],
        &["effects", "stribeck"],
    ] {
        let run = |more: &[&str]| {
            let run = armtwin(&[arguments, more].concat());
            assert_eq!(run.code, 0, "{arguments:?}: {}", run.stderr);
            run.stdout
        };
        let (bare, dash) = (run(&["--json"]), run(&["--json", "-"]));
        let text = run(&["--json", &at("out.json")]);
        let file = std::fs::read_to_string(at("out.json")).unwrap();
        assert!(bare == file && dash == file, "{arguments:?}: {bare}");
        assert!(serde_json::from_str::<Value>(&file).is_ok(), "{arguments:?}: {file}");
        assert_eq!(text, run(&[]), "{arguments:?}");
    }
    let named = armtwin(&["effects", "--json", "stribeck"]).stdout;
    assert_eq!(named, armtwin(&["effects", "stribeck", "--json"]).stdout);
    assert_eq!(armtwin(&["inspect", "--json", &bag]).code, 2, "the bag is no place to write to");
}

#[test]
fn of_a_simulation_and_the_demo() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let scenario = format!("{ROOT}/scenarios/ur5_friction.toml");
    let short = ["--out", &at("s"), "--duration", "8", "--format", "parquet"];
    let made = [&["simulate", &scenario], &short[..]].concat();
    let made = json(folder.path(), "armtwin.simulation/1", &made);
    assert_eq!(made["fit"], serde_json::json!({"file": at("s/fit.parquet"), "samples": 1001}));
    assert!(Path::new(made["truth"].as_str().unwrap()).is_file());

    let demo = ["demo", "--out", &at("d"), "--duration", "20"];
    let demo = json(folder.path(), "armtwin.demo/1", &demo);
    let methods = demo["identified"].as_array().unwrap();
    assert_eq!((&methods[0]["method"], &methods[1]["method"]), (&"pso".into(), &"nlse".into()));
    assert_eq!(methods[1]["joints"].as_array().unwrap().len(), 6);
    assert!(Path::new(demo["diagnosis"].as_str().unwrap()).is_file());
}

/// One seed of the searches, and nothing of the motor.
#[test]
fn of_the_case_studies() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let quick = ["case-studies", "--seeds", "1", "--no-motor", "--out", &at("docs")];
    let studies = json(folder.path(), "armtwin.case_studies/1", &quick);
    let synthetic = &studies["studies"][0];
    assert_eq!(synthetic["name"], "synthetic");
    let methods = synthetic["methods"].as_array().unwrap();
    let nlse = methods.iter().find(|m| m["method"] == "nlse").unwrap();
    assert_eq!(nlse["joints"].as_array().unwrap().len(), 6);
    assert!(nlse["joints"][0]["check"]["r2"].as_f64().unwrap() > 0.9, "{}", nlse["joints"][0]);
    let duel = &studies["duels"][0]["joints"][0];
    assert_eq!(duel["swarm"]["runs"], 1);
    let boxes = studies["boxes"][0]["widths"].as_array().unwrap();
    assert_eq!((boxes.len(), &boxes[0]["width"]), (3, &1.05.into()));
    assert_eq!(boxes[0]["duels"][0]["separable"]["runs"], 1);
    assert_eq!(studies["motor"], Value::Null);
    let page = std::fs::read_to_string(at("docs/case-studies.md")).unwrap();
    assert!(page.contains("Table V") && page.contains("Left out (--no-motor)"));
    for figure in studies["figures"].as_array().unwrap() {
        let file = format!("docs/{}", figure.as_str().unwrap());
        assert!(Path::new(&at(&file)).is_file(), "{file}");
    }
}
