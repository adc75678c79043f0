//! `armtwin trial draw`: cases with sealed labels.

use std::path::PathBuf;

use anyhow::bail;

use super::{on_threads, progress};
use crate::cli::save;
use crate::trials::{Draw, Names, draw, import};

/// Make cases with sealed labels, or take cases made elsewhere
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin trial draw --cases 420 --seed 1 --out cases
         armtwin trial draw --from practice --out cases

Writes cases/case-0000/{fit.csv.gz, check.csv.gz, twin.toml, settings.toml}, what is hidden into
cases/sealed/ and the SHA-256 of every sealed file into cases/seals.json. The same seed gives the
same cases.")]
pub struct Args {
    /// Folder for the cases; it must not hold a trial
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How many
    #[arg(long, value_name = "N", default_value_t = 420, conflicts_with = "from")]
    cases: usize,
    /// Of everything that is drawn
    #[arg(long, value_name = "S", default_value_t = 1, conflicts_with = "from")]
    seed: u64,
    /// Only these kinds (clean, single, pair, withheld, foreign, unseen) or effects
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', conflicts_with = "from")]
    only: Vec<String>,
    /// Link masses 5 % and centres 5 mm off, coloured noise, skewed channels
    #[arg(long, conflicts_with = "from")]
    nuisance: bool,
    /// Length of the fit and the check recording, s
    #[arg(long, value_name = "S", default_value_t = 48.0, conflicts_with = "from")]
    duration: f64,
    /// Cases at a time [default: one per core]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Take the labelled cases of this folder in place of simulating
    #[arg(long, value_name = "FOLDER")]
    from: Option<PathBuf>,
    /// TOML file with the names of files and effects in --from's folder
    #[arg(long, value_name = "FILE", requires = "from")]
    names: Option<PathBuf>,
    /// How well the answerer is told that link masses are known, relative [default: as drawn]
    #[arg(long, value_name = "SHARE")]
    mass_error: Option<f64>,
    /// How well it is told that their centres are known, m [default: as drawn]
    #[arg(long, value_name = "M")]
    centre_error: Option<f64>,
    /// Write how many cases were drawn, and how, as JSON; no labels
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let out = &args.out;
    if out.join("sealed").exists() {
        let out = out.display();
        bail!("{out} holds a trial or the rest of one; name another folder or remove it");
    }
    let mut how = Draw::new(args.cases, args.seed, args.nuisance);
    how.only.clone_from(&args.only);
    how.duration_s = args.duration;
    let told = &mut how.settings;
    told.mass_error = args.mass_error.unwrap_or(told.mass_error);
    told.centre_error_m = args.centre_error.unwrap_or(told.centre_error_m);
    let seals = match &args.from {
        Some(from) => {
            let names = args.names.as_deref().map(Names::load).transpose()?.unwrap_or_default();
            import(from, out, &names, &how.settings)?
        }
        None => {
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
