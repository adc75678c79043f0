//! The rules of ARCHITECTURE.md that a program can check.

use std::fs;
use std::path::{Path, PathBuf};

#[path = "tidy/imports.rs"]
mod imports;

/// (path, text) of every Rust file below a folder of the repository.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut open = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(dir) = open.pop() {
        for entry in fs::read_dir(&dir).expect("a readable source folder") {
            let path = entry.expect("a readable entry").path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path).expect("UTF-8 source");
                found.push((path, text));
            }
        }
    }
    assert!(!found.is_empty(), "no sources under {folder}");
    found
}

/// A line without its comment.
fn code(line: &str) -> &str {
    line.split("//").next().unwrap_or_default()
}

fn assert_never_uses(room: &str, others: &[&str]) {
    for (path, text) in sources(&format!("src/{room}")) {
        for other in others {
            let word = format!("crate::{other}");
            let used = text.lines().any(|l| code(l).contains(&word));
            assert!(!used, "{} must not use `{other}`", path.display());
        }
    }
}

#[test]
fn every_file_says_what_it_is_for() {
    for (path, text) in ["src", "tests"].into_iter().flat_map(sources) {
        assert!(text.starts_with("//!"), "{} has no //! head", path.display());
    }
}

#[test]
fn files_stay_small() {
    for (path, text) in sources("src") {
        let lines = text.lines().count();
        assert!(lines <= 500, "{} has {lines} lines: split it by purpose", path.display());
    }
}

#[test]
fn what_makes_the_data_does_not_explain_it() {
    assert_never_uses("simulation", &["identification", "signals"]);
    assert_never_uses("identification", &["simulation"]);
}

#[test]
fn rooms_only_look_upstream() {
    assert_never_uses("robot", &["effects", "recording", "signals", "simulation", "twin"]);
    assert_never_uses("effects", &["recording", "signals", "simulation", "twin"]);
    assert_never_uses("recording", &["signals", "simulation", "twin", "effects"]);
    assert_never_uses("statistics", &["recording", "signals", "effects", "identification"]);
    let core = ["robot", "effects", "recording", "signals", "statistics", "identification", "twin"];
    for room in core {
        assert_never_uses(room, &["cli", "viewer", "report"]);
    }
    // Recordings that exist are explained without it.
    for room in ["simulation", "identification", "diagnosis", "trials", "twin", "motion"] {
        assert_never_uses(room, &["excitation"]);
    }
    assert_never_uses(
        "excitation",
        &["diagnosis", "identification", "cli", "viewer", "report::html"],
    );
    // Bytes and rows come in from outside; who makes them knows nothing of what becomes of them.
    assert_never_uses("rtde", &["live", "watch", "recording", "simulation", "cli"]);
    assert_never_uses("live", &["watch", "diagnosis", "identification", "cli"]);
    assert_never_uses("watch", &["live", "rtde", "studies", "cli", "viewer"]);
    // What both have in common lies below both.
    assert_never_uses("workflow", &["cli"]);
    // Pages show what these find; tables as text are for all of them.
    for room in ["diagnosis", "motor", "studies", "trials", "case_studies"] {
        assert_never_uses(room, &["cli", "viewer", "report::html"]);
    }
}

/// A feature that nobody builds alone does not build for long.
#[test]
fn every_feature_is_checked_by_itself_in_ci() {
    let read = |name: &str| {
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).expect("a text")
    };
    let (manifest, ci) = (read("Cargo.toml"), read(".ci/run"));
    let table = manifest.split("[features]").nth(1).and_then(|t| t.split("\n[").next());
    let names = table.expect("features").lines().filter_map(|l| l.split_once(" = [")).map(|f| f.0);
    let checks: Vec<&str> = ci.lines().filter(|l| l.contains("--no-default-features")).collect();
    assert!(checks.iter().any(|l| l.ends_with("--no-default-features")), "the library alone");
    for feature in names.filter(|name| !["default", "viewer"].contains(name)) {
        let asked = checks.iter().filter_map(|l| l.split("--features ").nth(1));
        let named = asked.flat_map(|list| list.split(',')).any(|name| name == feature);
        assert!(named, ".ci/run checks no build with the feature `{feature}`");
    }
}

/// What the library does with recordings is done there, not in the command line or the Python layer.
#[test]
fn what_converts_does_not_decide() {
    for (path, text) in sources("python/src") {
        let lines = text.lines().count();
        assert!(lines <= 300 && text.starts_with("//!"), "{} has {lines} lines", path.display());
        for room in ["signals", "diagnosis::diagnose", "identification::identify", "plausibility"] {
            let word = format!("armtwin::{room}");
            assert!(!text.lines().any(|l| code(l).contains(&word)), "{}: {room}", path.display());
        }
    }
}

#[test]
fn third_party_types_stay_at_their_edge() {
    for (krate, rooms) in [
        ("rapier3d_f64", &["simulation"][..]),
        ("rerun", &["viewer"]),
        ("clap", &["cli"]),
        ("roxmltree", &["urdf"]),
        ("mcap", &["recording"]),
        ("rusqlite", &["recording"]),
        ("zstd", &["recording"]),
        ("lz4", &["recording"]),
        ("arrow", &["recording", "sweep"]),
        ("parquet", &["recording", "sweep"]),
        ("plotters", &["figure"]),
        ("maud", &["html"]),
    ] {
        let (path_like, import) = (format!("{krate}::"), format!("use {krate}"));
        for (path, text) in sources("src") {
            let home = path.components().any(|c| rooms.iter().any(|room| c.as_os_str() == *room));
            let used = text.lines().map(code).any(|l| {
                l.trim_start().starts_with(&import) || l.contains(&format!(" {path_like}"))
            });
            assert!(home || !used, "{} uses {krate} outside {rooms:?}", path.display());
        }
    }
}

/// `cli::outputs` asks about these before the work begins, and takes every other file for one to read.
#[test]
fn flags_that_name_a_file_to_write_say_so_by_their_type() {
    let read = ["twin", "names"];
    for (path, text) in sources("src/cli") {
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            if code(line).contains("value_name = \"FILE") {
                let field = lines.find(|l| l.contains(": ")).unwrap_or_default().trim();
                let name = field.split(':').next().unwrap_or_default();
                let said = field.contains("Output") || read.contains(&name);
                assert!(said, "{}: `{field}` is an `Output`, or one of {read:?}", path.display());
            }
        }
    }
}

/// Is a file part of the tests alone?
fn is_test(path: &Path) -> bool {
    let names: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
    let file = names.last().map_or("", |name| name.as_ref());
    file.ends_with("tests.rs") || names.iter().any(|n| n == "tests" || n.ends_with("_tests"))
}

#[test]
fn modules_do_not_import_each_other_in_circles() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let all = sources("src");
    let code: Vec<_> = all
        .iter()
        .map(|(path, text)| (path.strip_prefix(&src).expect("below src"), text.as_str()))
        .filter(|(path, _)| !is_test(path))
        .collect();
    let circles = imports::circles(&code);
    assert!(circles.is_empty(), "{} circles:\n{}", circles.len(), circles.join("\n"));
}
