//! `armtwin trial draw --on`: effects grafted onto recordings, from end to end.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use super::real::recordings;
use super::{Output, armtwin};

fn trial(arguments: &[&str]) -> Output {
    armtwin(&[&["trial"], arguments].concat())
}

fn text(path: &Path) -> String {
    path.to_str().unwrap().into()
}

fn truths(cases: &Path) -> Vec<Value> {
    let mut files: Vec<_> =
        fs::read_dir(cases.join("sealed")).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    files.iter().map(|f| serde_json::from_str(&fs::read_to_string(f).unwrap()).unwrap()).collect()
}

#[test]
fn a_graft_on_somebodys_recordings_is_found_and_scored() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| text(&folder.path().join(name));
    let few = ["draw", "--cases", "1", "--only", "clean", "--duration", "14", "--out", &at("arm")];
    assert_eq!(trial(&few).code, 0);
    let own = |file: &str| at(&format!("arm/case-0000/{file}"));
    let (fit, check, twin) = (own("fit.csv.gz"), own("check.csv.gz"), own("twin.toml"));
    let on = ["draw", "--on", &fit, &check, "--twin", &twin];
    let few = ["--cases", "1", "--only", "current_offset", "--strengths", "40"];
    let (cases, answers) = (at("cases"), at("answers"));
    let run = trial(&[&on[..], &few[..], &["--out", &cases]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let again = at("again");
    trial(&[&on[..], &few[..], &["--out", &again, "--jobs", "1"]].concat());
    let seals = |cases: &str| fs::read_to_string(Path::new(cases).join("seals.json")).unwrap();
    assert_eq!(seals(&cases), seals(&again));
    assert_eq!(truths(Path::new(&cases)).len(), 2);

    assert_eq!(trial(&["answer", &cases, "--out", &answers]).code, 0);
    let (page, json) = (at("page.md"), at("score.json"));
    let simulated = at("arm");
    let simulated_answers = at("arm_answers");
    assert_eq!(trial(&["answer", &simulated, "--out", &simulated_answers]).code, 0);
    let both = ["score", &cases, &answers, &simulated, &simulated_answers];
    let run = trial(&[&both[..], &["--out", &page, "--json", &json]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let written = fs::read_to_string(&page).unwrap();
    for word in
        ["| current_offset | 1 / 1 |", "Do the untouched pairs agree?", "Probability and frequency"]
    {
        assert!(written.contains(word), "no {word} in {written}");
    }
    let scores: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!(scores["trials"][0]["goals"][4]["figure"], "strays, grafts");
}

#[test]
fn bad_requests_leave_nothing_behind() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("cases");
    let log = folder.path().join("log.csv");
    fs::write(&log, "timestamp,actual_q_0\n0,1\n").unwrap();
    let (log, to) = (text(&log), text(&out));
    for (arguments, says) in [
        (vec!["--on", &log, "--twin", "scenarios/twins/ur5.toml"], "log.csv"),
        (vec!["--on", "nowhere.csv", "--twin", "scenarios/twins/ur5.toml"], "nowhere.csv"),
        (vec!["--on", &log, "--twin", "nothing.toml"], "nothing.toml"),
        (vec!["--on", &log], "--twin"),
    ] {
        let run = trial(&[&["draw", "--out", &to][..], &arguments].concat());
        assert!(run.code != 0 && run.stderr.contains(says), "{}", run.stderr);
        assert!(!out.exists(), "{says}");
    }
}

/// On a real arm; says so where its recordings are not here.
#[test]
fn effects_are_grafted_onto_a_ur10e() {
    let Some(folder) = recordings("shamilmamedov-dynamic_calibration/identification_data") else {
        return;
    };
    let out = TempDir::new().unwrap();
    let cases = out.path().join("cases");
    let file = |name: &str| text(&folder.join(format!("ur-20_{name}.csv.gz")));
    let (one, other) = (file("02_05-20sec_8harm"), file("02_06-20sec_5harm"));
    let map = "scenarios/columns/ur10e_shamilmamedov.toml";
    let on = ["draw", "--on", &one, &other, "--columns", map, "--cases", "12", "--seed", "2"];
    let to = ["--twin", "scenarios/twins/ur10e.toml", "--out", &text(&cases)];
    let run = trial(&[&on[..], &to[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let truths = truths(&cases);
    assert_eq!(truths.len(), 2 + 12);
    for truth in truths.iter().filter(|t| t["kind"] != "untouched") {
        let strength = &truth["effects"][0]["strength"];
        let gaps = strength["gap"].as_array().unwrap().iter().map(|g| g.as_f64().unwrap());
        let reached = gaps.fold(0.0, f64::max);
        let ratio = reached / strength["drawn"].as_f64().unwrap();
        assert!((0.5..1.1).contains(&ratio), "{truth}");
        assert!(truth["base"].is_string() && truth["recordings"][0] != truth["recordings"][1]);
    }
}
