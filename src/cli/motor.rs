//! `armtwin motor`: the DC-motor case study.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::files::write_whole;
use crate::motor::dependence::dependence;
use crate::motor::fit::Tick;
use crate::motor::model::{NAMES, position};
use crate::motor::render;
use crate::motor::report::{Method, ScenarioReport, run as identify};
use crate::motor::scenario::{Channel, SHIPPED, Scenario};

/// The DC-motor case study: identify ten parameters from a simulated motor, and say which can be
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin motor                                      both shipped scenarios
  armtwin motor --measured omega,current             all ten parameters become identifiable
  armtwin motor --given R=1.5 --method nlse          so they do with one known
  armtwin motor scenarios/dc_motor_2.toml --json result.json")]
pub struct Args {
    /// A scenario file; without one both shipped scenarios
    scenario: Option<PathBuf>,
    /// Write everything as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the tables as a Markdown fragment
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    /// How to search
    #[arg(long, value_delimiter = ',', default_value = "pso,nlse")]
    method: Vec<MethodName>,
    /// What is measured, instead of the scenario's list
    #[arg(long, value_delimiter = ',')]
    measured: Vec<ChannelName>,
    /// A parameter known beforehand; may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_given)]
    given: Vec<(usize, f64)>,
    /// Of the noise and the searches
    #[arg(long, default_value_t = 1)]
    seed: u64,
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
    schema: &'static str,
    version: &'static str,
    seed: u64,
    scenarios: &'a [ScenarioReport],
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut reports = Vec::new();
    for scenario in scenarios(args)? {
        let report = one(&scenario, args)?;
        println!("{}", render::text(&report));
        reports.push(report);
    }
    if let Some(path) = &args.markdown {
        let text: String = reports.iter().map(render::markdown).collect();
        save(path, &text)?;
    }
    if let Some(path) = &args.json {
        let document = Document {
            schema: "armtwin.motor/1",
            version: env!("CARGO_PKG_VERSION"),
            seed: args.seed,
            scenarios: &reports,
        };
        save(path, &(serde_json::to_string_pretty(&document)? + "\n"))?;
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
            let text = fs::read_to_string(path).with_context(|| format!("{}", path.display()))?;
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

fn save(path: &Path, text: &str) -> anyhow::Result<()> {
    write_whole(path, |out| out.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}
