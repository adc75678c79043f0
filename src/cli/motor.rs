//! `armtwin motor`: the DC-motor case study.

use std::path::PathBuf;

use anyhow::Context;
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::motor_archive::Folder;
use super::outputs::Output;
use super::{interrupt, save};
use crate::limits::read_settings;
use crate::motor::dependence::dependence;
use crate::motor::fit::Tick;
use crate::motor::model::{NAMES, position};
use crate::motor::render;
use crate::motor::report::{Method, ScenarioReport, run as identify};
use crate::motor::scenario::{Channel, SHIPPED, Scenario};
use crate::motor::series::series;
use crate::motor::study::{Archive, Study, study};
use crate::motor::study_text::{answer, grid};
use crate::report::html::motor_report;

/// The DC-motor case study: identify ten parameters from a simulated motor, and say which can be
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin motor                                      both shipped scenarios
  armtwin motor --measured omega,current             all ten parameters become identifiable
  armtwin motor --given R=1.5 --method nlse          so they do with one known
  armtwin motor scenarios/dc_motor_2.toml --json result.json --report result.html
  armtwin motor --study --measured omega,current     200 noises: what the tests are worth (minutes)")]
pub struct Args {
    /// A scenario file; without one both shipped scenarios
    scenario: Option<PathBuf>,
    /// Write everything as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    /// Write the tables as a Markdown fragment [default: not written]
    #[arg(long, value_name = "FILE")]
    markdown: Option<Output>,
    /// Write a report with pictures, for any browser [default: not written]
    #[arg(long, value_name = "FILE.html", conflicts_with = "study")]
    report: Option<Output>,
    /// How to search
    #[arg(long, value_delimiter = ',', default_value = "pso,nlse")]
    method: Vec<MethodName>,
    /// Signals that are measured [default: those of the scenario]
    #[arg(long, value_delimiter = ',')]
    measured: Vec<ChannelName>,
    /// A parameter that is known beforehand; may be repeated [default: those of the scenario]
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_given)]
    given: Vec<(usize, f64)>,
    /// Random seed for the noise and the searches
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Repeat over many noises and count what is kept and covered; Ctrl-C shows what is done
    #[arg(long)]
    study: bool,
    /// Noises of the study, from --seed on
    #[arg(long, default_value_t = 200, requires = "study")]
    seeds: u64,
    /// Noises that PSO searches as well (15 s each on one core)
    #[arg(long, default_value_t = 0, requires = "study")]
    pso_seeds: u64,
    /// Folder that keeps the study's searches, so that a stopped study goes on [default: none is kept]
    #[arg(long, value_name = "DIR", requires = "study")]
    keep: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum MethodName {
    Pso,
    Nlse,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum ChannelName {
    Omega,
    Current,
}

#[derive(Serialize)]
struct Document<'a> {
    seed: u64,
    scenarios: &'a [ScenarioReport],
    #[serde(skip_serializing_if = "<[Study]>::is_empty")]
    studies: &'a [Study],
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let scenarios = scenarios(args)?;
    if args.study {
        return run_studies(&scenarios, args);
    }
    let mut reports = Vec::new();
    for scenario in &scenarios {
        let report = one(scenario, args)?;
        println!("{}", render::text(&report));
        if !report.unidentifiable.is_empty() {
            println!("To identify all: --measured omega,current, or one of them by --given\n");
        }
        reports.push(report);
    }
    if let Some(path) = &args.report {
        let each = scenarios.iter().zip(&reports);
        let all = each.map(|(s, r)| series(s, r)).collect::<Result<Vec<_>, _>>()?;
        save::text(path, &motor_report(&reports, &all))?;
    }
    let text: String = reports.iter().map(render::markdown).collect();
    save_all(args, &text, &reports, &[])
}

