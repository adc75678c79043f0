//! Results in a folder, for each reader a file with one line for each run: a long run may be spread over
//! days, and an interruption costs one part of it.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use crate::run::{Limit, Result, in_a_process};
use crate::targets::Target;

/// Inputs of one part of a long run.
const PART: u64 = 1_000_000;

/// Runs the target with one seed after the other, from `seed` on, until the limit is reached, and keeps
/// each part. What is kept of a seed is not run again. All that is kept then, in the order of seeds.
pub fn runs(
    folder: &Path,
    target: &Target,
    limit: &Limit,
    seed: u64,
) -> std::io::Result<Vec<Result>> {
    let mut all = known(folder, target.name)?;
    let (mut sound, mut clock_s) = (0, 0.0);
    for seed in seed.. {
        let wanted = PART.min(limit.executions.saturating_sub(sound));
        let part = Limit { executions: wanted, seconds: limit.seconds - clock_s };
        if wanted == 0 || part.seconds <= 0.0 {
            break;
        }
        match all.iter().find(|run| run.seed == seed && run.is_sound()) {
            Some(run) if run.executions >= wanted => sound += run.executions,
            _ => {
                let found = in_a_process(target, &part, seed);
                (sound, clock_s) = (sound + found.executions, clock_s + found.clock_s);
                let broken = !found.is_sound();
                take(&mut all, found);
                keep(folder, target.name, &all)?;
                if broken {
                    break;
                }
            }
        }
    }
    Ok(all)
}

/// A run takes the place of a shorter one with its seed, and of one that broke a rule.
fn take(all: &mut Vec<Result>, found: Result) {
    match all.iter_mut().find(|run| run.seed == found.seed) {
        Some(run) if run.is_sound() && run.executions > found.executions => {}
        Some(run) => *run = found,
        None => all.push(found),
    }
    all.sort_by_key(|run| run.seed);
}

fn known(folder: &Path, target: &str) -> std::io::Result<Vec<Result>> {
    let path = file(folder, target);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = std::fs::read_to_string(&path)?;
    text.lines().map(|line| serde_json::from_str(line).map_err(std::io::Error::other)).collect()
}

fn keep(folder: &Path, target: &str, all: &[Result]) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let lines = all.iter().map(|run| serde_json::to_string(run).expect("plain numbers") + "\n");
    std::fs::write(file(folder, target), lines.collect::<String>())
}

fn file(folder: &Path, target: &str) -> PathBuf {
    folder.join(format!("{target}.jsonl"))
}

/// `2026-11-23`, in UTC.
pub fn today() -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |d| d.as_secs_f64());
    armtwin::numbers::day(now)
}
