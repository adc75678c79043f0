//! `armtwin trial draw`: cases with sealed labels.

use std::path::PathBuf;

use anyhow::bail;

use crate::diagnosis::Settings;
use crate::trials::{Names, import};

/// Make cases with sealed labels, or take cases made elsewhere
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin trial draw --from practice --out cases")]
pub struct Args {
    /// Folder for the cases; it must not hold any
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Take the labelled cases of this folder in place of simulating
    #[arg(long, value_name = "FOLDER")]
    from: Option<PathBuf>,
    /// TOML file with the names of files and effects in --from's folder
    #[arg(long, value_name = "FILE", requires = "from")]
    names: Option<PathBuf>,
    /// How well the answerer is told that link masses are known, relative
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    mass_error: f64,
    /// How well it is told that their centres are known, m
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    centre_error: f64,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let out = &args.out;
    if out.join("seals.json").exists() {
        bail!("{} holds a trial already; name another folder or remove it", out.display());
    }
    let settings = Settings {
        mass_error: args.mass_error,
        centre_error_m: args.centre_error,
        ..Settings::default()
    };
    let Some(from) = &args.from else { bail!("give --from FOLDER") };
    let names = args.names.as_deref().map(Names::load).transpose()?.unwrap_or_default();
    let seals = import(from, out, &names, &settings)?;
    println!("{}: {} cases, sealed", out.display(), seals.sha256.len());
    Ok(())
}
