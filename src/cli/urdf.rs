//! `armtwin urdf`: the URDF made from the tables.

use std::path::PathBuf;

use anyhow::Context;

use crate::files::write_whole;
use crate::robot::{self, urdf};

/// Write the URDF of a built-in arm, made from its DH and mass tables
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin urdf --robot ur5e -o ur5e.urdf\n\n\
    `armtwin robots` lists the built-in arms. Given a URDF file instead of a name, it is read, \
    checked, its fixed joints merged, and written in the same form.")]
pub struct Args {
    /// Built-in name, or a URDF file to check and normalise
    #[arg(long, default_value = "ur5", value_name = "NAME")]
    robot: String,
    /// Write here instead of standard output
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let text = urdf::write(&robot::load(&args.robot)?);
    let Some(out) = &args.out else {
        print!("{text}");
        return Ok(());
    };
    write_whole(out, |w| w.write_all(text.as_bytes()))
        .with_context(|| format!("{}: cannot write it; choose another -o FILE", out.display()))
}
