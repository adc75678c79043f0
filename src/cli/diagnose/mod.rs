//! `armtwin diagnose`: where the twin differs from the arm, which effect it lacks, how far that helps.

mod brief;
mod causes;
mod gap;
mod load;
mod output;
mod page;
mod position;
mod resimulate;
#[cfg(feature = "viewer")]
mod scene;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::bail;

use self::load::Recorded;
use super::by::{By, ByArgs};
use super::conditioning::ConditioningArgs;
use super::outputs::{self, Output};
use super::recordings::WorkArgs;
use super::twin::{Arm, ArmArgs};
use super::{out, progress, view};
use crate::diagnosis::{self, Diagnosis, Settings, Traces, mend};
use crate::effects;
use crate::recording::Recording;
use crate::series::JointSeries;
use crate::twin::Twin;

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
    /// Another recording, which decides [default: the second half of the first]
    #[arg(long, value_name = "RECORDING")]
    check: Option<PathBuf>,
    #[command(flatten)]
    arm: ArmArgs,
    #[command(flatten)]
    by: ByArgs,
    #[command(flatten)]
    work: WorkArgs,
    /// Folder for diagnosis.json, report.html, twin.rrd and twin.toml
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Open twin.rrd in the viewer
    #[arg(long, requires = "out")]
    view: bool,
    /// Effects to take out of the catalogue
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    without: Vec<String>,
    /// Random seed for the discrepancy's features and for bootstraps
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How well the twin's link masses are known, relative; 0: exactly [default: 0.05]
    #[arg(long, value_name = "SHARE")]
    mass_error: Option<f64>,
    /// How well their centres are known, m [default: 0.005]
    #[arg(long, value_name = "M")]
    centre_error: Option<f64>,
    /// Do not move the twin again in the simulation
    #[arg(long)]
    no_simulation: bool,
    /// Print every table: regimes, all candidates, what was set aside, notes
    #[arg(long)]
    full: bool,
    /// Write everything as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    #[command(flatten)]
    conditioning: ConditioningArgs,
}

pub(super) use self::output::{FILES, write, written};

/// Both recordings, conditioned as a diagnosis usually has them.
pub(super) fn conditioned(
    recordings: [Recording; 2],
    twin: &Twin,
) -> anyhow::Result<[Recorded; 2]> {
    load::condition(recordings, twin, &ConditioningArgs::default())
}

/// What was found, for people, on one screen.
pub(super) fn findings(done: &Diagnosed) -> String {
    brief::findings(&done.diagnosis)
}

/// A diagnosis and all that led to it.
pub(super) struct Diagnosed {
    pub twin: Twin,
    pub mended: Twin,
    pub settings: Settings,
    pub fit: Recorded,
    pub check: Recorded,
    pub diagnosis: Diagnosis,
    pub traces: Traces,
    /// Positions of the twin as given and of the mended one, moved again, rad.
    #[cfg_attr(not(feature = "viewer"), allow(dead_code))]
    pub simulated: Vec<JointSeries>,
    /// Wall-clock, s.
    pub seconds: f64,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let settings = args.settings()?;
    args.out.as_ref().map_or(Ok(()), |out| outputs::ask_in(out, &FILES))?;
    let mut arm = args.arm.load()?;
    let mut recordings = args.recordings(&arm)?;
    let by = args.by.choose(&mut arm.twin, &mut recordings.each_mut()[..])?;
    let recordings = load::condition(recordings, &arm.twin, &args.conditioning)?;
    let mut done = diagnose(arm.twin.clone(), recordings, settings, !args.no_simulation)?;
    let next = &mut done.diagnosis.next_experiment;
    *next = next.replace(diagnosis::TWIN, &args.arm.as_given());
    println!("{}", arm.line());
    if by == By::Simulation {
        println!("{}", by.line());
        out::page(&position::page(&done.diagnosis));
    }
    out::page(&if args.full { page::page(&done) } else { brief::page(&done) });
    if let Some(out) = &args.out {
        write(&done, out)?;
        println!("\n{}", written(out));
    }
    args.json.as_ref().map_or(Ok(()), |path| output::json(&done, path))?;
    match &args.out {
        Some(out) if args.view => view::open(&out.join("twin.rrd")),
        _ => Ok(()),
    }
}

/// Searches on the first recording, decides on the second, mends the twin and moves both twins
/// again.
pub(super) fn diagnose(
    twin: Twin,
    [fit, check]: [Recorded; 2],
    settings: Settings,
    simulate: bool,
) -> anyhow::Result<Diagnosed> {
    let clock = Instant::now();
    let spinner = progress::spinner("searching for what the twin lacks");
    let (found, traces) =
        diagnosis::diagnose_traced(&twin, &fit.samples, &check.samples, &settings)?;
    let mut mended = mend(&twin, &found.fitted, &found.changes());
    let mut diagnosis = found;
    let mut simulated = Vec::new();
    if simulate {
        spinner.set_message("moving the twin again in the simulation");
        simulated = resimulate::add(&mut diagnosis, &twin, &mended, [&fit, &check]);
        // Servos are fitted once more by simulation.
        mended = mend(&twin, &diagnosis.fitted, &diagnosis.changes());
    }
    spinner.finish_and_clear();
    let seconds = clock.elapsed().as_secs_f64();
    Ok(Diagnosed { twin, mended, settings, fit, check, diagnosis, traces, simulated, seconds })
}

impl Args {
    fn settings(&self) -> anyhow::Result<Settings> {
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
        Ok(Settings {
            without: self.without.clone(),
            seed: self.seed,
            mass_error: self.mass_error.unwrap_or(usual.mass_error),
            centre_error_m: self.centre_error.unwrap_or(usual.centre_error_m),
            criteria: usual.criteria,
        })
    }

    /// To search on and to decide on.
    fn recordings(&self, arm: &Arm) -> anyhow::Result<[Recording; 2]> {
        let read = |path: &Path| self.work.read(path, arm, self.conditioning.floor_hz());
        let Some(check) = &self.check else { return Ok(read(&self.fit)?.halves()) };
        load::refuse_same_file(&self.fit, check)?;
        let both = [read(&self.fit)?, read(check)?];
        load::refuse_same_samples(&both)?;
        Ok(both)
    }
}
