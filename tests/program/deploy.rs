//! `deploy/`: shards on Slurm and Ray come to the same tables as a single run.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

use super::armtwin;

const STUDY: &str = r#"
title = "quick"
question = "identification"
[arm.motion]
duration_s = 8
[arm.effects.coulomb]
coulomb = 3
[[grid]]
seed = [1, 2, 3, 4]
snr_db = [20, "none"]
method = ["nlse"]
"#;

fn deploy(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("deploy").join(file)
}

/// The study's file and the tables of a single run.
fn single(folder: &Path) -> (PathBuf, Vec<u8>) {
    let (file, out) = (folder.join("study.toml"), folder.join("single"));
    fs::write(&file, STUDY).unwrap();
    let run = armtwin(&["study", file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    (file, fs::read(out.join("cells.parquet")).unwrap())
}

fn said(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|s| String::from_utf8_lossy(s));
    format!("{out}{err}")
}

#[test]
fn the_array_job_comes_to_the_same_tables() {
    let folder = TempDir::new().unwrap();
    let (file, expected) = single(folder.path());
    let out = folder.path().join("slurm");
    let program = env!("CARGO_BIN_EXE_armtwin");
    for task in ["1", "2", "3"] {
        let run = Command::new(deploy("slurm/study.sh"))
            .args([&file, &out])
            .envs([("ARMTWIN", program), ("SLURM_ARRAY_TASK_ID", task)])
            .envs([("SLURM_ARRAY_TASK_COUNT", "3"), ("SLURM_CPUS_PER_TASK", "2")])
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", said(&run));
    }
    let merge =
        Command::new(deploy("slurm/merge.sh")).arg(&out).env("ARMTWIN", program).output().unwrap();
    assert!(merge.status.success(), "{}", said(&merge));
    assert!(fs::read(out.join("cells.parquet")).unwrap() == expected);
    let gap = Command::new(deploy("slurm/study.sh"))
        .args([&file, &out])
        .envs([("SLURM_ARRAY_TASK_ID", "4"), ("SLURM_ARRAY_TASK_COUNT", "3")])
        .envs([("SLURM_ARRAY_TASK_MIN", "2"), ("SLURM_ARRAY_TASK_MAX", "4")])
        .output()
        .unwrap();
    assert_eq!(gap.status.code(), Some(2), "{}", said(&gap));
}

#[test]
fn shell_scripts_are_clean() {
    let scripts = [deploy("slurm/study.sh"), deploy("slurm/merge.sh")];
    match Command::new("shellcheck").args(&scripts).output() {
        Ok(run) => assert!(run.status.success(), "{}", said(&run)),
        Err(_) => eprintln!("skipped: no shellcheck"),
    }
}

/// `ARMTWIN_RAY_PYTHON` names a Python that has Ray.
#[test]
fn two_ray_nodes_come_to_the_same_tables() {
    let python = std::env::var("ARMTWIN_RAY_PYTHON").unwrap_or_else(|_| "python3".into());
    let has_ray = Command::new(&python).args(["-c", "import ray"]).output();
    if !has_ray.is_ok_and(|run| run.status.success()) {
        eprintln!("skipped: no Ray");
        return;
    }
    let folder = TempDir::new().unwrap();
    let (file, expected) = single(folder.path());
    let out = folder.path().join("ray");
    let run = Command::new(python)
        .arg(deploy("ray/check.py"))
        .arg(env!("CARGO_BIN_EXE_armtwin"))
        .args([&file, &out])
        .env("RAY_USAGE_STATS_ENABLED", "0")
        // Sockets of Ray's sessions need short paths; nodes keep shards in the temporary folder.
        .env("TMPDIR", folder.path())
        .env("RAY_TMPDIR", "/tmp")
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", said(&run));
    assert!(fs::read(out.join("cells.parquet")).unwrap() == expected);
}
