//! `armtwin excite`: what it writes, prints and refuses.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use super::{Output, armtwin};

const TWIN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/twins/ur5.toml");

fn excite(more: &[&str]) -> Output {
    armtwin(&[&["excite", "--twin", TWIN, "--seconds", "10"], more].concat())
}

fn names(folder: &Path) -> Vec<String> {
    let all = fs::read_dir(folder).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
    let mut all: Vec<String> = all.collect();
    all.sort();
    all
}

#[test]
fn one_motion_in_four_formats() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let files = ["next.csv", "next.yaml", "next.script", "next.toml"].map(at);
    let mut words = vec!["--for", "friction", "--table-z", "0", "--evaluations", "300"];
    files.iter().for_each(|f| words.extend(["-o", f]));
    let json = at("out.json");
    words.extend(["--json", &json]);
    let run = excite(&words);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for part in ["18 parameters in 10 s", "times narrower", "stribeck, joint 6", "simulated"] {
        assert!(run.stdout.contains(part), "no {part}: {}", run.stdout);
    }
    let made: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    let report = &made["report"];
    assert_eq!(made["schema"], "armtwin.excitation/1");
    assert_eq!((&report["seed"], &report["evaluations"]), (&1.into(), &300.into()));
    assert!(report["narrower"].as_f64().unwrap() > 1.0, "{}", report["narrower"]);
    assert!(report["simulated"]["closest"]["distance_m"].as_f64().unwrap() >= 0.02);
    assert_eq!(made["motion"]["kind"], "series");

    // The scenario is simulated along the motion that the CSV lists.
    let run = armtwin(&["simulate", &files[3], "--out", &at("made")]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let [csv, fit] = [&files[0], &at("made/fit.csv")]
        .map(|f| armtwin::recording::read(Path::new(f), None).unwrap());
    let [asked, commanded] = [csv, fit].map(|r| r.joints("target_q").unwrap());
    assert_eq!(asked.samples(), commanded.samples());
    for j in 0..6 {
        let pairs = asked.joint(j).iter().zip(commanded.joint(j));
        assert!(pairs.into_iter().all(|(a, c)| (a - c).abs() < 1e-9), "joint {}", j + 1);
    }
    let bytes = files.clone().map(|f| fs::read(f).unwrap());
    assert_eq!(excite(&words).code, 0);
    assert!(bytes == files.map(|f| fs::read(f).unwrap()), "the same seed gave other files");
}

#[test]
fn what_cannot_be_done_leaves_nothing() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("next.csv");
    let out = out.to_str().unwrap();
    let few = ["--evaluations", "60", "-o", out];
    let cases: [(&[&str], &str); 10] = [
        (&["--table-z", "0.9"], "the table come within"),
        (&["--for", "columb"], "`columb` is not known"),
        (&["--for", "time_delay"], "does not show as joint torque"),
        (&["--apart", "payload"], "give two rivals"),
        (&["--apart", "coulomb@9,payload"], "count from 1 to 6"),
        (&["--keep-out", "0,0,0,1,1"], "six finite numbers"),
        (&["--seconds", "-1"], "--seconds = -1"),
        (&["--home", "0,0"], "2 angles"),
        (&["--noise", "1,1"], "--noise has 2 values"),
        (&["-o", "next.txt"], "next.txt: name the file .csv"),
    ];
    for (words, message) in cases {
        let run = armtwin(&[&["excite", "--twin", TWIN], words, &few[..]].concat());
        assert_eq!(run.code, 1, "{words:?}: {}", run.stderr);
        assert!(run.stderr.contains(message), "{words:?}: {}", run.stderr);
        assert!(names(folder.path()).is_empty(), "{words:?} left {:?}", names(folder.path()));
    }
    let run = excite(&["-o", "no/such/folder/next.csv"]);
    assert!(run.code == 1 && run.stderr.contains("there is no folder"), "{}", run.stderr);
}

#[test]
fn a_study_is_a_page() {
    let folder = TempDir::new().unwrap();
    let page = folder.path().join("page.md");
    let page = page.to_str().unwrap();
    let words = ["--for", "coulomb,viscous", "--study", "2", "--evaluations", "60", "-o", page];
    let run = excite(&words);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let text = fs::read_to_string(page).unwrap();
    assert_eq!(text, run.stdout);
    assert!(text.contains("## coulomb\n") && text.contains("| viscous, joint 6 | 1 |"), "{text}");
    let other = excite(&["--study", "2", "-o", "a.csv"]);
    assert!(other.code == 1 && other.stderr.contains("writes Markdown"), "{}", other.stderr);
}

/// With the goals and the seeds that the README cites.
#[test]
fn the_page_in_docs_says_how_it_was_made() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs/excitation.md")).unwrap();
    for part in ["armtwin excite --twin", "--study 5", "## inertia", "## friction", "link 6"] {
        assert!(text.contains(part), "no {part}");
    }
}
