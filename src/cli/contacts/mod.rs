//! `armtwin contacts`: when something touched the arm, where, and how strongly.

mod arm;
mod page;
mod sensor;
mod validation;

use std::path::PathBuf;

use anyhow::Context;

use self::arm::{Arm, Source};
use super::conditioning::ConditioningArgs;
use super::outputs::Output;
use super::progress::Progress;
use super::recordings::WorkArgs;
use super::save;
use super::twin::ArmArgs;
use crate::external_wrench::Criteria;

/// Estimate forces from outside: when something touched the arm, which link, how strongly
///
/// What the twin does not account for is held against forces of any shape on any link, at rest as in
/// motion. Values that the twin leaves open are fitted to the recording of --fit, or to this one.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin contacts pushed.csv --twin fitted.toml
  armtwin contacts pushed.csv --fit free.csv --twin twin.toml --with load_friction --json out.json
  armtwin contacts Movement_No10 --fit Movement_No6 --at-flange")]
pub struct Args {
    /// Recording to search: file, or folder with one log per signal
    #[arg(required_unless_present = "validate")]
    recording: Option<PathBuf>,
    /// A recording of the same arm without contacts; what the twin leaves open is fitted to it [default: the searched one]
    #[arg(long, value_name = "RECORDING")]
    fit: Option<PathBuf>,
    /// More recordings without contacts, which show what the twin leaves; may be repeated [default: none]
    #[arg(long, value_name = "RECORDING")]
    free: Vec<PathBuf>,
    #[command(flatten)]
    arm: ArmArgs,
    /// More effects to fit, by name [default: none]
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    with: Vec<String>,
    #[command(flatten)]
    work: WorkArgs,
    /// Column map of the recording of --fit [default: that of --columns]
    #[arg(long, value_name = "MAP.toml")]
    fit_columns: Option<PathBuf>,
    /// Look for forces at the flange only, for example on a tool
    #[arg(long)]
    at_flange: bool,
    /// Write the contacts, with their forces over time, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    /// Search the recordings of real arms in this folder, and hold what is found against what is known of
    /// them [default: RECORDING is searched]
    #[arg(long, value_name = "DIR", conflicts_with_all = ["recording", "fit", "free", "twin", "robot"])]
    validate: Option<PathBuf>,
    /// Markdown file for --validate to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<Output>,
    #[command(flatten)]
    conditioning: ConditioningArgs,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(folder) = &args.validate {
        return validation::run(folder, args.out.as_deref(), args.json.as_deref());
    }
    let path = args.recording.clone().context("give a recording")?;
    let given = args.arm.load()?;
    let read = |path: PathBuf, columns: Option<&PathBuf>| {
        let mut work = args.work.clone();
        work.read.columns = columns.cloned().or(work.read.columns);
        let signals = args.conditioning.options();
        let recording = work.read(&path, &given, signals, &Progress::default())?;
        anyhow::Ok(Source::of(path, recording.into_owned()))
    };
    let recording = read(path, None)?;
    let fit = args.fit.clone().map(|path| read(path, args.fit_columns.as_ref())).transpose()?;
    let how = args.conditioning.options().over(arm::conditioning());
    let progress = Progress::default();
    let fitted_on = fit.as_ref().unwrap_or(&recording);
    let arm = Arm::fitted(&given.twin, fitted_on, &args.with, &how, &progress)?;
    let free = args.free.iter().map(|path| read(path.clone(), None));
    let free: Vec<Source> = fit.into_iter().map(Ok).chain(free).collect::<anyhow::Result<_>>()?;
    let criteria = Criteria { at_flange: args.at_flange, ..Criteria::default() };
    let found = arm.contacts(&recording, &free, &criteria, &progress)?;
    progress.end();
    println!("{}", given.line());
    print!("{}", page::page(&found));
    if let Some(path) = &args.json {
        let all = serde_json::json!({ "criteria": &criteria, "contacts": &found });
        save::json(path, "armtwin.contacts/1", &all)?;
    }
    Ok(())
}
