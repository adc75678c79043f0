//! `armtwin trial`: blind trials of the diagnosis.

mod answer;
mod criteria;
mod draw;
mod score;

use std::path::Path;

use clap::Subcommand;

/// Blind trials: draw cases with sealed labels, answer them, score the answers and what they hang on
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin trial draw --cases 420 --seed 1 --out cases
         armtwin trial answer cases --out answers
         armtwin trial score cases answers --out trials.md
         armtwin trial criteria cases --out criteria --page criteria.md")]
pub struct Args {
    #[command(subcommand)]
    step: Step,
}

#[derive(Subcommand)]
enum Step {
    Draw(Box<draw::Args>),
    Answer(answer::Args),
    Score(score::Args),
    Criteria(criteria::Args),
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    match &args.step {
        Step::Draw(args) => draw::run(args),
        Step::Answer(args) => answer::run(args),
        Step::Score(args) => score::run(args),
        Step::Criteria(args) => criteria::run(args),
    }
}

/// Runs `work` on `jobs` threads, all cores where not given.
fn on_threads<T: Send>(
    jobs: Option<usize>,
    work: impl FnOnce() -> anyhow::Result<T> + Send,
) -> anyhow::Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs.unwrap_or(0)).build()?;
    pool.install(work)
}

/// Counts cases; hides itself where standard error is not a terminal.
fn progress(cases: usize, doing: &'static str) -> indicatif::ProgressBar {
    let template = format!("{doing} {{pos}} of {{len}} {{wide_bar}} {{eta}} left");
    let style = indicatif::ProgressStyle::with_template(&template);
    let usual = |_| indicatif::ProgressStyle::default_bar();
    indicatif::ProgressBar::new(cases as u64).with_style(style.unwrap_or_else(usual))
}

/// A file or folder without where it is.
fn named(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
