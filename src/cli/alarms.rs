//! `armtwin alarms`: how far one can rely on watching.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::anyhow;
use rayon::prelude::*;

use super::outputs::Output;
use super::{interrupt, progress, save};
use crate::effects::{self, Effect};
use crate::report::markdown_table;
use crate::simulation::Scenario;
use crate::studies::StudyError;
use crate::studies::alarms::{Base, Noticed, PASSES, Quiet, Settings};

/// Measure how often watching gives a false alarm, how soon it notices a change, and whether it names it
#[derive(clap::Args)]
#[command(
    after_help = "Example: armtwin alarms scenarios/effects/{payload,load_friction}.toml -o docs/alarms.md

Every scenario is named after the effect it hides, which is switched on after a quarter of an hour, at its
scenario's strength and twice that. Hours without a change are of the first scenario without its effect."
)]
pub struct Args {
    /// Scenarios, one per effect, each with the effect's name (payload.toml)
    #[arg(required = true, value_name = "SCENARIO")]
    scenarios: Vec<PathBuf>,
    /// Work without a change, h
    #[arg(long, value_name = "H", default_value_t = Settings::default().hours)]
    hours: f64,
    /// Draws of noise per effect and strength
    #[arg(long, value_name = "N", default_value_t = Settings::default().draws)]
    draws: u64,
    /// Length of each of the two motions, s
    #[arg(long, value_name = "S", default_value_t = Settings::default().motion_s)]
    motion: f64,
    /// Markdown file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<Output>,
    /// The measurements as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let stop = interrupt::flag();
    let settings = Settings {
        hours: args.hours,
        draws: args.draws.max(1),
        motion_s: args.motion,
        ..Settings::default()
    };
    let going = || !stop.load(Ordering::Relaxed);
    let named = args.scenarios.iter().map(|f| named(f)).collect::<anyhow::Result<Vec<_>>>()?;
    let bases = bases(&named, &settings)?;
    let quiet = without_a_change(&bases[0].1, &settings, &going);
    let cases: Vec<(&Case, f64)> = named
        .iter()
        .flat_map(|case| settings.strengths.iter().map(move |strength| (case, *strength)))
        .collect();
    let bar = progress::counting("effects", cases.len() as u64);
    let measured = |((effect, scenario, file), strength): &(&Case, f64)| {
        if !going() {
            return Err(StudyError::Table("stopped".into()));
        }
        let without = without(*effect, scenario);
        let base = bases.iter().find(|(scenario, _)| *scenario == without).map(|(_, base)| base);
        let base = base.ok_or_else(|| StudyError::Table("an arm is missing".into()))?;
        let found = base.noticed(*effect, (scenario, file), *strength, &settings);
        bar.inc(1);
        found
    };
    let noticed: Vec<Noticed> = cases.par_iter().map(measured).collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    save::page(args.out.as_deref(), &page(&settings, &quiet, &noticed))?;
    if let Some(path) = &args.json {
        let all =
            serde_json::json!({ "settings": &settings, "quiet": &quiet, "noticed": &noticed });
        save::json(path, "armtwin.alarms/1", &all)?;
    }
    Ok(())
}

