//! Every `armtwin` command of the README and of `docs/commands.md`, as written.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// The `armtwin` lines of the shell blocks, without comments.
fn commands(markdown: &str) -> Vec<String> {
    let blocks = markdown.split("```").skip(1).step_by(2).filter(|b| b.starts_with("sh\n"));
    let lines = blocks.flat_map(str::lines).filter(|l| l.starts_with("armtwin "));
    lines.map(|l| l.split(" #").next().unwrap().trim().to_string()).collect()
}

/// Those of a page.
fn of(page: &str) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    commands(&fs::read_to_string(root.join(page)).unwrap())
}

/// Runs commands in a folder of its own, in their order.
fn run(commands: &[String]) -> TempDir {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = TempDir::new().unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(root.join("scenarios"), folder.path().join("scenarios")).unwrap();
    for command in commands {
        if command.starts_with("armtwin compare") && cfg!(not(feature = "viewer")) {
            continue;
        }
        let run = Command::new(env!("CARGO_BIN_EXE_armtwin"))
            .args(command.split_whitespace().skip(1))
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(run.status.success(), "{command}: {}", String::from_utf8_lossy(&run.stderr));
    }
    folder
}

#[test]
fn the_readme_counts_all_effects() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let known = format!("{} are known", armtwin::effects::CATALOGUE.len());
    assert!(readme.contains(&known), "{known}");
}

/// The README begins as the page does, so that its commands are run with those of the page.
#[test]
fn every_command_has_an_example_that_runs() {
    let [readme, all] = ["README.md", "docs/commands.md"].map(of);
    assert!(readme.len() >= 5 && all.len() >= 15, "{readme:?}, {all:?}");
    assert!(readme == all[..readme.len()], "{readme:?}, {all:?}");
    let folder = run(&all);
    for file in [
        "friction/truth.json",
        "twin.toml",
        "diagnosis/report.html",
        "diagnosis/twin.toml",
        "fit.csv.gz",
        "ur5.urdf",
        "links.urdf",
        "arm.xml",
    ] {
        assert!(folder.path().join(file).is_file(), "{file} is missing");
    }
}
