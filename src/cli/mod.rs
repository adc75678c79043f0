//! The command line: one file per command, each with its `Args` and `run`.

#[macro_use]
mod out;

mod accuracy;
mod alarms;
mod by;
mod case_studies;
mod compare;
mod completions;
mod conditioning;
mod contacts;
mod convert;
mod demo;
mod detect;
mod diagnose;
mod effects;
mod excite;
mod export;
#[cfg(test)]
mod help_tests;
mod history;
mod identify;
mod inspect;
mod interrupt;
mod man;
mod map;
mod motor;
mod motor_archive;
mod outputs;
mod progress;
mod record;
mod recordings;
mod recovery;
mod robots;
mod save;
mod serve;
mod simulate;
mod source;
mod stream;
mod study;
mod trial;
mod twin;
mod urdf;
mod view;
mod watch;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

#[derive(Parser)]
#[command(name = "armtwin", version, about, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Write over files that armtwin did not write, or that were changed since; never over what it reads
    #[arg(long, global = true)]
    overwrite: bool,
}

#[derive(Subcommand)]
enum Command {
    Accuracy(accuracy::Args),
    Alarms(alarms::Args),
    CaseStudies(case_studies::Args),
    Compare(compare::Args),
    Completions(completions::Args),
    Contacts(contacts::Args),
    Convert(convert::Args),
    Demo(demo::Args),
    Detect(detect::Args),
    Diagnose(diagnose::Args),
    Effects(effects::Args),
    Excite(Box<excite::Args>),
    Export(export::Args),
    History(history::Args),
    Identify(identify::Args),
    Inspect(inspect::Args),
    Man(man::Args),
    Map(map::Args),
    Motor(motor::Args),
    Record(record::Args),
    Recovery(recovery::Args),
    Robots(robots::Args),
    Serve(serve::Args),
    Simulate(simulate::Args),
    Study(Box<study::Args>),
    Trial(trial::Args),
    Urdf(urdf::Args),
    Watch(Box<watch::Args>),
}

/// All commands and flags, as help, manual pages and completions show them.
fn command() -> clap::Command {
    outputs::with_json(Cli::command())
}

/// Runs the program: 0 done, 1 the work could not be done, 2 wrong usage.
pub fn main() -> ExitCode {
    main_of(std::env::args_os()).into()
}

/// Runs the program on a command line, its own name first; the exit code.
pub fn main_of(words: impl IntoIterator<Item = OsString>) -> u8 {
    let command = command();
    let matches = command.clone().get_matches_from(words);
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|wrong| wrong.exit());
    let asked = interrupt::listen().and_then(|()| outputs::ask(&command, &matches));
    match asked.and_then(|()| run(cli)) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("error: {}", in_words(&error));
            1
        }
    }
}

/// An error and its causes, but for those that the words before hold already.
pub fn in_words(error: &anyhow::Error) -> String {
    error.chain().map(ToString::to_string).fold(String::new(), |said, cause| match said.as_str() {
        "" => cause,
        _ if said.contains(&cause) => said,
        _ => format!("{said}: {cause}"),
    })
}

fn run(cli: Cli) -> anyhow::Result<()> {
    match cli.command {
        Command::Accuracy(args) => accuracy::run(&args),
        Command::Alarms(args) => alarms::run(&args),
        Command::CaseStudies(args) => case_studies::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Completions(args) => {
            completions::run(&args);
            Ok(())
        }
        Command::Contacts(args) => contacts::run(&args),
        Command::Convert(args) => convert::run(&args),
        Command::Demo(args) => demo::run(&args),
        Command::Detect(args) => detect::run(&args),
        Command::Diagnose(args) => diagnose::run(&args),
        Command::Effects(args) => effects::run(&args),
        Command::Excite(args) => excite::run(&args),
        Command::Export(args) => export::run(&args),
        Command::History(args) => history::run(&args),
        Command::Identify(args) => identify::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Man(args) => man::run(&args),
        Command::Map(args) => map::run(&args),
        Command::Motor(args) => motor::run(&args),
        Command::Record(args) => record::run(&args),
        Command::Recovery(args) => recovery::run(&args),
        Command::Robots(args) => robots::run(&args),
        Command::Serve(args) => serve::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Study(args) => study::run(&args),
        Command::Trial(args) => trial::run(&args),
        Command::Urdf(args) => urdf::run(&args),
        Command::Watch(args) => watch::run(&args),
    }
}
