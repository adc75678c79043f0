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

/// Runs the commands of a page in a folder of its own, in their order.
fn run(page: &str, least: usize) -> TempDir {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = TempDir::new().unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(root.join("scenarios"), folder.path().join("scenarios")).unwrap();
    let all = commands(&fs::read_to_string(root.join(page)).unwrap());
    assert!(all.len() >= least, "{all:?}");
    for command in all {
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
fn readme_commands_do_what_they_say() {
    let folder = run("README.md", 5);
    for file in ["friction/truth.json", "twin.toml", "diagnosis/report.html", "diagnosis/twin.toml"]
    {
        assert!(folder.path().join(file).is_file(), "{file} is missing");
    }
}

#[test]
fn the_readme_counts_all_effects() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let known = format!("{} are known", armtwin::effects::CATALOGUE.len());
    assert!(readme.contains(&known), "{known}");
}

#[test]
fn every_command_has_an_example_that_runs() {
    let folder = run("docs/commands.md", 15);
    for file in
        ["friction/truth.json", "twin.toml", "fit.csv.gz", "ur5.urdf", "links.urdf", "arm.xml"]
    {
        assert!(folder.path().join(file).is_file(), "{file} is missing");
    }
}
