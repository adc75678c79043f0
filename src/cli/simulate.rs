//! `armtwin simulate`: ground truth from a scenario.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};

use crate::files::write_whole;
use crate::recording::{self, WriteOptions};
use crate::simulation::{Command, Experiment, Run, Scenario, Simulation, Truth};

/// Simulate an arm with hidden effects: two recordings and the truth about them
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin simulate scenarios/ur5_friction.toml --out friction

Writes friction/fit.csv and friction/check.csv (RTDE names, two different motions, the same hidden
effects; other formats by --format) and friction/truth.json (every effect and value, noise, settings, versions). The folder is
made if need be; files of these three names in it are replaced, others left alone. Nothing is
written before all of it is simulated. The same scenario and seed give the same bytes.")]
pub struct Args {
    /// What to simulate (TOML; copy one from scenarios/)
    scenario: PathBuf,
    /// Folder for fit.csv, check.csv and truth.json
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Seed of the sensors' noise, in place of the scenario's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Of the two recordings
    #[arg(long, value_enum, default_value = "csv")]
    format: Written,
    /// Length of both motions in seconds, in place of the scenario's
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    duration: Option<f64>,
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
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    if args.out.exists() && !args.out.is_dir() {
        bail!("--out {}: is a file; name a folder", args.out.display());
    }
    let mut scenario = Scenario::load(&args.scenario)?;
    scenario.seed = args.seed.unwrap_or(scenario.seed);
    if let Some(duration_s) = args.duration {
        scenario.shorten(duration_s);
    }
    let file = args.scenario.display().to_string();
    let made = scenario.work_out(&file)?;
    let [fit, check] = simulate(&made).with_context(|| file)?;
    let truth = Truth::new(&scenario, &made, &fit, &check);
    write_as(args.format, &args.out, &fit, &check, &truth)
        .with_context(|| format!("cannot write into {}", args.out.display()))?;
    let (fit, check) = (fit.recording.time.len(), check.recording.time.len());
    let out = args.out.display();
    let e = args.format.extension();
    println!("{out}: fit.{e} ({fit} samples), check.{e} ({check} samples), truth.json");
    Ok(())
}

pub(super) fn simulate(made: &Experiment) -> anyhow::Result<[Run; 2]> {
    let stop = stop_on_interrupt()?;
    let mut simulation = Simulation::new(&made.setup)?;
    let bar = progress(made.fit.duration() + made.check.duration());
    let mut follow = |command: &dyn Command, number: u64| {
        let before = bar.position();
        simulation.run(command, made.seed, number, &mut |time_s| {
            bar.set_position(before + (time_s * 1000.0) as u64);
            !stop.load(Ordering::Relaxed)
        })
    };
    let runs = [follow(&made.fit, 0)?, follow(&made.check, 1)?];
    bar.finish_and_clear();
    Ok(runs)
}

/// In simulated time; hides itself where standard error is not a terminal.
fn progress(seconds: f64) -> ProgressBar {
    let bar = ProgressBar::new((seconds * 1000.0) as u64);
    let style = ProgressStyle::with_template("simulating {wide_bar} {percent} %, {eta} left");
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Raised by Ctrl-C, so that the work ends between two files and not within one.
fn stop_on_interrupt() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let raise = Arc::clone(&stop);
    ctrlc::set_handler(move || raise.store(true, Ordering::Relaxed))?;
    Ok(stop)
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
    fs::create_dir_all(out)?;
    for (name, run) in [("fit", fit), ("check", check)] {
        let file = out.join(format!("{name}.{}", format.extension()));
        recording::write(&run.recording, &file, &WriteOptions::default())?;
    }
    write_whole(&out.join("truth.json"), |file| {
        serde_json::to_writer_pretty(&mut *file, truth)?;
        writeln!(file)
    })?;
    Ok(())
}
