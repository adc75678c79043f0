//! Tests of the program as a user runs it, one file per command.

mod browser;
mod compare;
mod contacts;
mod demo;
mod deploy;
mod detect;
mod diagnose;
mod edges;
mod effects;
mod excite;
mod export;
mod guide;
mod identify;
mod json;
#[cfg(feature = "viewer")]
mod live;
mod located;
mod mcmc;
mod motor;
mod mujoco;
mod outputs;
#[cfg(feature = "viewer")]
mod picture;
mod readme;
mod real;
mod recording;
mod rigid_body;
mod robots;
mod round_trip;
mod servo;
mod shell;
mod simulate;
mod study;
mod trial;
mod trial_on_recordings;

use std::process::Command;

/// What a run of the program left behind.
struct Output {
    code: i32,
    stdout: String,
    stderr: String,
}

fn armtwin(arguments: &[&str]) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_armtwin")).args(arguments).output().unwrap();
    Output {
        code: program.status.code().unwrap_or(-1),
        stdout: String::from_utf8(program.stdout).unwrap(),
        stderr: String::from_utf8(program.stderr).unwrap(),
    }
}
