//! `armtwin detect`: how weak an effect may be and still be told from noise.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use super::outputs::{self, Output};
use super::save;
use crate::effects::{self, CATALOGUE, Effect};
use crate::report::markdown_table;
use crate::simulation::Scenario;
use crate::studies::detectability::{
    Detectability, Made, Quality, Settings, Strength, detectability,
};

/// Measure the weakest strength at which each effect is told from noise, and what it costs
#[derive(clap::Args)]
#[command(after_help = "\
Example: armtwin detect scenarios/effects/*.toml --keep detect -o docs/detectability.md

Every scenario is named after the effect it hides. With --keep, an interrupted measurement goes on
where it stopped.")]
pub struct Args {
    /// Scenarios, one per effect, each with the effect's name (stribeck.toml)
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Draws of noise per strength
    #[arg(long, value_name = "N", default_value_t = Settings::default().seeds)]
    seeds: u64,
    /// Length of both recordings, s
    #[arg(long, value_name = "S", default_value_t = Settings::default().duration_s)]
    duration: f64,
    /// Signal-to-noise ratio of the current, dB
    #[arg(long, value_name = "DB", default_value_t = Settings::default().snr_db)]
    snr: f64,
    /// Folder that keeps what is finished, so that a stopped measurement goes on [default: none is kept]
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
    /// Markdown file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<Output>,
    /// Write the measurements as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let settings = Settings {
        seeds: args.seeds,
        duration_s: args.duration,
        snr_db: args.snr,
        ..Settings::default()
    };
    let mut named =
        args.scenarios.iter().map(|f| effect_of(f)).collect::<anyhow::Result<Vec<_>>>()?;
    named.sort_by_key(|(e, _)| CATALOGUE.iter().position(|c| c.about().name == e.about().name));
    let bar = progress(named.len() as u64);
    let measured: Vec<Detectability> = named
        .into_par_iter()
        .map(|(effect, file)| measured(effect, file, &settings, args.keep.as_deref()))
        .inspect(|_| bar.inc(1))
        .collect::<anyhow::Result<_>>()?;
    bar.finish_and_clear();
    save::page(args.out.as_deref(), &page(&settings, &measured))?;
    if let Some(path) = &args.json {
        let all = serde_json::json!({ "settings": &settings, "effects": &measured });
        save::json(path, "armtwin.detectability/1", &all)?;
    }
    Ok(())
}

fn effect_of(file: &Path) -> anyhow::Result<(&'static dyn Effect, &Path)> {
    let name = file.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
    let effect = effects::find(name).ok_or_else(|| {
        anyhow!(
            "{}: no effect `{name}`; name the file after one of {}",
            file.display(),
            effects::names()
        )
    })?;
    Ok((effect, file))
}

/// From the folder of what is finished where the settings are the same, else measured.
fn measured(
    effect: &'static dyn Effect,
    file: &Path,
    settings: &Settings,
    keep: Option<&Path>,
) -> anyhow::Result<Detectability> {
    let name = format!("{}.json", effect.about().name);
    let kept = keep.map(|folder| folder.join(&name));
    let before = kept.as_ref().and_then(|path| fs::read_to_string(path).ok());
    let before = before.and_then(|text| serde_json::from_str::<Detectability>(&text).ok());
    let scenario = Scenario::load(file)?;
    let same = |b: &Detectability| b.of == Made::new(effect, &scenario, settings);
    if let Some(before) = before.filter(same) {
        return Ok(before);
    }
    keep.map_or(Ok(()), |folder| outputs::ask_in(folder, &[&name]))?;
    let found = detectability(effect, &scenario, &file.display().to_string(), settings)?;
    if let Some(path) = kept {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        save::document(&path, &found)?;
    }
    Ok(found)
}

fn progress(effects: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("effect {pos} of {len} {wide_bar} {eta} left");
    ProgressBar::new(effects).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn page(settings: &Settings, measured: &[Detectability]) -> String {
    let header = [
        "effect",
        "told from",
        "of its scenario",
        "RMS / noise there",
        "parameter error",
        "left, chi2/n",
        "left without it",
        "simulation, ms/s",
    ];
    let rows: Vec<Vec<String>> = measured.iter().map(row).collect();
    format!(
        "# How weak an effect may be\n\n\
         Made by `armtwin detect scenarios/effects/*.toml -o docs/detectability.md`, armtwin \
         {version}.\n\n\
         Each effect as `scenarios/effects/NAME.toml` hides it, at {snr} dB, in two recordings of \
         {duration} s. *Told from*: the weakest strength (in steps of the square root of two, all \
         its linear values alike) at which the fit with the effect predicts the second recording \
         better than the fit without it (without play, of slack teeth: they still give way) in at \
         least {share} % of {seeds} draws of the sensors' noise; the largest value of a joint, its share of the scenario's, and the effect's own \
         torque there over the current's noise, RMS at the joint where it is largest. *Parameter \
         error*: median at the scenario's values. *Left*: what the fits leave there of the second \
         recording, in variances of the noise per sample.\n\n\
         Friction is fitted along; nonlinear parameters (widths, windows, orders) are taken as \
         known, delays and lags as small. So these figures are what such recordings can give at \
         best. *Simulation*: wall clock per second simulated, on the machine that made this \
         page.\n\n{table}",
        version = env!("CARGO_PKG_VERSION"),
        snr = settings.snr_db,
        duration = settings.duration_s,
        share = 100.0 * settings.share,
        seeds = settings.seeds,
        table = markdown_table(&header, 1, &rows),
    )
}

fn row(found: &Detectability) -> Vec<String> {
    let nothing = || ["-", "-", "-"].map(String::from);
    let seen = match (found.seen.as_str(), &found.typical) {
        ("simulation", _) => "not from the recorded motion",
        (_, None) => "as noise",
        _ => "not up to 8 times",
    };
    let strength = match &found.detectable {
        Some(Strength { factor, value, unit, parameter, rms_over_noise }) => [
            format!("{} {unit} ({parameter})", digits(*value)),
            digits(*factor),
            digits(*rms_over_noise),
        ],
        None => [seen.to_string(), "-".into(), "-".into()],
    };
    let quality = match &found.typical {
        Some(Quality { parameter_error, left, left_without }) => {
            [format!("{} %", digits(100.0 * parameter_error)), digits(*left), digits(*left_without)]
        }
        None => nothing(),
    };
    let mut row = vec![found.effect.clone()];
    row.extend(strength);
    row.extend(quality);
    row.push(digits(found.cost_ms));
    row
}

/// Two significant digits.
fn digits(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let after = (1.0 - x.abs().log10().floor()).max(0.0) as usize;
    if after > 5 { format!("{x:.1e}") } else { format!("{x:.after$}") }
}
