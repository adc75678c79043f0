//! `armtwin trial`: seals, answers without the truth, resumption, repeatability.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::mujoco::script;
use super::{Output, armtwin};

fn trial(arguments: &[&str]) -> Output {
    armtwin(&[&["trial"], arguments].concat())
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn draw(out: &Path, more: &[&str]) {
    let few = ["draw", "--cases", "3", "--seed", "5", "--duration", "8", "--out", text(out)];
    let only = ["--only", "clean,single,withheld,stribeck,current_offset"];
    let run = trial(&[&few[..], &only[..], more].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
}

fn answer(cases: &Path, out: &Path) -> String {
    let run = trial(&["answer", text(cases), "--out", text(out)]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    run.stdout
}

/// Every file below a folder with its bytes, in order; not the lists of what armtwin wrote.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(dir) = open.pop() {
        for entry in fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => open.push(path),
                false => {
                    let name = path.strip_prefix(folder).unwrap().to_path_buf();
                    found.push((name, fs::read(&path).unwrap()));
                }
            }
        }
    }
    found.retain(|(name, _)| !name.ends_with(".armtwin"));
    found.sort();
    found
}

/// Command and position of small servos, their arm beside them; the answer comes by simulation.
#[test]
fn a_trial_of_position_servos() {
    let folder = TempDir::new().unwrap();
    let [cases, answers] = ["cases", "answers"].map(|name| folder.path().join(name));
    let few = ["draw", "--servos", "--cases", "2", "--seed", "3", "--duration", "12"];
    let only = ["--only", "clean,single,servo_gain", "--out", text(&cases)];
    let run = trial(&[&few[..], &only[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let case = cases.join("case-0000");
    assert!(case.join("robot.urdf").exists());
    let recording = armtwin::recording::read(&case.join("fit.csv.gz"), None).unwrap();
    assert!(recording.channels.iter().all(|c| c.name.contains("_q_")));
    answer(&cases, &answers);
    let scored = folder.path().join("scores.json");
    let run = trial(&["score", text(&cases), text(&answers), "--json", text(&scored)]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let scores: serde_json::Value = serde_json::from_slice(&fs::read(&scored).unwrap()).unwrap();
    let found = scores["trials"][0]["cases"].as_array().unwrap();
    let of = |kind: &str| found.iter().find(|c| c["kind"] == kind).unwrap();
    assert_eq!(of("clean")["causes"].as_array().unwrap().len(), 0, "{found:?}");
    let single = of("single");
    assert!(single["strength"].as_f64().unwrap() > 0.1, "{single}");
    // Less gain of a servo and more inertia swing alike within twelve seconds.
    assert_eq!(single["top1_set"], true, "{single}");
    // On a third recording what is named predicts the position as well as the truth does.
    let [realised, oracle] = ["realised", "oracle"].map(|name| single[name].as_f64().unwrap());
    assert!(oracle > 0.8 && realised > 0.95 * oracle, "{single}");
    let said: serde_json::Value =
        serde_json::from_slice(&fs::read(answers.join("case-0000.json")).unwrap()).unwrap();
    assert_eq!(said["diagnosis"]["by"], "simulation");
}

#[test]
fn a_small_trial_from_end_to_end() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    draw(&at("cases"), &[]);
    draw(&at("again"), &["--jobs", "1"]);
    assert!(files(&at("cases")) == files(&at("again")), "the same seed drew other cases");
    let case = at("cases").join("case-0001");
    for file in ["fit.csv.gz", "check.csv.gz", "twin.toml", "settings.toml"] {
        assert!(case.join(file).is_file(), "no {file}");
    }

    let blind = at("blind");
    fs::rename(at("again"), &blind).unwrap();
    fs::remove_dir_all(blind.join("sealed")).unwrap();
    fs::remove_file(blind.join("seals.json")).unwrap();
    answer(&at("cases"), &at("answers"));
    answer(&blind, &at("blind_answers"));
    let answers = files(&at("answers"));
    assert_eq!(answers.len(), 3);
    assert!(answers == files(&at("blind_answers")), "the truth was seen, or answers do not repeat");

    let page = at("page.md");
    let (cases, given) = (at("cases"), at("answers"));
    let score = || {
        trial(&[
            "score",
            text(&cases),
            text(&given),
            "--out",
            text(&page),
            "--json",
            text(&at("s.json")),
        ])
    };
    let run = score();
    assert_eq!(run.code, 0, "{}", run.stderr);
    let written = fs::read_to_string(&page).unwrap();
    for word in ["Against the goals", "top-1 within the set", "Simpler rules", "3 cases"] {
        assert!(written.contains(word), "no {word} in the page");
    }
    let scores = fs::read_to_string(at("s.json")).unwrap();
    let scores: serde_json::Value = serde_json::from_str(&scores).unwrap();
    assert_eq!(scores["trials"][0]["cases"].as_array().unwrap().len(), 3);

    let sealed = cases.join("sealed/case-0001.json");
    let truth = fs::read_to_string(&sealed).unwrap();
    fs::write(&sealed, truth.replacen("\"case\": \"case-0001\"", "\"case\": \"case-0009\"", 1))
        .unwrap();
    let run = score();
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("case-0001.json: the seal is broken"), "{}", run.stderr);
}

#[test]
fn answers_that_are_there_are_kept_and_others_made() {
    let folder = TempDir::new().unwrap();
    let (cases, answers) = (folder.path().join("cases"), folder.path().join("answers"));
    draw(&cases, &[]);
    answer(&cases, &answers);
    let first = files(&answers);
    fs::remove_file(answers.join("case-0000.json")).unwrap();
    let said = answer(&cases, &answers);
    assert!(said.contains("2 of them kept"), "{said}");
    assert!(first == files(&answers), "an answer made later differs");
    // Another recording under the same name is another case.
    fs::copy(cases.join("case-0001/check.csv.gz"), cases.join("case-0001/fit.csv.gz")).unwrap();
    let said = answer(&cases, &answers);
    assert!(said.contains("2 of them kept"), "{said}");
}

#[test]
fn criteria_are_moved_one_by_one_and_their_answers_kept() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| text(&folder.path().join(name)).to_string();
    let few = ["draw", "--cases", "1", "--only", "single,current_offset", "--duration", "8"];
    assert_eq!(trial(&[&few[..], &["--out", &at("cases")]].concat()).code, 0);
    let criteria = |more: &[&str]| {
        let files = ["--page", &at("page.md"), "--json", &at("c.json")];
        let command = ["criteria", &at("cases"), "--out", &at("out")];
        let run = trial(&[&command, &files[..], more].concat());
        let read = |name: &str| fs::read_to_string(at(name)).unwrap_or_default();
        (run, read("page.md"), serde_json::from_str(&read("c.json")).unwrap_or_default())
    };
    let (run, page, rows): (_, _, serde_json::Value) = criteria(&[]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    answer(&folder.path().join("cases"), &folder.path().join("plain"));
    let plain = files(&folder.path().join("plain"));
    assert!(plain == files(&folder.path().join("out/base")), "not what `trial answer` says");
    let moved = rows["rows"].as_array().unwrap();
    assert_eq!(rows["answers"], moved.len());
    for (row, direction) in moved[1..].iter().zip(["down", "up"].iter().cycle()) {
        let (criterion, to) = (row["moved"]["criterion"].as_str().unwrap(), &row["moved"]["to"]);
        let file = at(&format!("out/{criterion}-{direction}/case-0000.json"));
        let told: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
        let used = &told["diagnosis"]["criteria"][criterion];
        assert_eq!(used.as_f64(), to.as_f64(), "{criterion}");
        assert!(page.contains(&format!("| {criterion} | ")), "no {criterion} in {page}");
    }
    // One is lost, one is by other criteria: these two are made again.
    fs::remove_file(at("out/base/case-0000.json")).unwrap();
    let other = at("out/least_nats-up/case-0000.json");
    fs::copy(at("out/least_nats-down/case-0000.json"), &other).unwrap();
    // The copy is somebody's.
    let (run, ..) = criteria(&[]);
    assert!(run.code == 1 && run.stderr.contains("--overwrite"), "{}", run.stderr);
    let _ = fs::remove_file(at("out/base/case-0000.json"));
    let (run, again, resumed) = criteria(&["--overwrite"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(resumed["kept"], moved.len() - 2);
    assert!(again == page && resumed["rows"] == rows["rows"], "answers do not repeat");

    fs::remove_file(at("page.md")).unwrap();
    let sealed = folder.path().join("cases/sealed/case-0000.json");
    fs::write(&sealed, fs::read_to_string(&sealed).unwrap() + " ").unwrap();
    let (run, page, _) = criteria(&[]);
    assert!(run.code == 1 && run.stderr.contains("the seal is broken"), "{}", run.stderr);
    assert!(page.is_empty());
}

#[test]
fn cases_made_elsewhere_are_taken_and_unknown_effects_refused() {
    let folder = TempDir::new().unwrap();
    let (own, from) = (folder.path().join("own"), folder.path().join("from"));
    draw(&own, &[]);
    fs::create_dir_all(from.join("case-7")).unwrap();
    fs::copy(own.join("case-0000/twin.toml"), from.join("twin.toml")).unwrap();
    for (theirs, ours) in [("identification", "fit"), ("validation", "check")] {
        let to = from.join(format!("case-7/{theirs}.csv.gz"));
        fs::copy(own.join(format!("case-0000/{ours}.csv.gz")), to).unwrap();
    }
    let again = trial(&["draw", "--from", text(&from), "--out", text(&own)]);
    assert!(again.code == 1 && again.stderr.contains("holds a trial"), "{}", again.stderr);
    let label = |effect: &str| {
        let label = format!("{{\"effect\": \"{effect}\", \"joints\": [0]}}");
        fs::write(from.join("case-7/truth.json"), label).unwrap();
    };
    let take = |out: &str, more: &[&str]| {
        let out = folder.path().join(out);
        trial(&[&["draw", "--from", text(&from), "--out", text(&out)], more].concat())
    };
    label("joint_offset");
    assert_eq!(take("a", &[]).code, 0);
    let truth = fs::read_to_string(folder.path().join("a/sealed/case-7.json")).unwrap();
    assert!(truth.contains("\"encoder_offset\""), "{truth}");
    label("squeak");
    let run = take("b", &[]);
    assert!(run.code == 1 && run.stderr.contains("no effect `squeak`"), "{}", run.stderr);
    let names = folder.path().join("names.toml");
    fs::write(&names, "[effects]\nsqueak = \"stribeck\"\n").unwrap();
    let run = take("c", &["--names", text(&names)]);
    assert_eq!(run.code, 0, "{}", run.stderr);
}

#[test]
fn a_payload_in_mujoco_is_told() {
    let folder = TempDir::new().unwrap();
    let [made, cases, answers] = ["made", "cases", "answers"].map(|n| folder.path().join(n));
    let few = ["--only", "12", "--duration", "24"];
    if script("cases.py", &[&[text(&made)], &few[..]].concat()).is_none() {
        return;
    }
    let names = made.join("names.toml");
    let known = ["--names", text(&names), "--mass-error", "0"];
    let run =
        trial(&[&["draw", "--from", text(&made), "--out", text(&cases)], &known[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    answer(&cases, &answers);
    let told = fs::read_to_string(answers.join("case-012.json")).unwrap();
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    let cause = &told["diagnosis"]["causes"][0];
    assert_eq!(cause["effect"], "payload", "{}", told["diagnosis"]["ranking"]);
    let truth = fs::read_to_string(made.join("case-012/truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
    let hidden = truth["parameters"]["mass"].as_f64().unwrap();
    let told = cause["parameters"][0]["value"].as_f64().unwrap();
    // 0.6 % measured.
    assert!((told / hidden - 1.0).abs() < 0.02, "{told} kg for {hidden} kg");
}

#[test]
fn wrong_usage_is_refused() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let run = trial(&["draw", "--only", "paylod", "--out", text(&out)]);
    assert!(run.code == 1 && run.stderr.contains("paylod"), "{}", run.stderr);
    let run = trial(&["answer", text(folder.path()), "--out", text(&out)]);
    assert!(run.code == 1 && run.stderr.contains("holds no cases"), "{}", run.stderr);
    fs::create_dir_all(folder.path().join("elsewhere/case-1")).unwrap();
    let elsewhere = folder.path().join("elsewhere");
    let run = trial(&["answer", text(&elsewhere), "--out", text(&out)]);
    assert!(run.code == 1 && run.stderr.contains("--from"), "{}", run.stderr);
    assert_eq!(trial(&["score", "one"]).code, 2);
    let out = folder.path().join("criteria");
    let refused = ["criteria", text(&elsewhere), "--out", text(&out)];
    let run = trial(&refused);
    assert!(run.code == 1 && run.stderr.contains("seals.json"), "{}", run.stderr);
    assert_eq!(trial(&[&refused[..], &["--limit", "0"]].concat()).code, 2);
    assert!(!out.exists(), "a refused command left something behind");
}
