//! `armtwin trial score`: the seals opened.

use std::path::PathBuf;

use anyhow::bail;

use super::named;
use crate::cli::outputs::Output;
use crate::cli::save;
use crate::trials::{Chapter, Seals, goals, page, score};

/// Open the seals and hold the answers against them
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin trial score cases answers --out trials.md

Several trials make several chapters: armtwin trial score cases answers nuisance nuisance_answers.
A sealed file that was changed after it was drawn is refused.")]
pub struct Args {
    /// Folders of cases and of their answers, in turn
    #[arg(required = true, num_args = 2.., value_name = "CASES ANSWERS")]
    folders: Vec<PathBuf>,
    /// Markdown file to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<Output>,
    /// Write every judgement as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    if !args.folders.len().is_multiple_of(2) {
        bail!("give a folder of answers for every folder of cases, in turn");
    }
    let mut chapters = Vec::new();
    for pair in args.folders.chunks(2) {
        let (cases, answers) = (&pair[0], &pair[1]);
        let made = Seals::load(cases)?.made;
        chapters.push(Chapter { title: named(cases), made, cases: score(cases, answers)? });
    }
    save::page(args.out.as_deref(), &page(&command(args), &chapters))?;
    if let Some(path) = &args.json {
        let trials: Vec<_> = chapters
            .iter()
            .map(|c| {
                serde_json::json!({
                    "trial": c.title, "made": c.made, "goals": goals(&c.cases), "cases": c.cases,
                })
            })
            .collect();
        save::json(path, "armtwin.score/1", &serde_json::json!({ "trials": trials }))?;
    }
    Ok(())
}

/// As it would be typed, folders by their names.
fn command(args: &Args) -> String {
    let folders: Vec<String> = args.folders.iter().map(|p| named(p)).collect();
    let out = args.out.as_ref().map_or(String::new(), |p| format!(" --out {}", named(p)));
    format!("armtwin trial score {}{out}", folders.join(" "))
}
