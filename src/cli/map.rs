//! `armtwin map`: the draft of a column map, and of a twin where the arm can be told.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::outputs::Output;
use super::{out, save};
use crate::plausibility::{judge_alone, likely_arms};
use crate::recording::{self, ColumnMap, Draft, Recording};

/// Draft a column map for a table nobody described, its guesses commented
///
/// Columns are told by their names where these speak, else by what the numbers say of each other; units
/// by sizes, and by velocity against position. Look through the draft: it says why for every guess.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin map log.txt
  armtwin map log.csv -o log.toml --save-twin arm.toml
  armtwin inspect log.csv --columns log.toml

Reads text (comma, blank, tab, semicolon; decimal commas; a preamble; .gz) and Parquet. A twin can be
drafted where joint torque is recorded, in motion, and its weight is that of a built-in arm.")]
pub struct Args {
    /// Text or Parquet file
    file: PathBuf,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "MAP.toml")]
    out: Option<Output>,
    /// Write a twin of the built-in arm whose weight the torque carries, if it is one [default: not written]
    #[arg(long, value_name = "TWIN.toml")]
    save_twin: Option<Output>,
    /// Write the draft and what was told as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let draft = recording::draft(&args.file)?;
    let map = ColumnMap::parse(&draft.map, "the draft")?;
    let recording = recording::read_by(&args.file, Some(&map));
    let arm = recording.as_ref().ok().and_then(|r| likely_arms(r).first().copied());
    let text =
        draft.map.clone() + &remarks(&draft, recording.as_ref().map_err(|e| e.to_string()), arm);
    match &args.out {
        Some(path) => {
            save::text(path, &text)?;
            println!("{}: {} joints, {}", path.display(), draft.joints, draft.stems.join(", "));
        }
        None => out::document(&text),
    }
    match (&args.save_twin, arm) {
        (Some(path), Some((name, slope))) => save_twin(path, name, slope)?,
        (Some(path), None) => {
            eprintln!(
                "note: {}: not written, no arm can be told: that takes joint torque in motion, of a \
                 built-in arm",
                path.display()
            );
        }
        (None, _) => {}
    }
    let all = serde_json::json!({
        "file": &args.file, "map": &text, "joints": draft.joints, "signals": &draft.stems,
        "robot": arm.map(|(name, _)| name),
    });
    args.json.as_ref().map_or(Ok(()), |path| save::json(path, "armtwin.map/1", &all))
}

/// What reading by the draft shows, as comments.
fn remarks(
    draft: &Draft,
    recording: Result<&Recording, String>,
    arm: Option<(&'static str, f64)>,
) -> String {
    let mut text = String::from("\n");
    // Writing to a String cannot fail.
    match recording {
        Err(why) => _ = writeln!(text, "# It cannot be read like this: {why}"),
        Ok(recording) => {
            let doubts = judge_alone(recording);
            doubts.iter().for_each(|d| _ = writeln!(text, "# Doubtful: {d}"));
        }
    }
    match arm {
        Some((name, slope)) => {
            _ = writeln!(
                text,
                "# The arm: the recorded torque is {slope:.2} times the weight of a {name} (--robot {name})."
            );
        }
        None if draft.stems.contains(&"actual_current") => {
            _ = writeln!(
                text,
                "# The arm: current does not tell it; name it, --robot NAME (`armtwin robots`) or --twin FILE."
            );
        }
        None => {}
    }
    text.trim_end().to_string() + "\n"
}

fn save_twin(path: &Path, name: &str, slope: f64) -> anyhow::Result<()> {
    let text = format!(
        "# Drafted by armtwin {}: the recorded torque is {slope:.2} times the weight of this arm.\n\
         robot = \"{name}\"\n\n\
         [drive]                      # joint torque is recorded, so any will do\n\
         gear_ratio = 1\n\
         torque_constant = 1\n\n\
         [twin]\n\
         effects = [\"coulomb\", \"viscous\"]\n",
        env!("CARGO_PKG_VERSION")
    );
    save::text(path, &text).with_context(|| format!("--save-twin {}", path.display()))?;
    println!("{}: a {name}", path.display());
    Ok(())
}
