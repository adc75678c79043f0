//! How much each criterion of a diagnosis matters: all cases answered with the criteria as they are,
//! and with one of them a third down or up.

mod page;
mod row;
mod variants;

pub use page::criteria_page;
pub use row::Row;
pub use variants::Moved;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::answer::Opened;
use super::score::score_cases;
use super::{Answer, Case, Judged, Seals, TrialError, case_folders, write_json};
use variants::{Variant, variants};

/// Sealed cases and the criteria to answer them by.
pub struct CriteriaTrial {
    dir: PathBuf,
    folders: Vec<PathBuf>,
    variants: Vec<Variant>,
    /// How the cases were made, for people.
    pub made: String,
}

/// How the answers are made.
pub struct Work<'a> {
    /// Answer again what is answered already.
    pub again: bool,
    /// Asked before every answer.
    pub go_on: &'a (dyn Fn() -> bool + Sync),
    /// Told of every answer.
    pub tick: &'a (dyn Fn() + Sync),
}

impl CriteriaTrial {
    /// The trial in `dir`, or its first `limit` cases. Seals are checked and stay closed.
    ///
    /// # Errors
    /// If there are no cases, a seal is broken, or cases are not all to be answered by the same
    /// criteria.
    pub fn open(dir: &Path, limit: Option<usize>) -> Result<Self, TrialError> {
        let mut folders = case_folders(dir)?;
        folders.truncate(limit.unwrap_or(folders.len()).max(1));
        let seals = Seals::load(dir)?;
        let first = Case::open(&folders[0])?;
        for folder in &folders {
            let case = Case::open(folder)?;
            seals.open_file(dir, &format!("{}.json", case.name))?;
            if case.settings.criteria != first.settings.criteria {
                let problem = format!("other criteria than those of {}", first.name);
                return Err(TrialError::file(folder, problem));
            }
        }
        let variants = variants(&first.settings.criteria)?;
        Ok(Self { dir: dir.into(), folders, variants, made: seals.made })
    }

    pub fn cases(&self) -> usize {
        self.folders.len()
    }

    /// How many there are when all is done.
    pub fn answers(&self) -> usize {
        self.folders.len() * self.variants.len()
    }

    /// Answers every case by all criteria, in a folder of `out` each, and says how many answers were
    /// there: those to the same case, by the same version and criteria.
    ///
    /// # Errors
    /// If a case cannot be read, an answer not be written, or the work is to stop.
    pub fn answer(&self, out: &Path, work: &Work<'_>) -> Result<usize, TrialError> {
        for variant in &self.variants {
            let folder = out.join(&variant.name);
            fs::create_dir_all(&folder).map_err(TrialError::io(&folder, "made"))?;
        }
        self.folders.par_iter().map(|folder| self.answer_case(folder, out, work)).sum()
    }

    fn answer_case(&self, case: &Path, out: &Path, work: &Work<'_>) -> Result<usize, TrialError> {
        let name = case.file_name().unwrap_or_default().to_string_lossy();
        let file = |variant: &Variant| out.join(&variant.name).join(format!("{name}.json"));
        let kept =
            |v: &&Variant| !work.again && Answer::kept_by(&file(v), case, &v.criteria).is_some();
        let (kept, open): (Vec<_>, Vec<_>) = self.variants.iter().partition(kept);
        kept.iter().for_each(|_| (work.tick)());
        if open.is_empty() {
            return Ok(kept.len());
        }
        let go_on = || (work.go_on)().then_some(()).ok_or(TrialError::Stopped);
        go_on()?;
        let opened = Opened::new(case)?;
        open.par_iter().try_for_each(|variant| {
            go_on()?;
            write_json(&file(variant), &opened.answer(variant.criteria))?;
            (work.tick)();
            Ok::<_, TrialError>(())
        })?;
        Ok(kept.len())
    }

    /// Opens the seals: what the answers in `out` are worth, as the criteria are and moved.
    ///
    /// # Errors
    /// As [`super::score()`].
    pub fn score(&self, out: &Path) -> Result<Vec<Row>, TrialError> {
        let judged = |v: &Variant| score_cases(&self.dir, &self.folders, &out.join(&v.name));
        let mut all = self.variants.iter().map(judged).collect::<Result<Vec<_>, _>>()?;
        all.iter_mut().for_each(with_their_base);
        let moved = self.variants.iter().map(|v| v.moved.clone());
        Ok(moved.zip(&all).map(|(moved, judged)| Row::new(moved, judged, &all[0])).collect())
    }
}

/// Strays of a graft are told by the answer to the same recordings untouched, which a limit may leave
/// out.
fn with_their_base(cases: &mut Vec<Judged>) {
    let names: BTreeSet<String> = cases.iter().map(|j| j.case.clone()).collect();
    cases.retain(|j| j.base.as_ref().is_none_or(|base| names.contains(base)));
}
