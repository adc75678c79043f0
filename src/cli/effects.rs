//! `armtwin effects`: the catalogue.

use crate::effects::CATALOGUE;
use crate::report::table;

/// List the physical effects the twin can inject and explain
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin effects --json")]
pub struct Args {
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    if args.json {
        let all: Vec<_> = CATALOGUE.iter().map(|e| e.about()).collect();
        println!("{}", serde_json::to_string_pretty(&all)?);
        return Ok(());
    }
    let rows = CATALOGUE.iter().flat_map(|e| {
        let about = e.about();
        about.parameters.iter().map(|p| {
            vec![
                about.name.into(),
                p.name.into(),
                p.symbol.into(),
                p.unit.into(),
                format!("{} .. {}", p.min, p.max),
                format!("{}", p.typical),
            ]
        })
    });
    println!("{}", table(&["effect", "parameter", "symbol", "unit", "range", "typical"], 5, rows));
    Ok(())
}
