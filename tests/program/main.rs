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
mod rtde;
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

/// Into a pipe, whose lines have no end.
fn armtwin(arguments: &[&str]) -> Output {
    ran(Command::new(env!("CARGO_BIN_EXE_armtwin")).args(arguments).env_remove("COLUMNS"))
}

/// As on a terminal of so many letters across.
fn armtwin_across(columns: usize, arguments: &[&str]) -> Output {
    let columns = columns.to_string();
    ran(Command::new(env!("CARGO_BIN_EXE_armtwin")).args(arguments).env("COLUMNS", columns))
}

fn ran(command: &mut Command) -> Output {
    let program = command.output().unwrap();
    Output {
        code: program.status.code().unwrap_or(-1),
        stdout: String::from_utf8(program.stdout).unwrap(),
        stderr: String::from_utf8(program.stderr).unwrap(),
    }
}
