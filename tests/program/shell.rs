//! What a shell and its user rely on: pipes that end early, completions, manual pages.

use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use super::{armtwin, armtwin_across};

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

/// What a command says on a terminal that `script` (util-linux) makes; `None` without it.
fn on_a_terminal(folder: &Path, no_color: &str) -> Option<String> {
    let program = env!("CARGO_BIN_EXE_armtwin");
    let twin = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/twins/ur5.toml");
    let fit = folder.join("fit.csv");
    let command = format!(
        "{program} diagnose --fit {} --twin {twin} --out {}",
        fit.display(),
        folder.join("out").display()
    );
    let run = Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .env("NO_COLOR", no_color)
        .env("TERM", "xterm")
        .stdin(Stdio::null())
        .output();
    let Ok(run) = run else {
        eprintln!("skipped: no `script` on PATH");
        return None;
    };
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(run.status.success(), "{said}");
    Some(said)
}

#[test]
fn a_terminal_gets_colours_unless_they_are_refused() {
    let folder = TempDir::new().unwrap();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/ur5_clean.toml");
    let out = folder.path().to_str().unwrap();
    let made = armtwin(&["simulate", scenario, "--out", out, "--duration", "20"]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    let Some(bold) = on_a_terminal(folder.path(), "") else { return };
    assert!(bold.contains("\u{1b}[1m"), "{bold}");
    let plain = on_a_terminal(folder.path(), "1").unwrap();
    assert!(!plain.contains("\u{1b}[1m") && plain.contains("gap"), "{plain}");
}

/// Nothing is lost by it, and no line is longer than the terminal is wide.
#[test]
fn what_is_printed_fits_the_terminal() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let file = |name: &str| format!("{}/scenarios/{name}", env!("CARGO_MANIFEST_DIR"));
    let scenario = file("ur5_friction.toml");
    let made = armtwin(&["simulate", &scenario, "--out", &at(""), "--duration", "16"]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    let (fit, check, twin) = (at("fit.csv"), at("check.csv"), file("twins/ur5.toml"));
    let rrd = at("compare.rrd");
    let commands: [&[&str]; 7] = [
        &["inspect", &fit, "--twin", &twin],
        &["identify", &fit, "--check", &check, "--method", "nlse"],
        &["identify", &fit, "--check", &check, "--method", "nlse", "--full"],
        &["diagnose", "--fit", &fit, "--check", &check, "--twin", &twin, "--no-simulation"],
        &["contacts", &check, "--fit", &fit, "--twin", &twin],
        &["compare", &check, "--twin", &twin, "-o", &rrd],
        &["robots"],
    ];
    for (arguments, columns) in commands.into_iter().zip([60, 72, 80, 60, 60, 60, 60]) {
        let run = armtwin_across(columns, arguments);
        assert_eq!(run.code, 0, "{arguments:?} {}", run.stderr);
        // A path is one word.
        let wide = run.stdout.lines().find(|l| l.chars().count() > columns && l.contains(' '));
        let wide =
            wide.filter(|l| l.split_whitespace().all(|word| word.chars().count() < columns - 10));
        assert_eq!(wide, None, "{arguments:?}\n{}", run.stdout);
    }
}

#[test]
fn pipes_get_plain_text() {
    for arguments in [&["effects"][..], &["--help"], &["diagnose", "--help"]] {
        assert!(!armtwin(arguments).stdout.contains('\u{1b}'), "{arguments:?}");
    }
}
