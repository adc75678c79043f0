//! Every `armtwin` command of the README, as written.

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

#[test]
fn readme_commands_do_what_they_say() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = TempDir::new().unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(root.join("scenarios"), folder.path().join("scenarios")).unwrap();
    let all = commands(&fs::read_to_string(root.join("README.md")).unwrap());
    assert!(all.len() >= 8, "{all:?}");
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
    for file in ["friction/truth.json", "twin.toml", "fit.csv.gz", "ur5.urdf"] {
        assert!(folder.path().join(file).is_file(), "{file} is missing");
    }
}
