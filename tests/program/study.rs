//! `armtwin study`: shipped studies, shards, resumption, what damage and a full disk do.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use tempfile::TempDir;

use super::browser::assert_sound;
use super::{Output, armtwin};

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/studies").join(format!("{name}.toml"))
}

fn study(file: &Path, out: &Path, more: &[&str]) -> Output {
    armtwin(&[&["study", text(file), "--out", text(out)], more].concat())
}

fn done(file: &Path, out: &Path, more: &[&str]) -> String {
    let run = study(file, out, more);
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{}", run.stdout);
    run.stdout
}

/// What a study is made for, by file name; not what depends on the machine.
fn results(out: &Path, question: &str) -> Vec<(String, Vec<u8>)> {
    let mut found: Vec<(String, Vec<u8>)> = Vec::new();
    for entry in fs::read_dir(out).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let timed = name == "timings.parquet" || question == "cost" && name != "cells.parquet";
        if path.is_file() && !timed && !["lock", "study.toml", ".armtwin"].contains(&&*name) {
            found.push((name, fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

fn whole_and_in_shards(name: &str, question: &str) -> String {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    let file = shipped(name);
    let said = done(&file, &at("whole"), &[]);
    assert!(
        said.contains("cells per hour") && said.contains("simulated seconds per second"),
        "{said}"
    );
    let summary = fs::read_to_string(at("whole/summary.md")).unwrap();
    done(&file, &at("one"), &["--shard", "1/2", "--jobs", "1"]);
    let early = armtwin(&["study", "merge", text(&at("one")), "--out", text(&at("merged"))]);
    assert!(early.code == 1 && early.stderr.contains("are missing"), "{}", early.stderr);
    done(&file, &at("two"), &["--shard", "2/2", "--jobs", "1"]);
    let [one, two, merged] = ["one", "two", "merged"].map(at);
    let chapters = summary.lines().filter_map(|line| line.strip_prefix("## "));
    let chapters: Vec<String> = chapters.map(|c| c.to_lowercase().replace(' ', "-")).collect();
    let sections: Vec<&str> = chapters.iter().map(String::as_str).chain(["summary"]).collect();
    let report = at("whole/report.html");
    let plots = fs::read_to_string(&report).unwrap().matches("<div class=\"plot").count();
    assert!(plots > summary.matches(".svg)").count(), "{plots} plots: a picture, and every figure");
    assert_sound(&report, &sections, plots);
    let merge = armtwin(&["study", "merge", text(&two), text(&one), "--out", text(&merged)]);
    assert_eq!(merge.code, 0, "{}", merge.stderr);
    let [single, joined] = [at("whole"), merged].map(|out| results(&out, question));
    assert!(single.len() == joined.len() && single.len() > usize::from(question != "cost"));
    for (a, b) in single.iter().zip(&joined) {
        assert!(a == b, "{name}: {} differs between one run and two shards", a.0);
    }
    summary
}

#[test]
fn identification_is_the_same_in_shards() {
    let summary = whole_and_in_shards("identification_small", "identification");
    for word in ["## The arm", "## The motor", "goes first", "Terms are found", "Coverage", "mcmc"]
    {
        assert!(summary.contains(word), "no {word} in {summary}");
    }
}

#[test]
fn detection_is_the_same_in_shards() {
    let summary = whole_and_in_shards("detection_small", "identification");
    for word in ["stribeck_excess x 1", "do not exist", "paper", "### Rounding"] {
        assert!(summary.contains(word), "no {word} in {summary}");
    }
}

#[test]
fn diagnosis_is_the_same_in_shards() {
    let summary = whole_and_in_shards("diagnosis_small", "diagnosis");
    for word in ["False alarms", "payload x 3", "Named right"] {
        assert!(summary.contains(word), "no {word} in {summary}");
    }
}

#[test]
fn cost_is_measured_and_its_results_are_the_same_in_shards() {
    let summary = whole_and_in_shards("cost_small", "cost");
    for word in ["| samples (duration) |", "exponent", "particles", "memory"] {
        assert!(summary.contains(word), "no {word} in {summary}");
    }
}

#[test]
fn full_studies_are_valid_and_have_a_small_one() {
    for name in ["identification", "detection", "diagnosis", "cost"] {
        for name in [name.to_string(), format!("{name}_small")] {
            let file = shipped(&name);
            armtwin::studies::sweep::Study::load(&file).unwrap();
        }
    }
}

/// A dozen cells of a second or so in all.
const QUICK: &str = r#"
title = "quick"
question = "identification"
[arm.motion]
duration_s = 8
[arm.effects.coulomb]
coulomb = 3
[[grid]]
seed = [1, 2, 3]
snr_db = [10, 20, 30, "none"]
method = ["nlse"]
"#;

pub fn quick(folder: &Path) -> PathBuf {
    let file = folder.join("quick.toml");
    fs::write(&file, QUICK).unwrap();
    file
}

fn parts(out: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(out.join("parts")).into_iter().flatten();
    let mut found: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    found.retain(|p| p.file_name().unwrap().to_string_lossy().starts_with("cell-"));
    found.sort();
    found
}

#[test]
fn a_killed_study_goes_on_and_ends_the_same() {
    let folder = TempDir::new().unwrap();
    let file = quick(folder.path());
    let [whole, killed] = ["whole", "killed"].map(|n| folder.path().join(n));
    done(&file, &whole, &[]);
    let mut kept = 0;
    // Some time after a cell was kept: in the middle of others, or as they are written.
    for moment in [0, 41, 7, 97] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_armtwin"))
            .args(["study", text(&file), "--out", text(&killed), "--jobs", "1"])
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        while parts(&killed).len() == kept && program.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(moment));
        program.kill().unwrap();
        program.wait().unwrap();
        let now = parts(&killed).len();
        assert!(now > kept, "{now} cells are kept where {kept} were");
        kept = now;
        if kept > 9 {
            break;
        }
    }
    let said = done(&file, &killed, &[]);
    assert!(said.contains(&format!("{kept} of 12 cells are there")), "{kept}: {said}");
    assert_eq!(results(&whole, ""), results(&killed, ""));
    assert!(done(&file, &killed, &[]).contains("nothing was left to do"));
}

#[test]
fn one_cell_alone_has_the_same_numbers() {
    let folder = TempDir::new().unwrap();
    let file = quick(folder.path());
    let [whole, alone] = ["whole", "alone"].map(|n| folder.path().join(n));
    done(&file, &whole, &[]);
    for cell in (0..12).rev() {
        done(&file, &alone, &["--cell", &cell.to_string()]);
    }
    assert_eq!(parts(&alone).len(), 12);
    let merged = folder.path().join("merged");
    let merge = armtwin(&["study", "merge", text(&alone), "--out", text(&merged)]);
    assert_eq!(merge.code, 0, "{}", merge.stderr);
    assert_eq!(results(&whole, ""), results(&merged, ""));
    let beyond = study(&file, &alone, &["--cell", "12"]);
    assert!(beyond.code == 1 && beyond.stderr.contains("0 to 11"), "{}", beyond.stderr);
}

#[test]
fn damage_is_named_and_good_parts_are_kept() {
    let folder = TempDir::new().unwrap();
    let file = quick(folder.path());
    let out = folder.path().join("out");
    done(&file, &out, &[]);
    let before = results(&out, "");
    let parts = parts(&out);
    let bytes = fs::read(&parts[5]).unwrap();
    let cut = bytes[..bytes.len() / 3].to_vec();
    // In the data, and twice in the footer.
    let flipped = [40, bytes.len() - 60, bytes.len() - 8].map(|at| {
        let mut broken = bytes.clone();
        broken[at] ^= 0x2a;
        broken
    });
    for broken in [cut].into_iter().chain(flipped) {
        fs::write(&parts[5], broken).unwrap();
        let run = study(&file, &out, &[]);
        assert_eq!(run.code, 1);
        let named = run.stderr.contains("cell-000005.parquet") && run.stderr.contains("damaged");
        assert!(named && run.stderr.contains("11 parts are whole"), "{}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    }
    fs::remove_file(&parts[5]).unwrap();
    assert!(done(&file, &out, &[]).contains("11 of 12 cells are there"));
    assert_eq!(results(&out, ""), before);
    // Another study does not mix with it.
    fs::write(&file, QUICK.replace("coulomb = 3", "coulomb = 4")).unwrap();
    let run = study(&file, &out, &[]);
    assert!(run.code == 1 && run.stderr.contains("holds another study"), "{}", run.stderr);
}

/// A limit on the size of files stands in for a full disk: writing fails in the middle.
#[cfg(unix)]
#[test]
fn a_full_disk_is_a_clear_error_and_keeps_what_is_done() {
    let folder = TempDir::new().unwrap();
    let file = quick(folder.path());
    let out = folder.path().join("out");
    done(&file, &out, &["--shard", "1/3"]);
    let kept = parts(&out);
    let program = env!("CARGO_BIN_EXE_armtwin");
    let command = format!(
        "trap '' XFSZ; ulimit -f 1; exec {program} study {} --out {}",
        text(&file),
        text(&out)
    );
    let run = Command::new("sh").args(["-c", &command]).output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(said.contains("cannot be written") && said.contains("are kept"), "{said}");
    assert_eq!(parts(&out), kept);
    done(&file, &out, &[]);
    assert_eq!(parts(&out).len(), 12);
}

/// A part that is copied would count twice, and the cell under whose name it lies not at all.
#[test]
fn a_part_under_the_name_of_another_is_refused() {
    let folder = TempDir::new().unwrap();
    let file = quick(folder.path());
    let out = folder.path().join("out");
    done(&file, &out, &[]);
    let all = parts(&out);
    fs::copy(&all[4], &all[3]).unwrap();
    let merged = folder.path().join("merged");
    let merge = ["study", "merge", text(&out), "--out", text(&merged)];
    for run in [study(&file, &out, &[]), armtwin(&merge)] {
        assert_eq!(run.code, 1, "{}", run.stdout);
        let said = run.stderr.contains("cell-000003.parquet: holds cell 4");
        assert!(said && run.stderr.lines().count() == 1, "{}", run.stderr);
    }
    done(&file, &out, &["--cell", "3"]);
    assert!(done(&file, &out, &[]).contains("12 of 12 cells are there"));
}

#[test]
fn wrong_usage_is_refused() {
    let folder = TempDir::new().unwrap();
    let file = quick(folder.path());
    assert_eq!(study(&file, folder.path(), &["--shard", "3/2"]).code, 2);
    assert_eq!(armtwin(&["study", text(&file)]).code, 2);
    let absent = study(Path::new("no.toml"), folder.path(), &[]);
    assert!(absent.code == 1 && absent.stderr.contains("no.toml"), "{}", absent.stderr);
    let report = armtwin(&["study", "report", text(folder.path())]);
    assert!(report.code == 1 && report.stderr.contains("study.toml"), "{}", report.stderr);
}
