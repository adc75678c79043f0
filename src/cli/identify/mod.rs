//! `armtwin identify`: friction and what goes with it, with tests and intervals.

pub mod brief;
mod links;
mod print;
mod scale;
mod servos;

use std::ops::Deref;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use scale::LoadArgs;

use super::by::ByArgs;
use super::conditioning::ConditioningArgs;
use super::outputs::Output;
use super::progress::Progress;
use super::recordings::WorkArgs;
use super::save;
use super::twin::ArmArgs;
use crate::diagnosis::By;
use crate::identification::{IdentificationError, Method, Search};
use crate::recording::refuse_same;
use crate::robot::urdf::{self, Chain};
use crate::twin::Twin;
use crate::workflow::{INERTIA, Identified, Identify, Prepared};

/// Identify friction, rotor inertia and payload from a recording, with tests and intervals
///
/// Without --twin or --robot the arm is the UR5. Without --twin the terms are the paper's friction law (Eq. 1), rotor
/// inertia and current offset. With --twin the terms are the effects the twin lists and gives no
/// values for. --terms replaces, --with adds to either. Nonlinear parameters that the twin leaves
/// open are searched for first, as `diagnose` does; where an effect does not show it is left out.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin identify fit.csv --check check.csv --report report.html
  armtwin identify fit.csv --check check.csv --with payload --json out.json --save-twin fitted.toml
  armtwin identify log.csv --columns scenarios/columns/ur10e_shamilmamedov.toml \\
      --twin scenarios/twins/ur10e.toml --with paper,offset
  armtwin identify fit.csv --method nlse --with presliding,torque_ripple --guard 0.05
  armtwin identify fit.csv --method pso,nlse,mcmc
  armtwin identify fit.csv --check check.csv --method nlse --with inertia,load_friction \
      --save-urdf arm.urdf --save-twin arm.toml
  armtwin identify empty.csv --loaded loaded.csv --payload 2.805kg --save-twin scaled.toml
  armtwin identify fit.csv --method nlse --bounds stribeck_velocity=0.01:0.2")]
pub struct Args {
    /// Recording to fit: file, or folder with one log per signal; several where servos are simulated
    #[arg(value_name = "RECORDING", required = true)]
    recordings: Vec<PathBuf>,
    /// Another recording, which the fit is tested on but not fitted to (repeatable where servos are simulated) [default: none]
    #[arg(long, value_name = "RECORDING")]
    check: Vec<PathBuf>,
    #[command(flatten)]
    by: ByArgs,
    #[command(flatten)]
    arm: ArmArgs,
    /// Estimators, in the order they are printed: swarm, least squares, posterior by Markov chains
    #[arg(long, value_enum, value_delimiter = ',', default_value = "pso,nlse")]
    method: Vec<MethodArg>,
    #[command(flatten)]
    work: WorkArgs,
    /// Effects to fit, by name; `paper` is the friction law of Eq. 1 [default: see above]
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    terms: Vec<String>,
    /// More effects to fit, by name; `inertia` is the inertia of all links [default: none]
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    with: Vec<String>,
    /// Leave out, one by one, the terms that the data do not show, and fit the rest again
    #[arg(long)]
    reduce: bool,
    /// Bounds within which a parameter is searched at all joints; may be repeated [default: those of `armtwin effects`]
    #[arg(long, value_name = "NAME=MIN:MAX", value_parser = bound, allow_hyphen_values = true)]
    bounds: Vec<(String, [f64; 2])>,
    /// Random seed for the swarm and the Markov chains
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How the swarm's cost is computed: both give the same number, the first a thousand times faster
    #[arg(long, value_enum, default_value = "quadratic")]
    cost: CostArg,
    /// Write everything as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    /// Write a report with pictures, for any browser [default: not written]
    #[arg(long, value_name = "FILE.html")]
    report: Option<Output>,
    /// Write the twin with the fitted values, those of NLSE where it ran [default: not written]
    #[arg(long, value_name = "FILE")]
    save_twin: Option<Output>,
    /// With --with inertia: write the arm with the links that were found [default: not written]
    #[arg(long, value_name = "FILE.urdf")]
    save_urdf: Option<Output>,
    /// With --with inertia: mass of all moving links together, kg [default: not known]
    #[arg(long, value_name = "KG", allow_hyphen_values = true)]
    total_mass: Option<f64>,
    /// Print every table: tests, other intervals, searches, all methods
    #[arg(long)]
    full: bool,
    #[command(flatten)]
    load: LoadArgs,
    #[command(flatten)]
    conditioning: ConditioningArgs,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum MethodArg {
    Pso,
    Nlse,
    Mcmc,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum CostArg {
    /// Interpolated quadratic form
    Quadratic,
    /// The law at every sample
    Direct,
}

/// `NAME=MIN:MAX`
fn bound(text: &str) -> Result<(String, [f64; 2]), String> {
    let parse = || {
        let (name, range) = text.split_once('=')?;
        let (low, high) = range.split_once(':')?;
        Some((name.trim().to_string(), [low.trim().parse().ok()?, high.trim().parse().ok()?]))
    };
    let (name, [low, high]) =
        parse().ok_or("give NAME=MIN:MAX, for example stribeck_velocity=0.01:0.2")?;
    crate::regression::bounds::check(&name, low, high).map_err(|e| e.to_string())?;
    Ok((name, [low, high]))
}

/// All that stands in the outputs.
pub(super) struct Report<'a> {
    pub args: &'a Args,
    pub done: Identified,
}

impl Deref for Report<'_> {
    type Target = Identified;

