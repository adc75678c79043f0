//! What was run, as a page.

use crate::run::Result;

/// One row for each target, whose runs are at least one.
pub fn page(targets: &[Vec<Result>]) -> String {
    let rows: String = targets.iter().map(|runs| row(runs)).collect();
    let all = || targets.iter().flatten();
    let executions: u64 = all().map(|r| r.executions).sum();
    let seconds: f64 = all().map(|r| r.processor_s).sum();
    format!(
        "# Readers against damaged and invented files\n\n\
         `cargo run --release --example fuzz -- --executions 10000000 --kept docs/fuzzing` runs every \
         reader on ten million inputs, in parts with a seed each. It may be interrupted: parts that are \
         done are kept in `docs/fuzzing`, and the same command goes on from there. With \
         `--page docs/fuzzing.md` in place of `--executions 10000000` it prints this page of what is \
         kept: {executions} inputs, {:.2} h of one core.\n\n\
         An input breaks a rule if a reader panics or dies, takes longer than 1 s, or asks for more than \
         512 MB. An input that takes longer on the clock is tried once more, and then the second is one \
         of processor time: other work on the machine is nothing that a reader does. How inputs are made \
         is said in `examples/fuzz/main.rs`; `.ci/run` runs all targets for 100 s.\n\n\
         Each row says with which seeds, on which days and with which version of armtwin a reader ran. \
         Per s counts seconds of processor time; read is the share of inputs that were taken for sound, \
         answers how many different messages came (4000 are counted at most), asked for the largest \
         memory that one input made a reader ask for, and resident the largest of the whole process with \
         its libraries.\n\n\
         | reader | inputs | seeds | when | version | per s | read | answers | slowest, ms | asked for, MB \
         | resident, MB | broken rules |\n|---|---:|---|---|---|---:|---:|---:|---:|---:|---:|---:|\n{rows}",
        seconds / 3600.0
    )
}

fn row(runs: &[Result]) -> String {
    let executions: u64 = runs.iter().map(|r| r.executions).sum();
    let read: u64 = runs.iter().map(|r| r.read).sum();
    let seconds: f64 = runs.iter().map(|r| r.processor_s).sum();
    let most = |of: fn(&Result) -> f64| runs.iter().map(of).fold(0.0, f64::max);
    format!(
        "| {} | {executions} | {} | {} | {} | {:.0} | {:.1} % | {:.0} | {:.0} | {:.0} | {:.0} | {} |\n",
        runs[0].target,
        span(runs.iter().map(|r| r.seed)),
        span(runs.iter().map(|r| r.day.as_str())),
        span(runs.iter().map(|r| r.version.as_str())),
        executions as f64 / seconds.max(1e-9),
        100.0 * read as f64 / executions.max(1) as f64,
        most(|r| r.answers as f64),
        most(|r| r.slowest_ms),
        most(|r| r.peak_mb),
        most(|r| r.resident_mb),
        runs.iter().map(|r| r.findings.len()).sum::<usize>(),
    )
}

/// `a`, or `a to b`.
fn span<T: Ord + std::fmt::Display>(values: impl Iterator<Item = T> + Clone) -> String {
    match (values.clone().min(), values.max()) {
        (Some(first), Some(last)) if first < last => format!("{first} to {last}"),
        (first, _) => first.map(|v| v.to_string()).unwrap_or_default(),
    }
}
