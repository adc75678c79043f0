//! What was run, as a page.

use crate::run::Result;

/// Inputs per target that are the goal.
const GOAL: f64 = 1e7;

pub fn page(results: &[Result], seed: u64) -> String {
    let mut rows = String::new();
    for r in results {
        let rate = r.executions as f64 / r.seconds.max(1e-9);
        rows += &format!(
            "| {} | {} | {:.0} | {:.1} % | {} | {:.0} | {:.0} | {:.0} | {} | {:.1} h |\n",
            r.target,
            r.executions,
            rate,
            100.0 * r.read as f64 / r.executions.max(1) as f64,
            r.answers,
            r.slowest_ms,
            r.peak_mb,
            r.resident_mb,
            r.findings.len(),
            GOAL / rate / 3600.0,
        );
    }
    let executions: u64 = results.iter().map(|r| r.executions).sum();
    let seconds: f64 = results.iter().map(|r| r.seconds).sum();
    format!(
        "# Readers against damaged and invented files\n\n\
         Made by `cargo run --release --example fuzz -- --page docs/fuzzing.md` with a number of \
         executions or seconds (seed {seed}): {executions} inputs in {:.2} h on one core.\n\n\
         An input breaks a rule if a reader panics or dies, takes longer than 1 s, or asks for more than \
         512 MB. How inputs are made is said in `examples/fuzz/main.rs`; `.ci/run` runs all targets for \
         100 s. Read is the share of inputs that were taken for sound, answers how many different \
         messages came, asked for the largest memory that one input made a reader ask for, and resident \
         the largest of the whole process with its libraries. The last column is what ten million \
         inputs take at this rate.\n\n\
         | reader | inputs | per s | read | answers | slowest, ms | asked for, MB | resident, MB | broken \
         rules | 10^7 take |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n{rows}",
        seconds / 3600.0
    )
}
