//! `armtwin trial draw`: cases with sealed labels.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::{on_threads, progress};
use crate::cli::outputs::Output;
use crate::cli::progress::Progress;
use crate::cli::recordings::take;
use crate::cli::save;
use crate::cli::twin::{Arm, ArmArgs};
use crate::diagnosis::Settings;
use crate::recording::{self, Recording};
use crate::trials::{Draw, DrawOn, Family, Names, Seals, Sources, draw, draw_on, import};
use crate::workflow::Reading;

/// Make cases with sealed labels, by simulation or on your own recordings, or take cases made elsewhere
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin trial draw --cases 420 --seed 1 --out cases
         armtwin trial draw --on monday.csv tuesday.csv --twin twin.toml --out cases
         armtwin trial draw --from practice --out cases

Writes cases/case-0000/{fit.csv.gz, check.csv.gz, twin.toml, settings.toml}, what is hidden into
cases/sealed/ and the SHA-256 of every sealed file into cases/seals.json. The same seed gives the
same cases.

With --on, known effects are grafted onto recordings of your own arm: what an effect asks of the
drive along the recorded motion is added to the recorded current or torque, so that noise, masses
and all else that the twin lacks are those of the arm. Every ordered pair of the recordings is a
case of its own as well, untouched. Strength: torque of the effect that the twin cannot fit away,
over what the twin leaves of the untouched recording. Of a part of a recording: cut it first, with
`armtwin convert --from S --to S`.")]
pub struct Args {
    /// Folder for the cases; it must not hold a trial
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Number of cases; with --on of those with a graft, besides the untouched pairs [default: 420; with --on
    /// every effect at every strength once]
    #[arg(long, value_name = "N", conflicts_with = "from")]
    cases: Option<usize>,
    /// Random seed for everything that is drawn
    #[arg(long, value_name = "S", default_value_t = 1, conflicts_with = "from")]
    seed: u64,
    /// Only these kinds (clean, single, pair, withheld, foreign, unseen; with --on untouched, grafted,
    /// grafted_foreign) or effects [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', conflicts_with = "from")]
    only: Vec<String>,
    /// Link masses 5 % and centres 5 mm off, coloured noise, skewed channels
    #[arg(long, conflicts_with_all = ["from", "on"])]
    nuisance: bool,
    /// A small arm of position servos: command and position are recorded, no torque
    #[arg(long, conflicts_with_all = ["from", "on", "nuisance"])]
    servos: bool,
    /// Length of the fit and the check recording, s
    #[arg(long, value_name = "S", default_value_t = 48.0, conflicts_with_all = ["from", "on"])]
    duration: f64,
    /// Cases at a time [default: one per core]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Recordings of one arm to graft effects onto; one alone is cut in halves [default: none]
    #[arg(long, value_name = "RECORDING", num_args = 1.., requires = "twin", conflicts_with = "from")]
    on: Vec<PathBuf>,
    /// Twin of the arm of --on's recordings; needed with --on
    #[arg(long, value_name = "FILE", requires = "on")]
    twin: Option<PathBuf>,
    /// Column map of --on's recordings [default: RTDE names]
    #[arg(long, value_name = "MAP", requires = "on")]
    columns: Option<PathBuf>,
    /// Go on although a recording of --on contradicts its column names or the arm
    #[arg(long, requires = "on")]
    force: bool,
    /// How strong --on's effects are, over what the twin leaves [default: .5,1,2,4]
    #[arg(long, value_name = "X,...", value_delimiter = ',', requires = "on")]
    strengths: Vec<f64>,
    /// Take the labelled cases of this folder [default: cases are simulated]
    #[arg(long, value_name = "FOLDER")]
    from: Option<PathBuf>,
    /// TOML file with the names of files and effects in --from's folder [default: armtwin's own names]
    #[arg(long, value_name = "FILE", requires = "from")]
    names: Option<PathBuf>,
    /// How well link masses are known, as the one who answers is told; a share [default: as drawn]
    #[arg(long, value_name = "SHARE")]
    mass_error: Option<f64>,
    /// How well the links' centres of mass are known, as the one who answers is told, m [default: as drawn]
    #[arg(long, value_name = "M")]
    centre_error: Option<f64>,
    /// Write how many cases were drawn, and how, as JSON; no labels
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let out = &args.out;
    if out.join("sealed").exists() {
        let out = out.display();
        bail!("{out} holds a trial or the rest of one; name another folder or remove it");
    }
    let seals = match (&args.from, args.twin.as_deref()) {
        (Some(from), _) => {
            let names = args.names.as_deref().map(Names::load).transpose()?.unwrap_or_default();
            import(from, out, &names, &args.simulated().settings)?
        }
        (None, Some(twin)) if !args.on.is_empty() => args.on_recordings(twin)?,
        _ => {
            let how = args.simulated();
            let bar = progress(how.cases, "drawing");
            let seals = on_threads(args.jobs, || Ok(draw(&how, out, &|| bar.inc(1))?))?;
            bar.finish_and_clear();
            seals
        }
    };
    let cases = seals.cases();
    if let Some(path) = &args.json {
        let all = serde_json::json!({ "out": out, "cases": cases, "made": seals.made });
        save::json(path, "armtwin.draw/1", &all)?;
    }
    println!("{}: {cases} cases, sealed", out.display());
    Ok(())
}

impl Args {
    fn simulated(&self) -> Draw {
        let family = match (self.nuisance, self.servos) {
            (true, _) => Family::Nuisance,
            (_, true) => Family::Servos,
            _ => Family::Standard,
        };
        let mut how = Draw::new(self.cases.unwrap_or(USUAL_CASES), self.seed, family);
        how.only.clone_from(&self.only);
        how.duration_s = self.duration;
        self.tell(&mut how.settings);
        how
    }

    fn on_recordings(&self, twin: &Path) -> anyhow::Result<Seals> {
        let usual = DrawOn::default();
        let mut how = DrawOn {
            cases: self.cases,
            seed: self.seed,
            only: self.only.clone(),
            strengths: match self.strengths.is_empty() {
                true => usual.strengths,
                false => self.strengths.clone(),
            },
            settings: usual.settings,
        };
        self.tell(&mut how.settings);
        let arm = ArmArgs::of_twin(twin).load()?;
        let sources = Sources::new(self.recordings(&arm)?).context("--on")?;
        let bar = progress(0, "drawing");
        let begin = |cases: usize| bar.set_length(cases as u64);
        let draw = || Ok(draw_on(&how, &arm.twin, &sources, &self.out, &begin, &|| bar.inc(1))?);
        let seals = on_threads(self.jobs, draw)?;
        bar.finish_and_clear();
        Ok(seals)
    }

    /// The recordings of --on, each held against the arm first, as every command does.
    fn recordings(&self, arm: &Arm) -> anyhow::Result<Vec<Recording>> {
        let bar = Progress::default();
        let how = Reading { force: self.force, ..Reading::default() };
        let one = |path: &PathBuf| {
            let recording = recording::read(path, self.columns.as_deref())?;
            Ok(take(&how, recording, arm, &bar)?.into_owned())
        };
        self.on.iter().map(one).collect()
    }

    /// What the answerer is told, where the user says.
    fn tell(&self, told: &mut Settings) {
        told.mass_error = self.mass_error.unwrap_or(told.mass_error);
        told.centre_error_m = self.centre_error.unwrap_or(told.centre_error_m);
    }
}

/// Simulated, where nothing is said.
const USUAL_CASES: usize = 420;
