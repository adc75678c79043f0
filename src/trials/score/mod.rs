//! The seals opened: what the answers are worth.

mod chapter;
mod goals;
mod judged;
mod on_recordings;
mod page;
mod printed;
mod realised;
mod rows;
mod share;
mod tables;
mod tenths;
#[cfg(test)]
mod tests;

pub use chapter::Chapter;
pub use goals::{figures, goals};
pub use judged::{Judged, JudgedParameter, judge};
pub use page::page;
pub use printed::Printed;
pub use rows::{Figure, Goal};
pub use share::Share;

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::case::TWIN;
use super::{Answer, Kind, Seals, TrialError, Truth, case_folders, third};
use crate::twin::Twin;

/// Opens the seals of the trial in `dir` and holds the answers against what was hidden.
///
/// # Errors
/// If a seal is broken, or a case was not answered or was answered from other files.
pub fn score(dir: &Path, answers: &Path) -> Result<Vec<Judged>, TrialError> {
    score_cases(dir, &case_folders(dir)?, answers)
}

/// Holds the answers to some of the trial's cases against what was hidden.
///
/// # Errors
/// As [`score()`].
pub fn score_cases(
    dir: &Path,
    folders: &[PathBuf],
    answers: &Path,
) -> Result<Vec<Judged>, TrialError> {
    let seals = Seals::load(dir)?;
    let one = |folder: &PathBuf| {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let truth = seals.open(dir, &name)?;
        let answer = load(&answers.join(format!("{name}.json")))?;
        let mut judged = judge(&truth, &answer);
        if let (true, Some(diagnosis)) = (truth.third, &answer.diagnosis) {
            let third = third::open(&seals, dir, &name)?;
            let twin = Twin::load(&folder.join(TWIN))?;
            let (realised, oracle) = realised::realised(&twin, &third, &truth, diagnosis)?;
            (judged.realised, judged.oracle) = (Some(realised), oracle);
        }
        Ok::<_, TrialError>(judged)
    };
    let mut all: Vec<Judged> = folders.par_iter().map(one).collect::<Result<_, _>>()?;
    on_recordings::hold_against_base(&mut all);
    Ok(all)
}

fn load(file: &Path) -> Result<Answer, TrialError> {
    let bytes = fs::read(file).map_err(|e| {
        let problem = format!("cannot be read: {e}; answer the cases with `armtwin trial answer`");
        TrialError::file(file, problem)
    })?;
    serde_json::from_slice(&bytes).map_err(|e| TrialError::file(file, e))
}