    fn deref(&self) -> &Identified {
        &self.done
    }
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    args.check_inertia()?;
    let how = args.wanted();
    how.check()?;
    let mut arm = args.arm.load()?;
    arm.scaled = args.load.given().is_none();
    how.terms_for(&arm)?;
    let watch = Progress::default();
    let given = arm.clone();
    let read = |path: &Path| args.work.read(path, &given, args.conditioning.options(), &watch);
    let all = |paths: &[PathBuf]| paths.iter().map(|p| read(p)).collect::<anyhow::Result<Vec<_>>>();
    let (mut fit, mut check) = (all(&args.recordings)?, all(&args.check)?);
    let every: Vec<&Prepared<'_>> = fit.iter().chain(&check).collect();
    let by = how.method(&mut arm.twin, &every)?;
    if by == By::Simulation {
        servos::refuse_flags(args)?;
        let found = how.servos(&arm, fit, check, &watch)?;
        watch.end();
        return servos::run(args, &arm, &found);
    }
    let (fit, check) = (args.only(&mut fit)?, args.only(&mut check).ok());
    check.iter().try_for_each(|check| refuse_same(&fit, check)).context("--check")?;
    let loaded = args.load.given().map(|(path, load)| -> anyhow::Result<_> {
        let loaded: Prepared<'_> = read(path)?;
        refuse_same(&fit, &loaded).context("--loaded")?;
        Ok((loaded, load))
    });
    let done = how.on(&arm, fit, check, loaded.transpose()?, &watch)?;
    watch.end();
    let report = Report { args, done };
    println!("{}", arm.line());
    if args.full {
        print::print(&report)
    } else {
        brief::print(&report)
    }
    write(&report)
}

fn write(report: &Report<'_>) -> anyhow::Result<()> {
    let args = report.args;
    if let Some(path) = &args.json {
        save::document(path, &report.document())?;
    }
    if let Some(path) = &args.report {
        save::text(path, &report.html()?)?;
    }
    if let (Some(path), Some(body)) = (&args.save_urdf, &report.rigid_body) {
        save::text(path, &urdf::write(&body.found.twin.robot))?;
        println!("\nLinks: {}", path.display());
    }
    if let Some(path) = &args.save_twin {
        save_twin(report, path)?;
    }
    Ok(())
}

impl Args {
    /// The only recording.
    fn only<'a>(&self, recordings: &mut Vec<Prepared<'a>>) -> anyhow::Result<Prepared<'a>> {
        if recordings.len() > 1 {
            bail!(
                "{} recordings are named: give one, and one to --check; several at once are fitted where \
                 servos are simulated (--by simulation)",
                recordings.len()
            );
        }
        recordings.pop().context("name a recording")
    }

    /// What is asked for.
    fn wanted(&self) -> Identify {
        let methods = self.method.iter().map(|method| match method {
            MethodArg::Pso => Method::Pso,
            MethodArg::Nlse => Method::Nlse,
            MethodArg::Mcmc => Method::Mcmc,
        });
        let cost = match self.cost {
            CostArg::Quadratic => Search::Quadratic,
            CostArg::Direct => Search::Direct,
        };
        let wanted = Identify { bounds: self.bounds.clone(), ..Identify::default() };
        wanted
            .terms(self.terms.clone())
            .with(self.with.clone())
            .methods(methods)
            .cost(cost)
            .seed(self.seed)
            .reduce(self.reduce)
            .total_mass(self.total_mass)
            .by(self.by.asked())
            .reading(self.work.reading(self.conditioning.options()))
    }

    /// Where the links that are found go makes sense with them alone.
    fn check_inertia(&self) -> anyhow::Result<()> {
        let asked = self.wanted().asks_for_inertia();
        if !asked && (self.save_urdf.is_some() || self.total_mass.is_some()) {
            bail!("--save-urdf and --total-mass are of the links: add --with {INERTIA}");
        }
        if let Some(mass) = self.total_mass.filter(|m| !(*m > 0.0 && m.is_finite())) {
            bail!("--total-mass {mass}: give the mass of all moving links, kg");
        }
        if asked && self.save_twin.is_some() && self.save_urdf.is_none() {
            bail!("--save-twin with {INERTIA} refers to the links found: add --save-urdf FILE");
        }
        Ok(())
    }
}

fn save_twin(report: &Report<'_>, path: &Path) -> anyhow::Result<()> {
    let Some((fitted, method)) = fitted(report)? else { return Ok(()) };
    fitted.save(path)?;
    println!("\nTwin with the values of {method}: {}", path.display());
    Ok(())
}

/// The twin with the values found, and by which method; its links are those that are written beside it.
fn fitted<'a>(report: &'a Report<'_>) -> Result<Option<(Twin, &'a str)>, IdentificationError> {
    let found = report.fitted()?;
    let Some(urdf) = report.args.save_urdf.as_ref().filter(|_| report.rigid_body.is_some()) else {
        return Ok(found);
    };
    // The arm alone, as it is written there.
    let absolute = std::path::absolute(urdf).unwrap_or_else(|_| urdf.to_path_buf());
    Ok(found.map(|(mut twin, method)| {
        twin.source = absolute.display().to_string();
        let flange = twin.chain.flange.as_ref().map(|_| "tool0".to_string());
        (twin.chain, twin.notes) = (Chain { flange, ..Chain::default() }, Vec::new());
        (twin, method)
    }))
}
