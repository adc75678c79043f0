//! `armtwin diagnose`: where the twin differs from the arm, which effect it lacks, how far that helps.

mod brief;
mod causes;
mod gap;
mod output;
mod page;
mod position;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::by::ByArgs;
use super::conditioning::ConditioningArgs;
use super::outputs::{self, Output};
use super::progress::Progress;
use super::recordings::WorkArgs;
use super::twin::ArmArgs;
use super::{out, save, view};
use crate::diagnosis::{self, By, Settings};
use crate::effects;
use crate::recording::refuse_same;
use crate::workflow::{Diagnose, Diagnosed};

/// Say where a twin differs from the arm, which effects it lacks, and how far adding them helps
///
/// The causes are searched on one recording and decided on another. What the twin lists without
/// values (its friction) is fitted along and is no gap.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin diagnose --fit fit.csv --check check.csv --twin scenarios/twins/ur5.toml --out diagnosis
  armtwin diagnose --fit diagnosed.csv --twin diagnosis/twin.toml
  armtwin diagnose --fit Movement_No6 --check Movement_No7 --twin scenarios/twins/ur5_paper.toml
  armtwin diagnose --fit fit.csv --check check.csv --without payload,link_inertia --json out.json

Writes DIR/diagnosis.json, DIR/report.html (the same with pictures, for any browser),
DIR/twin.rrd (the recorded arm beside both twins, for the viewer rerun) and DIR/twin.toml, the twin
with the causes and the fitted friction in it: held against the arm again, it shows what is left. Motion comes from the recorded command
plus the smoothed tracking error where a command is recorded, else from the measured position.")]
pub struct Args {
    /// Recording to search causes on: file, or folder with one log per signal
    #[arg(long, value_name = "RECORDING")]
    fit: PathBuf,
    /// Another recording, which decides what is a cause [default: the second half of --fit]
    #[arg(long, value_name = "RECORDING")]
    check: Option<PathBuf>,
    #[command(flatten)]
    arm: ArmArgs,
    #[command(flatten)]
    by: ByArgs,
    #[command(flatten)]
    work: WorkArgs,
    /// Folder for diagnosis.json, report.html, twin.rrd and twin.toml [default: no files]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Open twin.rrd in the viewer
    #[arg(long, requires = "out")]
    view: bool,
    /// Effects that are not looked for, by name, separated by commas [default: none]
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    without: Vec<String>,
    /// Random seed for the discrepancy's features and for bootstraps
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How well the twin's link masses and the scale of each joint's torque are known, as a share; 0: exactly [default: 0.05]
    #[arg(long, value_name = "SHARE")]
    mass_error: Option<f64>,
    /// How well the links' centres of mass are known, m [default: 0.005]
    #[arg(long, value_name = "M")]
    centre_error: Option<f64>,
    /// Skip the simulation that moves both twins again
    #[arg(long)]
    no_simulation: bool,
    /// Print every table: gaps by kind of motion, all candidates, what was set aside, notes
    #[arg(long)]
    full: bool,
    /// Write everything as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    #[command(flatten)]
    conditioning: ConditioningArgs,
}

pub(super) use self::output::{FILES, write, written};

/// What was found, for people, on one screen.
pub(super) fn findings(done: &Diagnosed) -> String {
    brief::findings(&done.diagnosis)
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let how = args.wanted()?;
    args.out.as_ref().map_or(Ok(()), |out| outputs::ask_in(out, &FILES))?;
    let arm = args.arm.load()?;
    let watch = Progress::default();
    let read = |path: &Path| args.work.read(path, &arm, args.conditioning.options(), &watch);
    let fit = read(&args.fit)?;
    let check = args.check.as_deref().map(read).transpose()?;
    check
        .iter()
        .try_for_each(|check| refuse_same(&fit, check))
        .context("--check (leave it out to keep the second half of --fit for that)")?;
    let mut done = how.on(&arm.twin, fit, check, &watch)?;
    watch.end();
    let next = &mut done.diagnosis.next_experiment;
    *next = next.replace(diagnosis::TWIN, &args.arm.as_given());
    println!("{}", arm.line());
    if done.diagnosis.by == By::Simulation {
        println!("{}", By::Simulation.line());
        out::page(&position::page(&done.diagnosis));
    }
    out::page(&if args.full { page::page(&done) } else { brief::page(&done) });
    if let Some(out) = &args.out {
        write(&done, out)?;
        println!("\n{}", written(out));
    }
    args.json.as_ref().map_or(Ok(()), |path| save::document(path, &done.document()))?;
    match &args.out {
        Some(out) if args.view => view::open(&out.join("twin.rrd")),
        _ => Ok(()),
    }
}

impl Args {
    /// What is asked for.
    fn wanted(&self) -> anyhow::Result<Diagnose> {
        if let Some(unknown) = self.without.iter().find(|name| effects::find(name).is_none()) {
            bail!("--without {unknown}: no such effect; choose from {}", effects::names());
        }
        let given = [("--mass-error", self.mass_error), ("--centre-error", self.centre_error)];
        for (flag, value) in given {
            if let Some(v) = value.filter(|v| !(0.0..=1.0).contains(v)) {
                bail!("{flag} {v}: give a number from 0 (known exactly) to 1");
            }
        }
        let usual = Settings::default();
        Ok(Diagnose::default()
            .without(self.without.clone())
            .seed(self.seed)
            .mass_error(self.mass_error.unwrap_or(usual.mass_error))
            .centre_error_m(self.centre_error.unwrap_or(usual.centre_error_m))
            .by(self.by.asked())
            .simulated(!self.no_simulation)
            .reading(self.work.reading(self.conditioning.options())))
    }
}
