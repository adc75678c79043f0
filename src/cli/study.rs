//! `armtwin study`: grids of cells, on one machine or many.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, bail};
use clap::Subcommand;
use indicatif::{ProgressBar, ProgressStyle};

use super::outputs::{self, Output};
use super::save;
use crate::report::html::study_report;
use crate::studies::StudyError;
use crate::studies::sweep::{self, Question, Ran, Shard, Store, Study, Table};

/// Robustness over noise, seeds, effects, strengths, motions: resumable, on one machine or many
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(after_help = "\
Examples: armtwin study scenarios/studies/identification.toml --out identification
          armtwin study scenarios/studies/identification.toml --out shard2 --shard 2/8
          armtwin study merge shard1 shard2 --out identification
          armtwin study report identification

Every finished cell is kept in OUT/parts; a study that was killed goes on where it was when the
same command is run again. When all cells are there: cells.parquet, timings.parquet, summary.md, the
plots, and both in one report.html for any browser. See docs/studies/README.md.")]
pub struct Args {
    /// Question, arm, grids (TOML)
    #[arg(required = true, value_name = "STUDY.toml")]
    study: Option<PathBuf>,
    /// Folder for the results
    #[arg(long, required = true, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Run only the K-th of N shares of the cells [default: all cells]
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Number of cells run at a time [default: one per core]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Run only this cell, counted from 0, alone in this process [default: all cells]
    #[arg(long, value_name = "CELL", conflicts_with_all = ["shard", "jobs"])]
    cell: Option<usize>,
    /// Write how many cells there are, were made now, and how fast, as JSON
    #[arg(long, value_name = "FILE", conflicts_with = "cell")]
    json: Option<Output>,
    #[command(subcommand)]
    after: Option<After>,
}

#[derive(Subcommand)]
enum After {
    /// Join the shards of a study; the tables are those of a single run, byte by byte
    #[command(after_help = "Example: armtwin study merge shard1 shard2 --out whole")]
    Merge {
        /// Folders of all shards
        #[arg(required = true, value_name = "DIR")]
        dirs: Vec<PathBuf>,
        /// Folder for the joined results
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        /// Write what is joined, and in which files, as JSON
        #[arg(long, value_name = "FILE")]
        json: Option<Output>,
    },
    /// Draw the plots and write the summary of a finished study again
    #[command(after_help = "Example: armtwin study report identification")]
    Report {
        /// Folder of a finished study
        #[arg(value_name = "DIR")]
        dir: PathBuf,
        /// Write what is summed up, and in which files, as JSON
        #[arg(long, value_name = "FILE")]
        json: Option<Output>,
    },
}

/// Files that every study writes, pictures apart; the tables come first.
const FILES: [&str; 4] = ["cells.parquet", "timings.parquet", "summary.md", "report.html"];

pub fn run(args: &Args) -> anyhow::Result<()> {
    match (&args.after, &args.study, &args.out) {
        (Some(After::Merge { dirs, out, json }), ..) => {
            outputs::ask_in(out, &FILES)?;
            finish(out, &sweep::merge(dirs, out)?, json.as_deref())
        }
        (Some(After::Report { dir, json }), ..) => {
            outputs::ask_in(dir, &FILES[2..])?;
            finish(dir, &sweep::tables(dir)?, json.as_deref())
        }
        (None, Some(file), Some(out)) => cells(args, file, out),
        _ => bail!("give a study and --out, or merge, or report"),
    }
}

fn cells(args: &Args, file: &Path, out: &Path) -> anyhow::Result<()> {
    let study = Study::load(file)?;
    let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
    if let Some(number) = args.cell {
        return alone(&study, &text, number, out);
    }
    outputs::ask_in(out, &FILES)?;
    let store = Store::open(out, &study, &text)?;
    let finished = store.finished()?;
    let mine = args.shard.unwrap_or(Shard { number: 1, of: 1 }).blocks(&study);
    let mine_count: usize = mine.iter().map(Vec::len).sum();
    let open = |block: Vec<usize>| -> Vec<usize> {
        block.into_iter().filter(|n| !finished.contains_key(n)).collect()
    };
    let todo: Vec<Vec<usize>> = mine.into_iter().map(open).filter(|b| !b.is_empty()).collect();
    let left: usize = todo.iter().map(Vec::len).sum();
    if !finished.is_empty() {
        println!("{}: {} of {mine_count} cells are there", out.display(), mine_count - left);
    }
    let ran = work(args, &study, &store, &todo, left)?;
    println!("{}", speed(&ran));
    let tables = store.join()?;
    let complete = finished.len() + ran.cells == study.cells();
    if let Some(path) = &args.json {
        let all = serde_json::json!({
            "study": file, "out": out, "cells": study.cells(), "kept": finished.len(),
            "complete": complete, "ran": ran,
        });
        save::json(path, "armtwin.study/1", &all)?;
    }
    match complete {
        true => report(out, &study, &tables).map(|_| ()),
        false => {
            println!("{}: this shard is done; join all with `armtwin study merge`", out.display());
            Ok(())
        }
    }
}

fn work(
    args: &Args,
    study: &Study,
    store: &Store,
    todo: &[Vec<usize>],
    left: usize,
) -> anyhow::Result<Ran> {
    let bar = progress(left);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let workers = args.jobs.unwrap_or(cores);
    let file = store.study_file();
    let process = |number: usize| in_process(&file, number);
    // Only a process of its own tells what a cell needs in memory.
    let process: Option<sweep::Alone<'_>> =
        if study.question == Question::Cost { Some(&process) } else { None };
    let ran = sweep::run(study, store, todo, workers, process, &|| bar.inc(1));
    let made = bar.position();
    bar.finish_and_clear();
    let kept = || format!("stopped; the {made} cells finished now and those before are kept");
    ran.with_context(kept)
}

/// `armtwin study STUDY --cell N` in the folder of `file`.
fn in_process(file: &Path, number: usize) -> Result<(), StudyError> {
    let wrong = |why: String| StudyError::Table(format!("cell {number}: {why}"));
    let program = std::env::current_exe().map_err(|e| wrong(e.to_string()))?;
    let out = file.parent().unwrap_or(Path::new("."));
    let done = Command::new(program)
        .arg("study")
        .arg(file)
        .arg("--out")
        .arg(out)
        .args(["--cell", &number.to_string()])
        .env("RAYON_NUM_THREADS", "1")
        .stdout(Stdio::null())
        .output()
        .map_err(|e| wrong(e.to_string()))?;
    match done.status.success() {
        true => Ok(()),
        false => Err(wrong(String::from_utf8_lossy(&done.stderr).trim().to_string())),
    }
}

fn alone(study: &Study, text: &str, number: usize, out: &Path) -> anyhow::Result<()> {
    if number >= study.cells() {
        bail!("--cell {number}: the study has cells 0 to {}", study.cells() - 1);
    }
    let store = Store::shared(out, study, text)?;
    let mut part = sweep::cell(study, number)?;
    part.spent.peak_bytes = peak_bytes();
    store.keep(number, &part)?;
    Ok(())
}

/// Largest resident set of this process; 0 where the system does not say.
fn peak_bytes() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = line.and_then(|l| l.split_whitespace().next()).and_then(|n| n.parse::<u64>().ok());
    1024 * kib.unwrap_or(0)
}

