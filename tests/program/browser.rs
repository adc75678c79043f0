//! A report opened in Chromium without a window, where it is installed.

use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// What a browser made of a page.
pub struct Opened {
    /// The document after its scripts ran.
    pub dom: String,
    /// What was said on the console: errors, refused loads, warnings.
    pub console: Vec<String>,
}

const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// `None`, and a word about it, without a browser.
pub fn open(page: &Path) -> Option<Opened> {
    let found = |name: &&&str| Command::new(name).arg("--version").output().is_ok();
    let Some(browser) = NAMES.iter().find(found) else {
        eprintln!("skipped: no Chromium on PATH ({})", NAMES.join(", "));
        return None;
    };
    let profile = TempDir::new().unwrap();
    let run = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr"])
        .args(["--window-size=1200,20000", "--virtual-time-budget=60000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", page.canonicalize().unwrap().display()))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    Some(Opened {
        dom: String::from_utf8_lossy(&run.stdout).into_owned(),
        console: said.lines().filter(|l| l.contains("CONSOLE")).map(String::from).collect(),
    })
}

/// Every section is there, every plot is drawn, and nobody complains.
pub fn assert_sound(page: &Path, sections: &[&str], plots: usize) {
    let text = std::fs::read_to_string(page).unwrap();
    assert!(text.len() < 2_000_000, "{} is {} bytes", page.display(), text.len());
    for section in sections {
        assert!(text.contains(&format!("<section id=\"{section}\">")), "no section {section}");
    }
    let mut drawn = 0;
    // On a machine that is busy a browser may give up before its scripts have run.
    for _ in 0..ATTEMPTS {
        let Some(Opened { dom, console }) = open(page) else { return };
        assert!(console.is_empty(), "{console:#?}");
        drawn = dom.matches("class=\"cartesianlayer\"").count();
        if drawn >= plots {
            return;
        }
    }
    panic!("{drawn} plots are drawn, {plots} expected at least");
}

const ATTEMPTS: usize = 3;
