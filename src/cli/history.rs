//! `armtwin history`: what was watched, over days.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::outputs::Output;
use super::watch::{EVENTS, column};
use super::{out, save};
use crate::recording::{self, Recording};
use crate::report::html::{HistoryReport, history_report};
use crate::report::table;

/// Show what `armtwin watch --history DIR` saw, over days
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin history watched -o watched.html

Prints the gap of every joint day by day and what changed; with -o a page with plots for any browser. Files of
a watching that still runs, or was killed, are read as well.")]
pub struct Args {
    /// Folder that was given to `armtwin watch --history`
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// Page with plots (HTML) to write [default: not written]
    #[arg(short, long, value_name = "FILE")]
    out: Option<Output>,
    /// Write all rows and events as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let rows = read(&args.dir)?;
    let events = events(&args.dir)?;
    out::page(&page(&args.dir, &rows, &events));
    if let Some(path) = &args.out {
        let report =
            HistoryReport { answer: &answer(&rows, &events), rows: &rows, events: &events };
        save::text(path, &history_report(&report))?;
        println!("{}: with plots, for any browser", path.display());
    }
    if let Some(path) = &args.json {
        let columns: BTreeMap<&str, &Vec<f64>> =
            rows.channels.iter().map(|c| (c.name.as_str(), &c.values)).collect();
        let all =
            serde_json::json!({ "timestamp": &rows.time, "columns": columns, "events": events });
        save::json(path, "armtwin.history/1", &all)?;
    }
    Ok(())
}

/// All files of the folder, one behind the other in time.
fn read(dir: &Path) -> anyhow::Result<Recording> {
    let listed = std::fs::read_dir(dir).with_context(|| dir.display().to_string())?;
    let mut paths: Vec<PathBuf> = listed.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with("watch-") && (name.ends_with(".parquet") || name.ends_with(".part.csv"))
    });
    paths.sort();
    let mut all: Option<Recording> = None;
    for path in &paths {
        let part = recording::journaled(path)?;
        // A watching that has just begun.
        if part.time.is_empty() {
            continue;
        }
        match &mut all {
            None => all = Some(part),
            Some(all) => append(all, &part, path)?,
        }
    }
    all.with_context(|| {
        format!("{}: no file of `armtwin watch --history` is there yet", dir.display())
    })
}

/// What is later goes behind; of two that were watched at once the second adds what the first has not.
fn append(all: &mut Recording, part: &Recording, path: &Path) -> anyhow::Result<()> {
    let names = |r: &Recording| r.channels.iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    if names(all) != names(part) {
        bail!("{}: another arm was watched there; keep it in a folder of its own", path.display());
    }
    let last = all.time.last().copied().unwrap_or(f64::NEG_INFINITY);
    let from = part.time.iter().position(|t| *t > last).unwrap_or(part.time.len());
    all.time.extend(&part.time[from..]);
    for (channel, more) in all.channels.iter_mut().zip(&part.channels) {
        channel.values.extend(&more.values[from..]);
    }
    Ok(())
}

fn events(dir: &Path) -> anyhow::Result<Vec<serde_json::Value>> {
    let path = dir.join(EVENTS);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    // A line that is cut was being written when the power failed.
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

fn told(events: &[serde_json::Value]) -> impl Iterator<Item = &str> {
    let tells = |e: &&serde_json::Value| e["kind"] == "change" || e["kind"] == "answer";
    events.iter().filter(tells).filter_map(|e| e["says"].as_str())
}

fn answer(rows: &Recording, events: &[serde_json::Value]) -> String {
    let changes = events.iter().filter(|e| e["kind"] == "change").count();
    let hours = rows.time.len() as f64 / 60.0;
    let what = match changes {
        0 => "nothing changed".to_string(),
        1 => "1 change".to_string(),
        n => format!("{n} changes"),
    };
    let last = events.iter().rev().find(|e| e["kind"] == "answer").and_then(|e| e["says"].as_str());
    let last = last.map_or(String::new(), |says| format!(". The latest: {says}"));
    format!("{hours:.1} h were watched: {what}{last}")
}

fn page(dir: &Path, rows: &Recording, events: &[serde_json::Value]) -> String {
    let joints = (0..).take_while(|j| rows.channel(&column("gap_nm", *j)).is_some()).count();
    let mut days: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (k, time) in rows.time.iter().enumerate() {
        days.entry(crate::numbers::day(*time)).or_default().push(k);
    }
    let header: Vec<String> = (1..=joints).map(|j| format!("joint {j} ")).collect();
    let mut header: Vec<&str> = header.iter().map(String::as_str).collect();
    header.insert(0, "gap N.m rms (level)");
    let cell = |j: usize, ks: &[usize]| {
        let mean = |what: &str| {
            let values = rows.channel(&column(what, j)).unwrap_or(&[]);
            ks.iter().filter_map(|k| values.get(*k)).sum::<f64>() / ks.len() as f64
        };
        format!("{:.2} ({:.2})", mean("gap_nm"), mean("level_nm"))
    };
    let body = days.iter().map(|(day, ks)| {
        let cells = (0..joints).map(|j| cell(j, ks));
        std::iter::once(format!("{day}, {:.1} h", ks.len() as f64 / 60.0)).chain(cells).collect()
    });
    let changes: Vec<&str> = told(events).collect();
    let changes = if changes.is_empty() { "none".into() } else { changes.join("\n") };
    format!(
        "{}: {}\n\n{}\n\nWhat changed\n{changes}\n",
        dir.display(),
        answer(rows, events),
        table(&header, 1, body)
    )
}