fn run_studies(scenarios: &[Scenario], args: &Args) -> anyhow::Result<()> {
    let stop = interrupt::flag();
    let folder = args.keep.as_deref().map(Folder::open).transpose()?;
    let archive: &dyn Archive = folder.as_ref().map_or(&(), |f| f);
    let bar = ProgressBar::new(scenarios.len() as u64 * (args.seeds + args.pso_seeds));
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} noises, {eta} left") {
        bar.set_style(style);
    }
    let tick: Tick<'_> = &|| bar.inc(1);
    let mut studies = Vec::new();
    for scenario in scenarios {
        for (method, seeds) in [(Method::Nlse, args.seeds), (Method::Pso, args.pso_seeds)] {
            if seeds > 0 {
                studies.push(study(scenario, method, [args.seed, seeds], archive, &stop, tick)?);
            }
        }
    }
    bar.finish_and_clear();
    studies.retain(|s| s.seeds > 0);
    studies.iter().for_each(|s| println!("{}\n{}", grid(s).text(), answer(s)));
    let text: String =
        studies.iter().map(|s| format!("{}\n{}\n", grid(s).markdown(), answer(s))).collect();
    save_all(args, &text, &[], &studies)
}

fn save_all(
    args: &Args,
    markdown: &str,
    scenarios: &[ScenarioReport],
    studies: &[Study],
) -> anyhow::Result<()> {
    if let Some(path) = &args.markdown {
        save::text(path, markdown)?;
    }
    if let Some(path) = &args.json {
        let document = Document { seed: args.seed, scenarios, studies };
        save::json(path, "armtwin.motor/1", &document)?;
    }
    Ok(())
}

fn one(scenario: &Scenario, args: &Args) -> anyhow::Result<ScenarioReport> {
    let methods: Vec<Method> = args.method.iter().map(|m| m.method()).collect();
    let bar = progress(scenario, &methods);
    let tick: Tick<'_> = &|| bar.inc(1);
    let mut report = identify(scenario, &methods, args.seed, tick)?;
    if !report.unidentifiable.is_empty() {
        bar.set_message("bounds against errors");
        report.dependence = dependence(scenario, args.seed)?;
    }
    bar.finish_and_clear();
    Ok(report)
}

/// Counts simulations of the swarm and starts of the descent.
fn progress(scenario: &Scenario, methods: &[Method]) -> ProgressBar {
    let work = |m: &Method| match m {
        Method::Nlse => scenario.nlse.starts,
        Method::Pso => {
            let free = scenario.given.iter().filter(|g| g.is_none()).count();
            (scenario.pso.iterations + 1) * scenario.pso.particles_per_parameter * free
        }
    };
    let bar = ProgressBar::new(methods.iter().map(work).sum::<usize>() as u64);
    let style = "scenario {prefix} {wide_bar} {pos}/{len} simulations, {eta} left {msg}";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar.with_prefix(scenario.number.to_string())
}

fn scenarios(args: &Args) -> anyhow::Result<Vec<Scenario>> {
    let mut scenarios = match &args.scenario {
        Some(path) => {
            let text = read_settings(path).with_context(|| format!("{}", path.display()))?;
            vec![Scenario::parse(&text).with_context(|| format!("{}", path.display()))?]
        }
        None => SHIPPED.iter().map(|text| Scenario::parse(text)).collect::<Result<_, _>>()?,
    };
    for scenario in &mut scenarios {
        if !args.measured.is_empty() {
            scenario.measured = args.measured.iter().map(|c| c.channel()).collect();
        }
        for &(k, value) in &args.given {
            scenario.given[k] = Some(value);
        }
        scenario.check()?;
    }
    Ok(scenarios)
}

impl MethodName {
    fn method(self) -> Method {
        match self {
            Self::Pso => Method::Pso,
            Self::Nlse => Method::Nlse,
        }
    }
}

impl ChannelName {
    fn channel(self) -> Channel {
        match self {
            Self::Omega => Channel::Omega,
            Self::Current => Channel::Current,
        }
    }
}

fn parse_given(text: &str) -> Result<(usize, f64), String> {
    let (name, value) = text.split_once('=').ok_or("give NAME=VALUE, for example R=1.5")?;
    let k = position(name.trim())
        .ok_or_else(|| format!("unknown parameter {name}: known are {}", NAMES.join(", ")))?;
    let value = value.trim().parse().map_err(|_| format!("{value} is not a number"))?;
    Ok((k, value))
}
