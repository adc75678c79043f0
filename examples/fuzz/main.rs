//! Every reader against damaged and invented files: no panic, no second, no 512 MB.
//!
//! cargo run --release --example fuzz -- --seconds 100
//! cargo run --release --example fuzz -- --executions 10000000 --kept docs/fuzzing --page docs/fuzzing.md
//! cargo run --release --example fuzz -- mcap --executions 1000000 --seed 7
//!
//! Each target runs in a process of its own, so that what kills it is found as well. It mutates seeds (files
//! in the repository and generated ones) with words of the format, some formats inside their packing,
//! and keeps what is answered in a way that was not seen before. Inputs that break a rule are left in
//! target/fuzz-findings; each becomes a test in src/recording/hostile_tests.rs or beside its reader.

mod bytes;
mod kept;
mod make_lerobot;
mod make_mcap;
mod make_parquet;
mod make_sqlite;
mod memory;
mod page;
mod run;
mod targets;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;

#[global_allocator]
static MEMORY: memory::Counted = memory::Counted;

/// Feeds damaged and invented files to the readers
#[derive(Parser)]
struct Args {
    /// What to run [default: all]
    targets: Vec<String>,
    /// Inputs per target
    #[arg(long)]
    executions: Option<u64>,
    /// For all targets together
    #[arg(long)]
    seconds: Option<f64>,
    /// Random seed; with --kept that of the first part
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Keep what each target found in this folder, and do not run again what is kept there; without
    /// --executions and --seconds nothing is run
    #[arg(long, value_name = "FOLDER")]
    kept: Option<PathBuf>,
    /// Write what was found as a page
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Run one target in this process and print its result as JSON
    #[arg(long, hide = true)]
    alone: bool,
    /// Feed this file to the target, once
    #[arg(long, value_name = "FILE")]
    input: Option<PathBuf>,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let all = targets::all();
    let unknown = args.targets.iter().find(|name| !all.iter().any(|t| t.name == name.as_str()));
    if let Some(name) = unknown {
        let known: Vec<_> = all.iter().map(|t| t.name).collect();
        eprintln!("error: no target {name}; choose from {}", known.join(", "));
        return ExitCode::from(2);
    }
    let chosen = |t: &&targets::Target| {
        args.targets.is_empty() || args.targets.iter().any(|name| name == t.name)
    };
    let chosen: Vec<_> = all.iter().filter(chosen).collect();
    if let Some(file) = &args.input {
        return run::once(chosen[0], file);
    }
    if args.executions.is_none() && args.seconds.is_none() && args.kept.is_none() {
        eprintln!("error: say how long, with --seconds or --executions");
        return ExitCode::from(2);
    }
    let limit = limit(&args, chosen.len());
    if args.alone {
        run::alone(chosen[0], &limit, args.seed);
        return ExitCode::SUCCESS;
    }
    match all_of(&chosen, &limit, &args) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn limit(args: &Args, targets: usize) -> run::Limit {
    let nothing = args.executions.is_none() && args.seconds.is_none();
    run::Limit {
        executions: args.executions.unwrap_or(if nothing { 0 } else { u64::MAX }),
        seconds: args.seconds.map_or(f64::INFINITY, |s| s / targets as f64),
    }
}

/// Runs the targets and writes the page; whether no rule was broken.
fn all_of(targets: &[&targets::Target], limit: &run::Limit, args: &Args) -> std::io::Result<bool> {
    let mut results = Vec::new();
    for target in targets {
        results.push(match &args.kept {
            Some(folder) => kept::runs(folder, target, limit, args.seed)?,
            None => vec![run::in_a_process(target, limit, args.seed)],
        });
    }
    results.retain(|runs| !runs.is_empty());
    if let Some(path) = &args.page {
        std::fs::write(path, page::page(&results))?;
    }
    Ok(results.iter().flatten().all(run::Result::is_sound))
}
