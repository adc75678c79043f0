//! `armtwin identify`: friction and what goes with it, with tests and intervals.

mod brief;
mod inertia;
mod json;
mod links;
mod page;
mod print;
mod scale;
mod simulated;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use inertia::Summary;
use scale::{LoadArgs, Scaled};

use super::by::{By, ByArgs};
use super::conditioning::ConditioningArgs;
use super::outputs::Output;
use super::recordings::WorkArgs;
use super::twin::{Arm, ArmArgs};
use super::{progress, save};
use crate::diagnosis;
use crate::identification::{
    self, ArmProblem, BoundsByName, Dropped, IdentificationError, Inertial, LinkFit, Located,
    Method, MethodResult, Search, Settings, Terms, assemble_around,
};
use crate::recording::Recording;
use crate::robot::urdf::{self, Chain};
use crate::signals::{Conditioning, Samples, condition};
use crate::twin::Twin;

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
    /// Another recording, which the fit is held against (repeatable where servos are simulated)
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
    /// What to fit, effects by name; `paper` is Eq. 1 (see `armtwin effects`)
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    terms: Vec<String>,
    /// What to fit besides; `inertia` are the inertial parameters of all links
    #[arg(long, value_delimiter = ',', value_name = "EFFECTS")]
    with: Vec<String>,
    /// Drop, one by one, the terms whose existence the robust test does not show, and fit the rest
    #[arg(long)]
    reduce: bool,
    /// Search bounds of a parameter, all joints (repeatable)
    #[arg(long, value_name = "NAME=MIN:MAX", value_parser = bound, allow_hyphen_values = true)]
    bounds: Vec<(String, [f64; 2])>,
    /// Seed of the swarm and of the Markov chains
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How the swarm's cost is evaluated: the same number, a thousand times apart in speed
    #[arg(long, value_enum, default_value = "quadratic")]
    cost: CostArg,
    /// Write everything as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    /// Write a report with pictures, for any browser
    #[arg(long, value_name = "FILE.html")]
    report: Option<Output>,
    /// Write the twin with the fitted values (NLSE's where both ran)
    #[arg(long, value_name = "FILE")]
    save_twin: Option<Output>,
    /// With inertia: write the arm with the links found
    #[arg(long, value_name = "FILE.urdf")]
    save_urdf: Option<Output>,
    /// With inertia: mass of all moving links where it is known, kg
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
    pub twin: &'a Twin,
    /// The twin with the nonlinear parameters that were searched for.
    pub around: &'a Twin,
    pub located: &'a [Located],
    pub terms: &'a Terms,
    pub settings: &'a Settings,
    pub conditioning: &'a Conditioning,
    pub fit: &'a Loaded,
    pub check: Option<&'a Loaded>,
    /// With `--reduce`, the terms that were taken out.
    pub dropped: Option<&'a [Dropped]>,
    pub results: &'a [MethodResult],
    /// With a loaded run.
    pub scaled: Option<&'a Scaled>,
    /// With a payload: how far links may be from the model's, as a share of a mass.
    pub links_spread: Option<f64>,
    /// With `inertia`.
    pub rigid_body: Option<&'a Summary>,
}

