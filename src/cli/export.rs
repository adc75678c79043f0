//! `armtwin export`: a twin as a model for another simulator.

use std::path::PathBuf;

use super::outputs::Output;
use super::save;
use crate::export::{Target, export};

/// Write a twin as a model for another simulator: URDF or MuJoCo's MJCF
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin export --twin diagnosis/twin.toml --format mjcf -o arm.xml
  armtwin export --twin twin.toml --format urdf -o arm.urdf

Links, payload, tilt of the base, dry and viscous friction, rotor inertia, springs, motor gains and
limits go where the format has a place for them. What it cannot hold stands in a comment at the top of
the file and is said on standard error. In MJCF the motors' control is the current in A. `armtwin urdf`
writes the arm of a name or URDF alone.")]
pub struct Args {
    /// The twin (TOML), for example the mended one of `diagnose`
    #[arg(long, value_name = "TWIN")]
    twin: PathBuf,
    /// What to write
    #[arg(long, value_enum)]
    format: Format,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<Output>,
    /// Write what the file cannot hold as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Format {
    Mjcf,
    Urdf,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let twin = super::twin::load(Some(&args.twin))?;
    let target = match args.format {
        Format::Mjcf => Target::Mjcf,
        Format::Urdf => Target::Urdf,
    };
    let exported = export(&twin, target, &args.twin.display().to_string());
    for left in &exported.left {
        eprintln!("note: not in the file: {left}");
    }
    save::page(args.out.as_deref(), &exported.text)?;
    if let Some(path) = &args.json {
        let all = serde_json::json!({
            "twin": args.twin, "format": target, "out": args.out, "left": exported.left,
        });
        save::json(path, "armtwin.export/1", &all)?;
    }
    Ok(())
}
