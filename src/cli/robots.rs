//! `armtwin robots`: the built-in arms and servos.

use super::outputs::Output;
use super::save;
use crate::report::{paragraph, table};
use crate::robot::{BUILT_IN, Drive, servo, tables::Table};

/// List the built-in arms and position servos, and where their numbers come from
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin robots --json\n\n\
    Any other serial arm works from its URDF: robot = \"path/to/arm.urdf\" in a twin.")]
pub struct Args {
    /// Write the list as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

/// One line of the list; m, kg.
#[derive(serde::Serialize)]
struct Entry {
    name: &'static str,
    dof: usize,
    mass_kg: f64,
    reach_m: f64,
    /// Are gear ratio and torque constants built in too?
    drive: bool,
    source: &'static str,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let entries: Vec<Entry> = BUILT_IN.iter().map(|t| entry(t)).collect();
    let rows = entries.iter().map(|e| {
        vec![
            e.name.into(),
            if e.drive { "built in" } else { "give [drive]" }.into(),
            e.dof.to_string(),
            format!("{:.3}", e.mass_kg),
            format!("{:.2}", e.reach_m),
        ]
    });
    println!("{}", table(&["robot", "drive", "dof", "moving mass (kg)", "reach (m)"], 2, rows));
    println!("\nSources");
    for e in &entries {
        print!("{}", paragraph(&format!("  {:<16}", e.name), e.source));
    }
    println!("\nPosition servos, for the [servo] table of a twin or scenario");
    for kind in servo::KINDS {
        print!("{}", paragraph(&format!("  {:<16}", kind.name), kind.source));
    }
    args.json.as_ref().map_or(Ok(()), |path| save::document(path, &entries))
}

fn entry(table: &Table) -> Entry {
    let robot = table.robot();
    Entry {
        name: table.name,
        dof: robot.dof(),
        mass_kg: (robot.mass() * 1e6).round() / 1e6,
        reach_m: table.reach,
        drive: Drive::for_robot(table.name, robot.dof()).is_ok(),
        source: table.source,
    }
}
