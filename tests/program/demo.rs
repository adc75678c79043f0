//! The main job in one go, and the study of its reliability.

use std::fs;

use tempfile::TempDir;

use super::{armtwin, browser};

#[test]
fn the_demo_finds_what_it_hid() {
    let out = TempDir::new().unwrap();
    let folder = out.path().join("demo");
    let run = armtwin(&["demo", "--out", folder.to_str().unwrap(), "--duration", "40"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let told = run.stdout.lines().find_map(|line| line.strip_prefix("Found (true): "));
    let words = told.iter().flat_map(|line| line.split_whitespace());
    let counts: Vec<usize> = words.filter_map(|word| word.parse().ok()).collect();
    let [held, all] = counts[..] else { panic!("{}", run.stdout) };
    assert!(held >= 30 && held + 3 >= all, "{held} of {all} held\n{}", run.stdout);
    let values = run.stdout.find("3. Diagnose").unwrap();
    assert!(run.stdout[..values].lines().count() <= 30, "{}", run.stdout);
    assert!(run.stdout.contains("the twin lacks torque_ripple at joint 3"), "{}", run.stdout);
    for file in ["fit.csv", "check.csv", "truth.json", "twin.toml", "diagnosis.json"] {
        assert!(fs::metadata(folder.join(file)).unwrap().len() > 100, "{file}");
    }
    let sections =
        ["torque", "causes", "gap", "friction", "residual", "ranking", "shrink", "left", "about"];
    // The mended twin holds each joint's own Stribeck velocity, as identified.
    let twin: toml::Table =
        fs::read_to_string(folder.join("twin.toml")).unwrap().parse().expect("a twin");
    let velocity = twin["twin"]["values"]["stribeck_velocity"].as_array().unwrap();
    let velocity: Vec<f64> = velocity.iter().filter_map(toml::Value::as_float).collect();
    for (joint, (found, truth)) in
        velocity.iter().zip([0.05, 0.045, 0.055, 0.04, 0.05, 0.035]).enumerate()
    {
        // The hidden ripple covers the curve of joint 3.
        assert!(joint == 2 || (found / truth - 1.0).abs() < 0.15, "{joint}: {velocity:?}");
    }
    assert!(velocity[3] != velocity[4], "{velocity:?}");
    // The first picture, torque over time and over speed of six joints, what is left at the open one.
    browser::assert_sound(&folder.join("report.html"), &sections, 2 + 6 + 6 + 5);
    #[cfg(feature = "viewer")]
    assert_shown(&folder.join("twin.rrd"));
}

/// Not blank, the recorded arm and both twins on it.
#[cfg(feature = "viewer")]
fn assert_shown(rrd: &std::path::Path) {
    assert!(fs::metadata(rrd).unwrap().len() > 100_000);
    let Some(picture) = super::picture::render(rrd) else { return };
    assert!(picture.colours() > 500, "{} colours", picture.colours());
    let curves = [("as given", [251, 146, 60]), ("mended", [45, 212, 191])];
    for (what, colour) in curves {
        let pixels = picture.count(colour, 40);
        assert!(pixels > 300, "{what}: {pixels} pixels");
    }
}

#[test]
fn a_demo_that_cannot_be_written_says_so() {
    let out = TempDir::new().unwrap();
    let file = out.path().join("taken");
    fs::write(&file, "not a folder").unwrap();
    let run = armtwin(&["demo", "--out", file.to_str().unwrap(), "--duration", "10"]);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("taken"), "{}", run.stderr);
    assert_eq!(fs::read_to_string(&file).unwrap(), "not a folder");
}

#[test]
fn the_recovery_study_writes_its_page() {
    let out = TempDir::new().unwrap();
    let page = out.path().join("recovery.md");
    let run = armtwin(&["recovery", "--seeds", "1", "-o", page.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let page = fs::read_to_string(page).unwrap();
    for word in ["| coulomb | 6 |", "robust", "Dropped, of 6"] {
        assert!(page.contains(word), "no {word:?} in\n{page}");
    }
}
