//! `armtwin case-studies`: the page that sets the paper's tables and figures beside ours.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::{Context, bail};
use indicatif::ProgressBar;

use super::motor_archive::Folder;
use super::outputs::{self, Output};
use super::save;
use crate::case_studies::boxes::{Boxed, boxed};
use crate::case_studies::figures::{self, Figure};
use crate::case_studies::motor::{self, Noises, Results, identify};
use crate::case_studies::motor_figures::of_motor;
use crate::case_studies::page::Page;
use crate::case_studies::ur5::{self, Study};
use crate::case_studies::versus::{Duel, duel};
use crate::identification::{Terms, assemble};
use crate::motor::scenario::SHIPPED;
use crate::motor::study::Archive;
use crate::recording;
use crate::simulation::{Scenario, Simulation};
use crate::twin::Twin;
#[cfg(feature = "viewer")]
use crate::viewer::Album;

/// Reproduce the paper's case studies: tables, figures, and does PSO beat NLSE?
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin case-studies --out docs

Writes docs/case-studies.md and docs/img/case-studies/*.svg; the DC motor's searches take minutes.
The existence question is asked by NLSE over 200 noises; --pso-seeds 200 asks PSO too, which takes
100 minutes of one core, and with --keep DIR may be stopped and taken up again. Columns of the real
UR5 need the recordings (--recordings, or ARMTWIN_SHARED, or ../shared).")]
pub struct Args {
    /// Folder for the page and its figures
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Folder with the UR5's movement folders [default: ARMTWIN_SHARED, else ../shared]
    #[arg(long, value_name = "DIR")]
    recordings: Option<PathBuf>,
    /// Ask PSO too whether the DC motor's terms exist, on so many noises (15 s each on one core)
    #[arg(long, value_name = "N", default_value_t = 0)]
    pso_seeds: u64,
    /// Folder that keeps the searches on noises, so that a stopped run goes on [default: none is kept]
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
    /// Leave the DC motor out, whose searches take most of the time
    #[arg(long, conflicts_with_all = ["pso_seeds", "keep"])]
    no_motor: bool,
    /// Write the figures for the viewer [default: not written]
    #[arg(long, value_name = "FILE.rrd")]
    rrd: Option<Output>,
    /// Random seed for the searches and chains
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Seeds and starts in the comparison of PSO with NLSE
    #[arg(long, value_name = "N", default_value_t = SEEDS, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Write every estimate, duel and study as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

const PAGE: &str = "case-studies.md";
const SEEDS: u64 = 50;
const NO_VIEWER: &str =
    "--rrd: this armtwin was built without the viewer; build it with its default features";
const SCENARIO: &str = "scenarios/ur5_paper.toml";
const FIT: &str = "Movement_No6_Acc_slow_Verify_Model";
const CHECK: &str = "Movement_No7_Acc_slow_Verify_Model_short";
const FOLDER: &str = "recordings/kkufieta-ur5_modeling_force_estimate";

pub fn run(args: &Args) -> anyhow::Result<()> {
    outputs::ask_in(&args.out, &[PAGE])?;
    if args.rrd.is_some() && cfg!(not(feature = "viewer")) {
        bail!("{NO_VIEWER}");
    }
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    bar.set_message("UR5 in simulation");
    let scenario = Scenario::parse(include_str!("../../scenarios/ur5_paper.toml"), SCENARIO)?;
    let made = scenario.work_out(SCENARIO)?;
    let synthetic = synthetic(&made, args.seed)?;
    bar.set_message("UR5 as recorded");
    let real = real(args)?;
    let studies = || std::iter::once(&synthetic).chain(&real);
    bar.set_message("PSO against NLSE");
    let mut duels = Vec::new();
    for study in studies() {
        duels.extend(duels_on(study, args.seeds)?);
    }
    let injected = ur5::injected(&made.setup);
    let tight = boxed_on(&synthetic, &injected, args.seeds)?;
    let motor = motor_results(args, &bar)?;
    bar.set_message("figures");
    let mut all: Vec<Figure> = Vec::new();
    if let Some(Results { reports, .. }) = &motor {
        for (scenario, report) in motor::scenarios()?.iter().zip(reports).take(SHIPPED.len()) {
            all.extend(of_motor(scenario, report)?);
        }
    }
    let robot = Twin::default().robot;
    studies().for_each(|study| all.extend(figures::of_arm(study, &robot)));
    let page = Page {
        command: command(args),
        injected,
        synthetic: &synthetic,
        real: real.as_ref(),
        duels,
        boxed: tight,
        figures: &all,
        motor,
    };
    if let Some(path) = &args.json {
        save::json(path, "armtwin.case_studies/1", &page.numbers())?;
    }
    let text = page.markdown();
    bar.finish_and_clear();
    write(&args.out, &text, &all)?;
    if let Some(path) = &args.rrd {
        show(path, &all)?;
    }
    println!(
        "{}: case-studies.md and {} figures in {}{}",
        args.out.display(),
        all.len(),
        figures::FOLDER,
        if real.is_some() { "" } else { "; without the real UR5, whose recordings are not there" }
    );
    Ok(())
}

fn synthetic(made: &crate::simulation::Experiment, seed: u64) -> anyhow::Result<Study> {
    let mut simulation = Simulation::new(&made.setup)?;
    let mut run = |command, number| simulation.run(command, made.seed, number, &mut |_| true);
    let (fit, check) = (run(&made.fit, 0)?.recording, run(&made.check, 1)?.recording);
    Ok(ur5::study("synthetic", &fit, &check, seed)?)
}

/// `None` where the recordings are not there and nobody said they were.
fn real(args: &Args) -> anyhow::Result<Option<Study>> {
    let shared = || std::env::var_os("ARMTWIN_SHARED").map_or("../shared".into(), PathBuf::from);
    let folder = args.recordings.clone().unwrap_or_else(|| shared().join(FOLDER));
    if args.recordings.is_none() && !folder.is_dir() {
        return Ok(None);
    }
    let read = |name: &str| -> anyhow::Result<recording::Recording> {
        let mut recording = recording::read(&folder.join(name), None)?;
        recording.provenance.source = name.into();
        Ok(recording)
    };
    Ok(Some(ur5::study("real", &read(FIT)?, &read(CHECK)?, args.seed)?))
}

/// The paper's law alone, and with what a real arm needs besides.
fn laws() -> anyhow::Result<[(&'static str, Terms); 2]> {
    Ok([
        ("Eq. 1 alone (6 parameters)", Terms::named(["paper"])?),
        ("Eq. 1, rotor inertia and offset (8 parameters)", Terms::usual()?),
    ])
}

fn duels_on(study: &Study, seeds: u64) -> anyhow::Result<Vec<(String, Vec<Duel>)>> {
    let twin = Twin::default();
    let on = |(law, terms): (&str, Terms)| -> anyhow::Result<(String, Vec<Duel>)> {
        let arm = assemble(&study.fit.samples, &twin, &terms, &Default::default())?;
        let joints = arm.joints.iter().filter(|j| j.samples() > 0);
        let duels = joints.map(|j| duel(j, seeds)).collect::<Result<_, _>>()?;
        Ok((format!("{law}, {} recording", study.name), duels))
    };
    laws()?.into_iter().map(on).collect()
}

/// In boxes around what was injected.
fn boxed_on(
    study: &Study,
    injected: &BTreeMap<&'static str, Vec<f64>>,
    seeds: u64,
) -> anyhow::Result<Vec<(String, Vec<Boxed>)>> {
    let on = |(law, terms): (&str, Terms)| -> anyhow::Result<(String, Vec<Boxed>)> {
        let arm = assemble(&study.fit.samples, &Twin::default(), &terms, &Default::default())?;
        Ok((law.into(), boxed(&arm.joints, injected, seeds)?))
    };
    laws()?.into_iter().map(on).collect()
}

/// `None` where it is left out.
fn motor_results(args: &Args, bar: &ProgressBar) -> anyhow::Result<Option<Results>> {
    if args.no_motor {
        return Ok(None);
    }
    let scenarios = motor::scenarios()?;
    let mut reports = Vec::new();
    for (n, scenario) in scenarios.iter().enumerate() {
        bar.set_message(format!("DC motor {} of {} (minutes)", n + 1, scenarios.len()));
        reports.push(identify(scenario, args.seed)?);
    }
    let folder = args.keep.as_deref().map(Folder::open).transpose()?;
    let archive: &dyn Archive = folder.as_ref().map_or(&(), |f| f);
    let noises = Noises::of(&scenarios, args.pso_seeds);
    let done = AtomicU64::new(0);
    let tick = || {
        let n = done.fetch_add(1, Ordering::Relaxed) + 1;
        bar.set_message(format!("DC motor, noise {n} of {}", noises.count()));
    };
    let studies = noises.run(args.seed, archive, &tick)?;
    Ok(Some(Results { reports, studies }))
}

fn command(args: &Args) -> String {
    let motor = match args {
        Args { no_motor: true, .. } => " --no-motor".into(),
        Args { pso_seeds: 0, .. } => String::new(),
        Args { pso_seeds, .. } => format!(" --pso-seeds {pso_seeds}"),
    };
    let seeds = match args.seeds {
        SEEDS => String::new(),
        other => format!(" --seeds {other}"),
    };
    format!("armtwin case-studies --out docs --seed {}{seeds}{motor}", args.seed)
}

fn write(out: &Path, page: &str, all: &[Figure]) -> anyhow::Result<()> {
    let folder = out.join(figures::FOLDER);
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for figure in all {
        save::text(&out.join(figure.file()), &figure.svg()?)?;
    }
    save::text(&out.join(PAGE), page)
}

#[cfg(feature = "viewer")]
fn show(path: &Path, figures: &[Figure]) -> anyhow::Result<()> {
    let album = Album { title: "case studies", figures };
    crate::viewer::write_rrd(&album, path)
        .with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(not(feature = "viewer"))]
fn show(_: &Path, _: &[Figure]) -> anyhow::Result<()> {
    bail!("{NO_VIEWER}")
}
