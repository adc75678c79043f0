//! How a command reads a recording: which columns and which stretch, held against the arm before anything
//! is worked out from it, and thinned where it has more rows than that needs.

use std::path::{Path, PathBuf};

use anyhow::bail;

use super::twin::Arm;
use crate::plausibility::{self, Doubt};
use crate::recording::{self, FEWEST_SAMPLES, Recording};
use crate::signals::thin;

/// What every command that takes a recording takes with it.
#[derive(clap::Args, Clone, Default)]
pub struct ReadArgs {
    /// Column map (TOML) of a bag, or of a table without RTDE names; `armtwin map` drafts one [default: RTDE names]
    #[arg(long, value_name = "MAP.toml")]
    pub columns: Option<PathBuf>,
    /// Leave out all rows before this time, in seconds after the first row [default: 0]
    #[arg(long, value_name = "S", value_parser = seconds)]
    from: Option<f64>,
    /// Leave out all rows after this time, in seconds after the first row [default: the end]
    #[arg(long, value_name = "S", value_parser = seconds)]
    to: Option<f64>,
}

/// What commands that work something out from a recording take besides.
#[derive(clap::Args, Clone, Default)]
pub struct WorkArgs {
    #[command(flatten)]
    pub read: ReadArgs,
    /// Keep all rows of recordings faster than 125 Hz or longer than 300 000 rows
    #[arg(long)]
    every_row: bool,
    /// Go on although the recording contradicts its column names or the arm
    #[arg(long)]
    force: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches('s').trim().parse::<f64>().ok();
    number.filter(|s| s.is_finite() && *s >= 0.0).ok_or("give seconds, for example 12.5".into())
}

impl ReadArgs {
    /// The stretch that is asked for, unjudged.
    pub fn read(&self, path: &Path) -> anyhow::Result<Recording> {
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from >= to
        {
            bail!("--from {from} --to {to}: --to must be the later one");
        }
        let whole = recording::read(path, self.columns.as_deref())?;
        if self.from.is_none() && self.to.is_none() {
            return Ok(whole);
        }
        let part = whole.between(self.from, self.to);
        if part.time.len() < FEWEST_SAMPLES {
            let lasts = whole.time.last().unwrap_or(&0.0) - whole.time.first().unwrap_or(&0.0);
            bail!(
                "{}: {} samples lie between --from and --to, at least {FEWEST_SAMPLES} are needed; \
                 it lasts {lasts:.3} s",
                path.display(),
                part.time.len()
            );
        }
        Ok(part)
    }
}

impl WorkArgs {
    /// Reads a recording of `arm`; `floor_hz` is the least rate that will do.
    ///
    /// # Errors
    /// If it cannot be read, is of another number of joints, or contradicts itself or the arm and is
    /// not forced.
    pub fn read(&self, path: &Path, arm: &Arm, floor_hz: f64) -> anyhow::Result<Recording> {
        let mut recording = self.read.read(path)?;
        arm.settle(&mut recording)?;
        self.stop(path, arm.judge(&recording).doubts)?;
        if self.every_row {
            return Ok(recording);
        }
        let Some(thinned) = thin(&recording, floor_hz) else { return Ok(recording) };
        if let Some(note) = thinned.provenance.notes.last() {
            eprintln!("note: {}: {note}", path.display());
        }
        Ok(thinned)
    }

    fn stop(&self, path: &Path, doubts: Vec<Doubt>) -> anyhow::Result<()> {
        let words: Vec<String> = doubts.iter().map(words).collect();
        if self.force {
            words.iter().for_each(|w| eprintln!("warning: {}: {w}", path.display()));
            return Ok(());
        }
        match words.is_empty() {
            true => Ok(()),
            false => bail!(
                "{}: {}\n(--force goes on with it as it is; `armtwin inspect` shows more)",
                path.display(),
                words.join("\nand: ")
            ),
        }
    }
}

/// One sentence without its full stop.
pub fn words(doubt: &Doubt) -> String {
    let plausibility::Doubt { what, remedy } = doubt;
    if remedy.is_empty() { what.clone() } else { format!("{what}; {remedy}") }
}
