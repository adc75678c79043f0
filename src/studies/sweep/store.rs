//! The folder of a study: finished cells, each in its own file, and the tables joined from them.
//!
//! `parts/cell-000042.parquet` appears when the cell is done, under a temporary name until it is
//! whole. Whoever is killed loses the cells under way, nothing else.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::alone::{Part, Spent};
use super::parquet_file;
use super::study::Study;
use super::table::{Row, Table, Value};
use crate::files::write_whole;
use crate::studies::StudyError;

const STUDY: &str = "study.toml";
const PARTS: &str = "parts";
const LOCK: &str = "lock";
const CELLS: &str = "cells.parquet";
const TIMINGS: &str = "timings.parquet";
/// Notes in a part.
const DIGEST: &str = "armtwin.study";
const SPENT: &str = "armtwin.spent";
const CELL: &str = "armtwin.cell";

/// One of several shares of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of this share, from 1.
    pub number: usize,
    pub of: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once('/').and_then(|(number, of)| {
            Some(Self { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? })
        });
        let fits = |s: &Self| (1..=s.of).contains(&s.number);
        parsed.filter(fits).ok_or_else(|| "give K/N with K from 1 to N, for example 2/8".into())
    }
}

impl Shard {
    /// Every N-th block, so that all shards have some of every grid.
    pub fn blocks(self, study: &Study) -> Vec<Vec<usize>> {
        let all = study.blocks().into_iter().skip(self.number - 1);
        all.step_by(self.of).collect()
    }
}

pub struct Store {
    dir: PathBuf,
    digest: String,
    /// Released when the store is dropped, or its process dies.
    _lock: Option<File>,
}

impl Store {
    /// The folder `dir` for `study`, whose file reads `text`; nobody else may work in it.
    ///
    /// # Errors
    /// If it holds another study, or another process works in it, or it cannot be made.
    pub fn open(dir: &Path, study: &Study, text: &str) -> Result<Self, StudyError> {
        let parts = dir.join(PARTS);
        fs::create_dir_all(&parts).map_err(StudyError::io(&parts, "made"))?;
        let path = dir.join(LOCK);
        let options = OpenOptions::new().create(true).write(true).truncate(false).open(&path);
        let lock = options.map_err(StudyError::io(&path, "opened"))?;
        if lock.try_lock().is_err() {
            return Err(StudyError::file(dir, "another armtwin study is working in this folder"));
        }
        claim(dir, study, text)?;
        remove_unfinished(&parts);
        Ok(Self { dir: dir.into(), digest: study.digest(), _lock: Some(lock) })
    }

    /// The folder as [`Store::open`] gives it, beside others that work on other cells of the study.
    ///
    /// # Errors
    /// If it holds another study or cannot be made.
    pub fn shared(dir: &Path, study: &Study, text: &str) -> Result<Self, StudyError> {
        let parts = dir.join(PARTS);
        fs::create_dir_all(&parts).map_err(StudyError::io(&parts, "made"))?;
        claim(dir, study, text)?;
        Ok(Self { dir: dir.into(), digest: study.digest(), _lock: None })
    }

    /// Where the study's text is kept.
    pub fn study_file(&self) -> PathBuf {
        self.dir.join(STUDY)
    }

    fn part(&self, number: usize) -> PathBuf {
        self.dir.join(PARTS).join(format!("cell-{number:06}.parquet"))
    }

    /// Puts a finished cell down.
    ///
    /// # Errors
    /// If it cannot be written whole; then nothing is left of it.
    pub fn keep(&self, number: usize, part: &Part) -> Result<(), StudyError> {
        let spent = serde_json::to_string(&part.spent).unwrap_or_default();
        let notes = [(DIGEST, self.digest.clone()), (CELL, number.to_string()), (SPENT, spent)];
        parquet_file::keep(&self.part(number), &part.table, &notes)
    }

    /// Finished cells, every one read and found whole.
    ///
    /// # Errors
    /// If some are damaged; the message says which and that the others are kept.
    pub fn finished(&self) -> Result<BTreeMap<usize, PathBuf>, StudyError> {
        let found = parts_in(&self.dir)?;
        let check = |(number, path): (&usize, &PathBuf)| read(path, *number, &self.digest).err();
        let bad: Vec<StudyError> = found.iter().filter_map(check).collect();
        match bad.first() {
            None => Ok(found),
            Some(first) => {
                let (bad, good) = (bad.len(), found.len() - bad.len());
                let dir = self.dir.join(PARTS);
                let counts = format!("{good} parts are whole, {bad} not; the first: {first}");
                Err(StudyError::file(&dir, counts))
            }
        }
    }

    /// Time and memory that a finished cell took.
    ///
    /// # Errors
    /// If it is not there or damaged.
    pub fn spent(&self, number: usize) -> Result<Spent, StudyError> {
        Ok(read(&self.part(number), number, &self.digest)?.spent)
    }

    /// Joins the finished cells to `cells.parquet` and `timings.parquet`.
    ///
    /// # Errors
    /// If a part is damaged or a table cannot be written.
    pub fn join(&self) -> Result<[Table; 2], StudyError> {
        join(&self.dir, &self.digest, &self.finished()?)
    }
}

