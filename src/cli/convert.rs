//! `armtwin convert`: any recording into another format.

use std::path::PathBuf;

use serde::Serialize;

use super::outputs::Output;
use super::recordings::ReadArgs;
use super::save;
use super::twin::ArmArgs;
use crate::recording::{self, Delimiter, Provenance, WriteOptions};

/// Convert a recording of any supported format into another
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin convert Movement_No6 -o movement6.csv.gz
  armtwin convert log.csv --columns scenarios/columns/ur10e_shamilmamedov.toml -o rtde.csv
  armtwin convert rtde.csv -o for_the_official_client.csv --delimiter blank
  armtwin convert long.csv --from 20 --to 60 -o short.csv
  armtwin convert bag_folder --columns scenarios/columns/ros2_bag.toml -o run.parquet

Read: RTDE CSV, any CSV by a column map, folders with one log per signal, ROS 2 bags (.mcap, .db3,
folders of them), Parquet. Written: .csv, .csv.gz, .parquet, .mcap, .db3.")]
pub struct Args {
    /// File, bag, or folder with one log per signal
    recording: PathBuf,
    /// File to write: .csv, .csv.gz, .parquet, .mcap or .db3
    #[arg(short, long, value_name = "FILE")]
    out: Output,
    #[command(flatten)]
    read: ReadArgs,
    #[command(flatten)]
    arm: ArmArgs,
    /// What separates the columns of a CSV that is written
    #[arg(long, value_enum, default_value = "comma")]
    delimiter: Between,
    /// Write what was read and written as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

/// What `--json` writes.
#[derive(Serialize)]
struct Converted<'a> {
    #[serde(flatten)]
    from: &'a Provenance,
    out: String,
    samples: usize,
    /// s
    start: Option<f64>,
    end: Option<f64>,
    columns: Vec<&'a str>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Between {
    Comma,
    Blank,
    Tab,
}

impl From<Between> for Delimiter {
    fn from(between: Between) -> Self {
        match between {
            Between::Comma => Delimiter::Comma,
            Between::Blank => Delimiter::Blank,
            Between::Tab => Delimiter::Tab,
        }
    }
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    recording::writer(&args.out)?;
    let mut recording = args.read.read(&args.recording)?;
    if args.arm.given() {
        // Its weight tells what a bag's effort is; nothing else here depends on the arm.
        recording::settle_effort(&mut recording, &args.arm.load()?.twin.robot);
    }
    for note in &recording.provenance.notes {
        eprintln!("note: {note}");
    }
    let options = WriteOptions { delimiter: Some(args.delimiter.into()) };
    recording::write(&recording, &args.out, &options)?;
    let (rows, columns) = (recording.time.len(), recording.channels.len() + 1);
    if let Some(path) = &args.json {
        let (start, end) = (recording.time.first().copied(), recording.time.last().copied());
        let columns = recording.channels.iter().map(|c| c.name.as_str()).collect();
        let (from, out) = (&recording.provenance, args.out.display().to_string());
        let converted = Converted { from, out, samples: rows, start, end, columns };
        save::json(path, "armtwin.conversion/1", &converted)?;
    }
    println!("{}: {rows} samples, {columns} columns", args.out.display());
    Ok(())
}