/// A recording and what became of it.
pub(super) struct Loaded {
    pub recording: Recording,
    pub samples: Samples,
    pub problem: ArmProblem,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    args.check_inertia()?;
    for check in &args.check {
        refuse_same_file(&args.recordings[0], check)?;
    }
    let mut arm = args.arm.load()?;
    if let Some(told) = args.told(&mut arm)? {
        return simulated::run(args, &arm, told);
    }
    arm.scaled = !args.load.is_given();
    let terms = args.terms(&arm.twin)?;
    let conditioning = args.conditioning.conditioning();
    let fit = args.read(&args.recordings[0], &arm, &conditioning)?;
    let scaled = args.scaled(&arm, &terms, &fit, &conditioning)?;
    scaled.iter().for_each(|s| arm.twin.clone_from(&s.twin));
    let read = |path: &Path| args.read(path, &arm, &conditioning);
    let fit = if scaled.is_some() { read(&args.recordings[0])? } else { fit };
    let check = args.check.first().map(|path| read(path)).transpose()?;
    let settings = args.settings();
    let twin = arm.twin.clone();
    let (around, located) = locate(&fit.1, &twin, &terms, &settings)?;
    let assembled = |read| args.assembled(read, &around, &terms, &located);
    let mut fit = assembled(fit)?;
    let mut check = check.map(assembled).transpose()?;
    if let Some(check) = &check {
        refuse_same_samples(&fit.recording, &check.recording)?;
    }
    let mut inertial = args.asks_for_inertia().then(|| Inertial::of(&around, &terms));
    if let Some(inertial) = &mut inertial {
        for Loaded { problem, samples, .. } in std::iter::once(&mut fit).chain(&mut check) {
            inertial.attach(problem, samples, &around)?;
        }
    }
    let dropped =
        if args.reduce { Some(reduce(&mut fit, check.as_mut(), &settings)?) } else { None };
    let joints = fit.problem.joints.len() * settings.methods.len();
    let bar = progress::counting("fitting joint", joints as u64);
    let against = check.as_ref().map(|c| &c.problem);
    let mut results =
        identification::identify_telling(&fit.problem, against, &settings, &|| bar.inc(1))?;
    bar.finish_and_clear();
    let link_fit = LinkFit {
        twin: &around,
        terms: &terms,
        located: &located,
        bounds: &args.bounds(),
        settings: &settings,
        total_mass: args.total_mass,
        fit: &fit.samples,
        check: check.as_ref().map(|c| &c.samples),
    };
    let body = |inertial: &Inertial| -> anyhow::Result<Summary> {
        let dropped = dropped.as_deref().unwrap_or_default();
        let found = link_fit.rigid_body(inertial, &fit.problem, &mut results, dropped)?;
        let recordings = [Some(&fit.recording), check.as_ref().map(|c| &c.recording)];
        Ok(inertia::summary(found, inertial, &around.robot, &results, recordings))
    };
    let rigid_body = inertial.as_ref().map(body).transpose()?;
    let (problem, samples) = (&fit.problem, &fit.samples);
    let links_spread =
        identification::payload_beside_links(problem, samples, &around, &terms, &mut results)?;
    let report = Report {
        args,
        twin: &twin,
        around: &around,
        located: &located,
        terms: &terms,
        settings: &settings,
        conditioning: &conditioning,
        fit: &fit,
        check: check.as_ref(),
        dropped: dropped.as_deref(),
        results: &results,
        scaled: scaled.as_ref(),
        links_spread,
        rigid_body: rigid_body.as_ref(),
    };
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
        json::write(report, path)?;
    }
    if let Some(path) = &args.report {
        page::write(report, path)?;
    }
    if let (Some(path), Some(body)) = (&args.save_urdf, report.rigid_body) {
        save::text(path, &urdf::write(&body.found.twin.robot))?;
        println!("\nLinks: {}", path.display());
    }
    if let Some(path) = &args.save_twin {
        save_twin(report, path)?;
    }
    Ok(())
}

impl Args {
    /// The first recording where position servos are to be simulated along it.
    fn told(&self, arm: &mut Arm) -> anyhow::Result<Option<Recording>> {
        let mut by = By::Torque;
        let mut told = None;
        if arm.twin.drive.servo.is_some() || self.by.forced() == Some(By::Simulation) {
            let floor_hz = self.conditioning.floor_hz();
            let mut first = self.work.read(&self.recordings[0], arm, floor_hz)?;
            by = self.by.choose(&mut arm.twin, &mut [&mut first])?;
            told = Some(first);
        }
        if by == By::Torque && self.recordings.len().max(self.check.len()) > 1 {
            bail!(
                "one recording is fitted, and one checked, where torque is recorded: name one of each"
            );
        }
        Ok(told.filter(|_| by == By::Simulation))
    }

    fn terms(&self, twin: &Twin) -> Result<Terms, IdentificationError> {
        let effects = |names: &[String]| -> Vec<String> {
            names.iter().filter(|name| *name != inertia::NAME).cloned().collect()
        };
        let (terms, with) = (effects(&self.terms), effects(&self.with));
        let more = with.iter().map(String::as_str);
        match (&terms[..], &self.arm.twin) {
            ([], None) => Terms::named(Terms::usual()?.names().into_iter().chain(more)),
            ([], Some(_)) => Terms::of_twin(twin, &with),
            (given, _) => Terms::named(given.iter().map(String::as_str).chain(more)),
        }
    }