/// Joins the shards in `dirs` to the tables of the whole study in `out`.
///
/// # Errors
/// If the folders hold different studies, cells are missing, or two folders have different results
/// for one cell.
pub fn merge(dirs: &[PathBuf], out: &Path) -> Result<(Study, [Table; 2]), StudyError> {
    let mut all: BTreeMap<usize, PathBuf> = BTreeMap::new();
    let mut first: Option<(Study, String)> = None;
    for dir in dirs {
        let file = dir.join(STUDY);
        let study = Study::load(&file)?;
        let (whole, _) = first.get_or_insert_with(|| (study.clone(), text_of(&file)));
        if *whole != study {
            let other = format!("holds another study than {}", dirs[0].display());
            return Err(StudyError::file(dir, other));
        }
        let digest = study.digest();
        for (number, path) in parts_in(dir)? {
            let part = read(&path, number, &digest)?;
            let before = all.insert(number, path.clone());
            let differs = |other: &PathBuf| -> Result<bool, StudyError> {
                Ok(read(other, number, &digest)?.table.bytes() != part.table.bytes())
            };
            if let Some(other) = before.filter(|other| *other != path)
                && differs(&other)?
            {
                let why = format!("has other results than {}", other.display());
                return Err(StudyError::file(&path, why));
            }
        }
    }
    let Some((study, text)) = first else {
        return Err(StudyError::file(out, "no folders to merge"));
    };
    let missing: Vec<usize> = (0..study.cells()).filter(|n| !all.contains_key(n)).collect();
    if let Some(cell) = missing.first() {
        let (missing, cells) = (missing.len(), study.cells());
        let why = format!(
            "{missing} of {cells} cells are missing, the first is cell {cell}: run their shards \
             to the end, then merge again"
        );
        return Err(StudyError::file(&dirs[0], why));
    }
    fs::create_dir_all(out).map_err(StudyError::io(out, "made"))?;
    claim(out, &study, &text)?;
    let tables = join(out, &study.digest(), &all)?;
    Ok((study, tables))
}

fn text_of(file: &Path) -> String {
    fs::read_to_string(file).unwrap_or_default()
}

/// The folder is this study's from now on.
fn claim(dir: &Path, study: &Study, text: &str) -> Result<(), StudyError> {
    let file = dir.join(STUDY);
    if file.exists() {
        return match Study::load(&file)? == *study {
            true => Ok(()),
            false => Err(StudyError::file(dir, "holds another study: name another folder")),
        };
    }
    write_whole(&file, |out| out.write_all(text.as_bytes()))
        .map_err(StudyError::io(&file, "written"))
}

/// What a killed process left under temporary names.
fn remove_unfinished(parts: &Path) {
    let entries = fs::read_dir(parts).into_iter().flatten().flatten();
    for entry in entries.filter(|e| e.file_name().to_string_lossy().starts_with(".tmp")) {
        // Left where it is it only takes room.
        let _ = fs::remove_file(entry.path());
    }
}

fn parts_in(dir: &Path) -> Result<BTreeMap<usize, PathBuf>, StudyError> {
    let parts = dir.join(PARTS);
    let entries = fs::read_dir(&parts).map_err(StudyError::io(&parts, "read"))?;
    let number = |path: &Path| -> Option<usize> {
        let name = path.file_name()?.to_str()?;
        name.strip_prefix("cell-")?.strip_suffix(".parquet")?.parse().ok()
    };
    let paths = entries.flatten().map(|e| e.path());
    Ok(paths.filter_map(|path| Some((number(&path)?, path))).collect())
}

/// The part of cell `number`, and of no other under its name.
fn read(path: &Path, number: usize, digest: &str) -> Result<Part, StudyError> {
    let (table, notes) = parquet_file::read(path)?;
    let note = |key: &str| notes.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str());
    if note(DIGEST) != Some(digest) {
        let why = "was made by another study or version of armtwin: name another folder";
        return Err(StudyError::file(path, why));
    }
    let row = || table.wholes("cell").first().map(|cell| *cell as usize);
    let cell = note(CELL).and_then(|text| text.parse().ok()).or_else(row).unwrap_or(number);
    if cell != number {
        let why = format!(
            "holds cell {cell}, as if it were cell {number}: remove this file and run the cell again"
        );
        return Err(StudyError::file(path, why));
    }
    let spent = note(SPENT).and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
    Ok(Part { table, spent })
}

/// Joins the parts in the order of the cells; the same parts make the same bytes.
fn join(
    out: &Path,
    digest: &str,
    parts: &BTreeMap<usize, PathBuf>,
) -> Result<[Table; 2], StudyError> {
    let mut cells = Table::default();
    let mut timings: Vec<Row> = Vec::new();
    for (number, path) in parts {
        let part = read(path, *number, digest)?;
        cells.append(&part.table)?;
        timings.push(timing(*number, &part.spent));
    }
    let timings = Table::of(&timings)?;
    let notes = [(DIGEST, digest.to_string())];
    parquet_file::write(&out.join(CELLS), &cells, &notes)?;
    parquet_file::write(&out.join(TIMINGS), &timings, &notes)?;
    Ok([cells, timings])
}

fn timing(number: usize, spent: &Spent) -> Row {
    vec![
        ("cell", number.into()),
        ("seconds", spent.seconds.into()),
        ("simulating_seconds", spent.simulating_seconds.into()),
        ("simulated_seconds", spent.simulated_seconds.into()),
        ("steps", Value::Whole(spent.steps)),
        ("peak_bytes", Value::Whole(spent.peak_bytes)),
    ]
}

/// The tables of a folder that is done.
///
/// # Errors
/// If they are not there or damaged.
pub fn tables(dir: &Path) -> Result<(Study, [Table; 2]), StudyError> {
    let study = Study::load(&dir.join(STUDY))?;
    Ok((
        study,
        [parquet_file::read(&dir.join(CELLS))?.0, parquet_file::read(&dir.join(TIMINGS))?.0],
    ))
}
