//! How a command reads a recording: which columns and which stretch, held against the arm before anything
//! is worked out from it, and thinned where it has more rows than that needs.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};

use super::twin::Arm;
use crate::follow::Watch;
use crate::recording::{self, FEWEST_SAMPLES, Recording};
use crate::workflow::{Prepared, Reading, WorkflowError};

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
    pub fn read(
        &self,
        path: &Path,
        arm: &Arm,
        floor_hz: f64,
        watch: &dyn Watch,
    ) -> anyhow::Result<Prepared<'static>> {
        let recording = self.read.read(path)?;
        take(self.reading(), recording, arm, floor_hz, watch)
    }

    fn reading(&self) -> Reading {
        Reading { every_row: self.every_row, force: self.force }
    }
}

/// Holds a recording against `arm`, with a word on how to go on where it contradicts itself.
pub fn take(
    reading: Reading,
    recording: Recording,
    arm: &Arm,
    floor_hz: f64,
    watch: &dyn Watch,
) -> anyhow::Result<Prepared<'static>> {
    let taken = reading.take(Cow::Owned(recording), arm, floor_hz, watch);
    taken.map_err(|error| match error {
        WorkflowError::Doubted { .. } => {
            anyhow!("{error}\n(--force goes on with it as it is; `armtwin inspect` shows more)")
        }
        other => other.into(),
    })
}