type Case = (&'static dyn Effect, Scenario, String);

fn named(file: &Path) -> anyhow::Result<Case> {
    let name = file.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
    let effect = effects::find(name).ok_or_else(|| {
        let known = effects::names();
        anyhow!("{}: no effect `{name}`; name the file after one of {known}", file.display())
    })?;
    Ok((effect, Scenario::load(file)?, file.display().to_string()))
}

fn without(effect: &dyn Effect, scenario: &Scenario) -> Scenario {
    let mut without = scenario.clone();
    without.effects.remove(effect.about().name);
    without
}

/// Every arm without its effect, once.
fn bases(named: &[Case], settings: &Settings) -> anyhow::Result<Vec<(Scenario, Base)>> {
    let mut bases: Vec<(Scenario, Base)> = Vec::new();
    for (effect, scenario, file) in named {
        let without = without(*effect, scenario);
        if bases.iter().all(|(scenario, _)| *scenario != without) {
            let base = Base::new(&without, file, settings)?;
            bases.push((without, base));
        }
    }
    Ok(bases)
}

fn without_a_change(
    base: &Base,
    settings: &Settings,
    going: &(dyn Fn() -> bool + Sync),
) -> Vec<Quiet> {
    let most = settings.hours * settings.every_h.len() as f64;
    let bar = progress::counting("hours", most as u64);
    let motions = AtomicU64::new(0);
    let watch = |_: f64| {
        let done = motions.fetch_add(1, Ordering::Relaxed);
        bar.set_position((done as f64 * settings.motion_s / 3600.0) as u64);
        going()
    };
    let found = base.quiet(settings, &watch);
    bar.finish_and_clear();
    found
}

fn page(settings: &Settings, quiet: &[Quiet], noticed: &[Noticed]) -> String {
    let Settings { motion_s, draws, before_s, wait_s, delays_every_h, .. } = settings;
    format!(
        "# Alarms\n\nPrinted by `armtwin alarms`, armtwin {}. How often `armtwin watch` says that something \
         changed where nothing did, how soon it says so where something did, and what it then names. The arm is \
         the simulated UR5 with dry and viscous friction and noise 30 dB below the currents (scenarios/effects); it \
         does two motions of {motion_s} s in turn, at 125 Hz. The twin's friction is fitted on another \
         motion.\n\nEvery motion is simulated once and seen through sensors and conditioning {PASSES} times, with \
         noise of position and velocity of their own; each time the arm does it again one of these is drawn and \
         fresh noise is added to the torque, sample by sample.\n\n## Without a change\n\n{}\n\nA chart advances \
         while its joint slides, so the time that is stated is time of motion. All limits saw the same \
         work.\n\n## Switched on\n\nAfter {:.0} minutes of work without it, an effect acts from one sample to the \
         next, at its scenario's strength (1) and twice that. Limit: one false alarm in {delays_every_h} h. Delays \
         are time on the arm's clock, of {draws} draws of noise; \"over noise\" is what the effect adds to the gap, \
         rms, at the joint where that is most. One minute before and one after are then diagnosed; `named first`: \
         the strongest cause is the effect that was switched on; `as its equal`: it is listed as looking the same \
         in these data.\n\n{}\n",
        env!("CARGO_PKG_VERSION"),
        quiet_table(quiet),
        before_s / 60.0,
        noticed_table(noticed, *wait_s),
    )
}

fn quiet_table(all: &[Quiet]) -> String {
    let header = ["stated: one in", "limit", "watched", "joints slide", "expected", "false alarms"];
    let row = |q: &Quiet| {
        vec![
            format!("{} h", q.stated_every_h),
            format!("{:.2}", q.limit),
            format!("{:.0} h", q.hours),
            format!("{:.0} %", 100.0 * q.sliding),
            format!("{:.1}", q.expected()),
            q.alarms.to_string(),
        ]
    };
    markdown_table(&header, 0, &all.iter().map(row).collect::<Vec<_>>())
}

fn noticed_table(all: &[Noticed], wait_s: f64) -> String {
    let header =
        ["effect", "strength", "over noise", "noticed", "median s", "longest s", "named", "says"];
    let row = |n: &Noticed| {
        let mut delays: Vec<f64> = n.delays_s.iter().flatten().copied().collect();
        delays.sort_by(f64::total_cmp);
        let shown = |d: Option<&f64>| d.map_or(format!("> {wait_s}"), |d| format!("{d:.0}"));
        vec![
            n.effect.clone(),
            n.strength.to_string(),
            format!("{:.2}", n.over_noise),
            format!("{} of {}", delays.len(), n.delays_s.len()),
            shown(delays.get(delays.len() / 2)),
            shown(delays.last()),
            n.verdict().into(),
            n.says.clone(),
        ]
    };
    markdown_table(&header, 1, &all.iter().map(row).collect::<Vec<_>>())
}
