//! What a shell and its user rely on: pipes that end early, completions, manual pages.

use std::process::{Command, Stdio};

use tempfile::TempDir;

use super::armtwin;

/// `armtwin effects | head -1`
#[test]
fn a_reader_that_leaves_is_no_error() {
    let mut run = Command::new(env!("CARGO_BIN_EXE_armtwin"))
        .arg("effects")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(run.stdout.take());
    let out = run.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success() && said.is_empty(), "{:?} {said}", out.status);
}

#[test]
fn completions_know_every_command() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let run = armtwin(&["completions", shell]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        for word in ["diagnose", "identify", "--help"] {
            let word = if shell == "fish" { word.trim_start_matches("--") } else { word };
            assert!(run.stdout.contains(word), "{shell}: no {word}");
        }
    }
    assert_eq!(armtwin(&["completions", "tcsh"]).code, 2);
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = TempDir::new().unwrap();
    let run = armtwin(&["man", "--out", folder.path().to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for page in ["armtwin", "armtwin-diagnose", "armtwin-trial-answer"] {
        let text = std::fs::read_to_string(folder.path().join(format!("{page}.1"))).unwrap();
        assert!(text.contains(".SH SYNOPSIS"), "{page}");
    }
    assert!(armtwin(&["man"]).stdout.contains(".TH armtwin 1"));
}

/// Neither a pipe nor NO_COLOR gets colours.
#[test]
fn pipes_get_plain_text() {
    for arguments in [&["effects"][..], &["--help"], &["diagnose", "--help"]] {
        assert!(!armtwin(arguments).stdout.contains('\u{1b}'), "{arguments:?}");
    }
}
