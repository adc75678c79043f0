//! `armtwin trial answer`: a diagnosis of every case.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use rayon::prelude::*;

use super::{on_threads, progress};
use crate::cli::outputs::{self, Output};
use crate::cli::save;
use crate::trials::{Answer, answer, case_folders, write_json};

/// Diagnose every case of a trial, each from its own folder alone
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin trial answer cases --out answers

Writes answers/case-0000.json and so on: the diagnosis, and what simpler rules say about the same
recordings. Answers that are there and were made from the same files are kept, so that an
interrupted run goes on where it was. The sealed folder is not read; it may be elsewhere.")]
pub struct Args {
    /// Folder with case-* folders
    cases: PathBuf,
    /// Folder for the answers
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Cases at a time [default: one per core]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Answer again what is answered already
    #[arg(long)]
    again: bool,
    /// Write which answers were kept and which failed as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let folders = case_folders(&args.cases)?;
    let out = &args.out;
    fs::create_dir_all(out).with_context(|| format!("cannot make {}", out.display()))?;
    let bar = progress(folders.len(), "case");
    let one = |folder: &PathBuf| -> anyhow::Result<Done> {
        let done = answered(folder, out, args.again)?;
        bar.inc(1);
        Ok(done)
    };
    let done: Vec<Done> =
        on_threads(args.jobs, || folders.par_iter().map(one).collect::<anyhow::Result<_>>())?;
    bar.finish_and_clear();
    if let Some(path) = &args.json {
        let all = serde_json::json!({ "cases": args.cases, "out": out, "answers": done });
        save::json(path, "armtwin.answers/1", &all)?;
    }
    let count = |which: fn(&Done) -> bool| done.iter().filter(|d| which(d)).count();
    let (kept, failed) = (count(|d| d.kept), count(|d| d.failed.is_some()));
    println!("{}: {} answers, {kept} of them kept, {failed} failed", out.display(), done.len());
    if let Some((case, why)) = done.iter().find_map(|d| Some((&d.case, d.failed.as_ref()?))) {
        println!("first failure: {case}: {why}");
    }
    match count(|d| d.unreadable) {
        0 => Ok(()),
        n => anyhow::bail!(
            "{n} of {} cases cannot be read; folders made elsewhere are taken by `armtwin trial draw --from`",
            done.len()
        ),
    }
}

#[derive(serde::Serialize)]
struct Done {
    case: String,
    kept: bool,
    failed: Option<String>,
    /// Failed for want of a readable case: not an answer.
    unreadable: bool,
}

fn answered(folder: &Path, out: &Path, again: bool) -> anyhow::Result<Done> {
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let file = out.join(format!("{name}.json"));
    if !again && Answer::kept(&file, folder).is_some() {
        return Ok(Done { case: name, kept: true, failed: None, unreadable: false });
    }
    outputs::ask_in(out, &[format!("{name}.json")])?;
    // One case that cannot be read is no reason to leave the others.
    let (failed, unreadable) = match answer(folder) {
        Ok(answer) => {
            write_json(&file, &answer)?;
            (answer.failed, false)
        }
        Err(why) => (Some(crate::cli::in_words(&why.into())), true),
    };
    Ok(Done { case: name, kept: false, failed, unreadable })
}
