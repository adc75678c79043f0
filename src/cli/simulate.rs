//! `armtwin simulate`: ground truth from a scenario.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::outputs::{self, Output};
use super::progress::Progress;
use super::stream::{Deliveries, Link, StreamArgs};
use super::{out, save};
use crate::recording::{self, WriteOptions};
use crate::simulation::{Experiment, Glimpse, Run, Scenario, Truth};
use crate::workflow::move_along;

/// Simulate an arm with hidden effects: two recordings and the truth about them
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin simulate scenarios/ur5_friction.toml --out friction

Writes friction/fit.csv and friction/check.csv (RTDE names, two different motions, the same hidden
effects; other formats by --format) and friction/truth.json (every effect and value, noise,
settings, versions). The folder is made if need be; files of these three names in it are replaced
if armtwin wrote them, others left alone. Nothing is written before all of it is simulated. The same scenario and seed give
the same bytes.

  armtwin simulate scenarios/ur5_friction.toml --out friction --stream

shows the arm, its torques and its tracking errors in a viewer that is open (rerun), as they are
simulated.")]
pub struct Args {
    /// What to simulate (TOML; copy one from scenarios/)
    scenario: PathBuf,
    /// Folder for fit.csv, check.csv and truth.json
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Random seed for the sensors' noise [default: that of the scenario]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// File format of the two recordings
    #[arg(long, value_enum, default_value = "csv")]
    format: Written,
    /// Length of both motions, s [default: that of the scenario]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    duration: Option<f64>,
    #[command(flatten)]
    live: StreamArgs,
    /// Write which files were made, and how long the recordings are, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Written {
    Csv,
    #[value(name = "csv.gz")]
    CsvGz,
    Parquet,
    /// ROS 2 bag
    Mcap,
    /// ROS 2 bag, SQLite
    Db3,
}

impl Written {
    fn extension(self) -> &'static str {
        match self {
            Written::Csv => "csv",
            Written::CsvGz => "csv.gz",
            Written::Parquet => "parquet",
            Written::Mcap => "mcap",
            Written::Db3 => "db3",
        }
    }

    fn files(self) -> [String; 3] {
        FILES.map(|name| name.replace("csv", self.extension()))
    }
}

/// As a folder of recordings usually has them.
pub(super) const FILES: [&str; 3] = ["fit.csv", "check.csv", "truth.json"];

pub fn run(args: &Args) -> anyhow::Result<()> {
    outputs::ask_in(&args.out, &args.format.files())?;
    let mut scenario = Scenario::load(&args.scenario)?;
    scenario.seed = args.seed.unwrap_or(scenario.seed);
    if let Some(duration_s) = args.duration {
        scenario.shorten(duration_s);
    }
    let file = args.scenario.display().to_string();
    let made = scenario.work_out(&file)?;
    out::notes(&scenario.robot, &made.notes);
    let link = args.live.open()?;
    let ([fit, check], sent) = simulate(&made, link.as_ref()).with_context(|| file)?;
    let truth = Truth::new(&scenario, &made, &fit, &check);
    write_as(args.format, &args.out, &fit, &check, &truth)?;
    let (fit, check) = (fit.recording.time.len(), check.recording.time.len());
    let out = args.out.display();
    let e = args.format.extension();
    println!("{out}: fit.{e} ({fit} samples), check.{e} ({check} samples), truth.json");
    if let Some(path) = &args.json {
        let file = |name: String| args.out.join(name);
        let made = serde_json::json!({
            "scenario": args.scenario, "seed": scenario.seed, "rate_hz": scenario.rate_hz,
            "fit": { "file": file(format!("fit.{e}")), "samples": fit },
            "check": { "file": file(format!("check.{e}")), "samples": check },
            "truth": file("truth.json".into()),
        });
        save::json(path, "armtwin.simulation/1", &made)?;
    }
    sent.end(link)
}

/// Both recordings, shown through `link` while they are made.
pub(super) fn simulate(
    made: &Experiment,
    link: Option<&Link>,
) -> anyhow::Result<([Run; 2], Deliveries)> {
    let watch = Progress::interruptible();
    let follow = |which: usize| {
        let (name, _, command) = made.motions()[which];
        let title = format!("{name}, seed {}", made.seed);
        link.map(|link| link.follow(title, &made.setup.robot, command)).transpose()
    };
    let mut shown = [follow(0)?, follow(1)?];
    let see = shown
        .each_mut()
        .map(|shown| |now: &Glimpse<'_>| shown.iter_mut().for_each(|shown| shown.see(now)));
    let runs = move_along(made, &watch, see)?;
    watch.end();
    let mut sent = Deliveries::default();
    shown.into_iter().flatten().for_each(|shown| sent.push(shown.end()));
    Ok((runs, sent))
}

pub(super) fn write(out: &Path, fit: &Run, check: &Run, truth: &Truth<'_>) -> anyhow::Result<()> {
    write_as(Written::Csv, out, fit, check, truth)
}

fn write_as(
    format: Written,
    out: &Path,
    fit: &Run,
    check: &Run,
    truth: &Truth<'_>,
) -> anyhow::Result<()> {
    fs::create_dir_all(out).with_context(|| format!("cannot make {}", out.display()))?;
    let [fit_file, check_file, truth_file] = format.files().map(|name| out.join(name));
    for (file, run) in [(fit_file, fit), (check_file, check)] {
        recording::write(&run.recording, &file, &WriteOptions::default())?;
    }
    save::document(&truth_file, truth)
}
