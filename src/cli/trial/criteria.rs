//! `armtwin trial criteria`: what each criterion of a diagnosis matters.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use super::{named, on_threads, progress};
use crate::cli::outputs::Output;
use crate::cli::{interrupt, save};
use crate::trials::{CriteriaTrial, Row, Work, criteria_page};

/// Answer every case with each criterion a third down and up: how much does it matter?
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin trial criteria cases --out criteria --page criteria.md

Criteria are the numbers that decide what a diagnosis says; diagnosis.json lists them. Every case is
answered with them as they are and with each of them times 2/3 and 4/3, 15 answers to a case with
seven criteria, into criteria/base, criteria/least_nats-down and so on. Answers that are there and
belong to the same case, version and criteria are kept, so that an interrupted run goes on where it
was. Then the seals are opened and all answers scored.")]
pub struct Args {
    /// Folder with case-* folders and their sealed labels
    cases: PathBuf,
    /// Folder for the folders of answers
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Markdown file to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    page: Option<Output>,
    /// Cases at a time [default: one per core]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Answer the first N cases only [default: all]
    #[arg(long, value_name = "N")]
    limit: Option<NonZeroUsize>,
    /// Answer again what is answered already
    #[arg(long)]
    again: bool,
    /// Write every row, and which cases differ in it, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let trial = CriteriaTrial::open(&args.cases, args.limit.map(NonZeroUsize::get))?;
    let stop = interrupt::flag();
    let bar = progress(trial.answers(), "answer");
    let work =
        Work { again: args.again, go_on: &|| !stop.load(Ordering::Relaxed), tick: &|| bar.inc(1) };
    let (kept, rows) = on_threads(args.jobs, || {
        let kept = trial.answer(&args.out, &work)?;
        Ok((kept, trial.score(&args.out)?))
    })?;
    bar.finish_and_clear();
    write(args, &trial, kept, &rows)
}

fn write(args: &Args, trial: &CriteriaTrial, kept: usize, rows: &[Row]) -> anyhow::Result<()> {
    let page = criteria_page(&command(args), &trial.made, trial.cases(), rows);
    save::page(args.page.as_deref(), &page)?;
    if let Some(path) = &args.page {
        let (out, all) = (args.out.display(), trial.answers());
        println!("{out}: {all} answers, {kept} of them kept; {}", path.display());
    }
    if let Some(path) = &args.json {
        let all = serde_json::json!({
            "cases": args.cases, "out": args.out, "answers": trial.answers(), "kept": kept,
            "rows": rows,
        });
        save::json(path, "armtwin.criteria/1", &all)?;
    }
    Ok(())
}

/// As it would be typed, files by their names.
fn command(args: &Args) -> String {
    let limit = args.limit.map_or(String::new(), |n| format!(" --limit {n}"));
    let page = args.page.as_ref().map_or(String::new(), |p| format!(" --page {}", named(p)));
    let (cases, out) = (named(&args.cases), named(&args.out));
    format!("armtwin trial criteria {cases} --out {out}{page}{limit}")
}
