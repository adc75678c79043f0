//! Results of targets that are done, in a folder: a long run that is interrupted goes on where it was.

use std::path::Path;

use crate::run::{Limit, Result};

/// What a target found with this seed in no fewer inputs.
pub fn known(folder: &Path, target: &str, limit: &Limit, seed: u64) -> Option<Result> {
    let text = std::fs::read_to_string(file(folder, target)).ok()?;
    let result: Result = serde_json::from_str(&text).ok()?;
    (result.seed == seed && result.executions >= limit.executions).then_some(result)
}

pub fn keep(folder: &Path, result: &Result) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let text = serde_json::to_string_pretty(result).expect("plain numbers");
    std::fs::write(file(folder, &result.target), text)
}

fn file(folder: &Path, target: &str) -> std::path::PathBuf {
    folder.join(format!("{target}.json"))
}