/// After `merge` and `report`.
fn finish(
    out: &Path,
    (study, tables): &(Study, [Table; 2]),
    json: Option<&Path>,
) -> anyhow::Result<()> {
    let files = report(out, study, tables)?;
    let Some(path) = json else { return Ok(()) };
    let all = serde_json::json!({
        "title": study.title, "out": out, "cells": study.cells(), "files": files,
    });
    save::json(path, "armtwin.study_report/1", &all)
}

/// Writes the page and its pictures; their names.
fn report(out: &Path, study: &Study, [cells, timings]: &[Table; 2]) -> anyhow::Result<Vec<String>> {
    let page = sweep::summarise(study, cells, timings);
    for figure in &page.figures {
        save::text(&out.join(&figure.file), &figure.svg()?)?;
    }
    save::text(&out.join("report.html"), &study_report(&page)?)?;
    save::text(&out.join("summary.md"), &page.text)?;
    let mut files = vec!["summary.md".to_string(), "report.html".into()];
    files.extend(page.figures.into_iter().map(|f| f.file));
    println!("{}: {}", out.display(), files.join(", "));
    Ok(files)
}

fn speed(ran: &Ran) -> String {
    if ran.cells == 0 {
        return "nothing was left to do".into();
    }
    format!(
        "{} cells in {:.1} s: {:.0} cells per hour, {:.1} simulated seconds per second ({:.0} \
         steps per second)",
        ran.cells,
        ran.seconds,
        3600.0 * ran.cells as f64 / ran.seconds,
        ran.simulated_seconds / ran.seconds,
        ran.steps as f64 / ran.seconds
    )
}

fn progress(cells: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("cell {pos} of {len} {wide_bar} {eta} left");
    ProgressBar::new(cells as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
