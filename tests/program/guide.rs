//! Every `armtwin` command of the guide, as written, chapter by chapter in the order of its summary.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::armtwin;

fn guide() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/guide/src")
}

/// Chapters in order: the links of the summary.
fn chapters() -> Vec<String> {
    let summary = fs::read_to_string(guide().join("SUMMARY.md")).unwrap();
    let links = summary.split("](").skip(1).map(|l| l.split(')').next().unwrap().to_string());
    links.collect()
}

/// (language, text) of the fenced blocks.
fn blocks(markdown: &str) -> Vec<(String, String)> {
    let fenced = markdown.split("```").skip(1).step_by(2);
    let parts = fenced.map(|b| b.split_once('\n').unwrap());
    parts.map(|(language, text)| (language.to_string(), text.to_string())).collect()
}

/// `demo` is run by a test of its own, which looks at all it leaves behind, ...
const ELSEWHERE: &str = "armtwin demo";
/// ... and this chapter, to which no other one comes back, is typed by a test of servos.
pub const OF_SERVOS: &str = "no-torque.md";

/// Types a chapter in a folder: writes its files and runs its commands. What they printed, one after the other.
fn typed(folder: &Path, chapter: &str) -> Vec<String> {
    let mut printed = Vec::new();
    for (language, text) in blocks(&fs::read_to_string(guide().join(chapter)).unwrap()) {
        if language == "toml" {
            let name = text.lines().next().unwrap().trim_start_matches("# ").to_string();
            fs::write(folder.join(name), &text).unwrap();
        }
        for line in text.lines().filter(|l| language == "sh" && *l != ELSEWHERE) {
            let words: Vec<&str> = line.split_whitespace().collect();
            assert_eq!(words[0], "armtwin", "{chapter}: {line}");
            let run = Command::new(env!("CARGO_BIN_EXE_armtwin"))
                .args(&words[1..])
                .current_dir(folder)
                .output()
                .unwrap();
            let error = String::from_utf8_lossy(&run.stderr);
            assert!(run.status.success(), "{chapter}: {line}: {error}");
            printed.push(String::from_utf8_lossy(&run.stdout).into_owned());
        }
    }
    printed
}

/// Types chapters one after the other in a folder of their own.
pub fn all_typed(chapters: &[&str]) -> (TempDir, Vec<String>) {
    let folder = TempDir::new().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    #[cfg(unix)]
    std::os::unix::fs::symlink(root.join("scenarios"), folder.path().join("scenarios")).unwrap();
    let printed = chapters.iter().flat_map(|chapter| typed(folder.path(), chapter)).collect();
    (folder, printed)
}

#[test]
fn the_guide_can_be_typed_as_it_stands() {
    let all = chapters();
    assert!(all.iter().any(|chapter| chapter == OF_SERVOS));
    let here: Vec<&str> = all.iter().map(String::as_str).filter(|c| *c != OF_SERVOS).collect();
    let (folder, printed) = all_typed(&here);
    let count = printed.len();
    assert!(count >= 15, "{count}");
    let twin = fs::read_to_string(folder.path().join("diagnosis/twin.toml")).unwrap();
    assert!(twin.contains("payload_mass"), "the guide promises a payload: {twin}");
    let model = fs::read_to_string(folder.path().join("arm.xml")).unwrap();
    assert!(model.contains("<body name=\"payload\""), "{model}");
}

#[test]
fn every_chapter_is_there_and_in_the_summary() {
    let listed = chapters();
    for file in fs::read_dir(guide()).unwrap().map(|f| f.unwrap().file_name()) {
        let name = file.to_str().unwrap().to_string();
        assert!(name == "SUMMARY.md" || listed.contains(&name), "{name} is not in the summary");
    }
    for name in &listed {
        let text = fs::read_to_string(guide().join(name)).unwrap();
        assert!(text.starts_with("# "), "{name} has no title");
        let links = text.split("](").skip(1).map(|l| l.split(')').next().unwrap());
        for link in links.filter(|l| l.ends_with(".md")) {
            assert!(guide().join(link).is_file(), "{name}: no {link}");
        }
    }
}

#[test]
fn the_chapter_on_effects_is_what_the_command_prints() {
    let printed = armtwin(&["effects", "--guide"]);
    assert_eq!(printed.code, 0, "{}", printed.stderr);
    let chapter = fs::read_to_string(guide().join("effects.md")).unwrap();
    let cure = "run: armtwin effects --guide > docs/guide/src/effects.md";
    assert!(chapter.trim_end() == printed.stdout.trim_end(), "effects.md is old; {cure}");
}