    fn read(
        &self,
        path: &Path,
        arm: &Arm,
        how: &Conditioning,
    ) -> anyhow::Result<(Recording, Samples)> {
        let recording = self.work.read(path, arm, self.conditioning.floor_hz())?;
        let twin = &arm.twin;
        let name = || path.display().to_string();
        let samples =
            condition(&recording, &twin.drive, twin.robot.dof(), how).with_context(name)?;
        Ok((recording, samples))
    }

    fn assembled(
        &self,
        (recording, samples): (Recording, Samples),
        around: &Twin,
        terms: &Terms,
        located: &[Located],
    ) -> anyhow::Result<Loaded> {
        let problem = assemble_around(&samples, around, terms, &self.bounds(), located)
            .with_context(|| recording.provenance.source.clone())?;
        Ok(Loaded { recording, samples, problem })
    }

    fn bounds(&self) -> BoundsByName {
        self.bounds.iter().cloned().collect()
    }

    fn settings(&self) -> Settings {
        let mut methods: Vec<Method> = Vec::new();
        for method in &self.method {
            let method = match method {
                MethodArg::Pso => Method::Pso,
                MethodArg::Nlse => Method::Nlse,
                MethodArg::Mcmc => Method::Mcmc,
            };
            if !methods.contains(&method) {
                methods.push(method);
            }
        }
        let pso_cost = match self.cost {
            CostArg::Quadratic => Search::Quadratic,
            CostArg::Direct => Search::Direct,
        };
        Settings { methods, seed: self.seed, pso_cost, ..Settings::default() }
    }
}

/// The twin with nonlinear parameters of what is to be fitted, found as a diagnosis finds them.
fn locate(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    settings: &Settings,
) -> anyhow::Result<(Twin, Vec<Located>)> {
    let located = diagnosis::locate(samples, twin, terms)?;
    if located.is_empty() {
        return Ok((twin.clone(), located));
    }
    Ok(identification::settle(samples, twin, terms, located, &settings.nlse)?)
}

fn reduce(
    fit: &mut Loaded,
    check: Option<&mut Loaded>,
    settings: &Settings,
) -> Result<Vec<Dropped>, IdentificationError> {
    let check = check.map(|c| &mut c.problem);
    identification::reduce(&mut fit.problem, check, &settings.nlse)
}

fn refuse_same_file(fit: &Path, check: &Path) -> anyhow::Result<()> {
    if let (Ok(a), Ok(b)) = (fit.canonicalize(), check.canonicalize())
        && a == b
    {
        bail!(
            "--check {}: is the recording the fit is made on; a check needs another recording",
            check.display()
        );
    }
    Ok(())
}

fn refuse_same_samples(fit: &Recording, check: &Recording) -> anyhow::Result<()> {
    if fit.time == check.time && fit.channels == check.channels {
        bail!(
            "--check {}: holds the same samples as {}; a check needs another recording",
            check.provenance.source,
            fit.provenance.source
        );
    }
    Ok(())
}

fn save_twin(report: &Report<'_>, path: &Path) -> anyhow::Result<()> {
    let Some((fitted, method)) = fitted(report)? else { return Ok(()) };
    fitted.save(path)?;
    println!("\nTwin with the values of {method}: {}", path.display());
    Ok(())
}

/// Least squares where it was asked for, else what was asked for first.
fn preferred(results: &[MethodResult]) -> Option<&MethodResult> {
    results.iter().find(|r| r.method == Method::Nlse.name()).or(results.first())
}

/// The twin with the values found, and by which method.
fn fitted<'a>(report: &Report<'a>) -> Result<Option<(Twin, &'a str)>, IdentificationError> {
    if let Some(Summary { found, .. }) = report.rigid_body {
        let (problem, result) = (&found.problem, &found.fitted);
        let mut twin = identification::fitted_twin(&found.twin, report.terms, problem, result)?;
        if let Some(urdf) = &report.args.save_urdf {
            // The arm alone, as it is written there.
            twin.source = std::path::absolute(urdf)
                .unwrap_or_else(|_| urdf.to_path_buf())
                .display()
                .to_string();
            (twin.chain, twin.notes) = (Chain::default(), Vec::new());
        }
        return Ok(Some((twin, &found.fitted.method)));
    }
    let Some(result) = preferred(report.results) else { return Ok(None) };
    let fitted =
        identification::fitted_twin(report.around, report.terms, &report.fit.problem, result)?;
    Ok(Some((fitted, &result.method)))
}
