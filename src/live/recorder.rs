//! A recording in the making: rows go to a journal that is whole at any moment, and full files are finished while
//! the next one is written.

use std::path::{Path, PathBuf};
use std::thread::{Builder, JoinHandle};

use super::{Gaps, LiveError, Step};
use crate::files;
use crate::limits::{NUMBERS, ROWS};
use crate::recording::{JOURNALED, Journal, RecordingError, journal_of};

/// Takes rows, time (s) first, and makes files of them that every command reads.
pub struct Recorder {
    out: PathBuf,
    source: String,
    names: Vec<String>,
    journal: Option<Journal>,
    /// Rows that a file takes.
    most: u64,
    /// Threads for files that are full, and are being turned into what was asked for.
    finishing: Vec<JoinHandle<Result<PathBuf, RecordingError>>>,
    parts: u64,
    rows: u64,
    gaps: Gaps,
    first: Option<f64>,
    last: f64,
    recorded_s: f64,
}

/// What a recording came to.
#[derive(Debug)]
pub struct Recorded {
    pub files: Vec<PathBuf>,
    pub rows: u64,
    pub seconds: f64,
    /// In the controller's clock.
    pub gaps: Gaps,
}

impl Recorder {
    /// Begins `out` (`.parquet`, `.csv` or `.csv.gz`) with rows of `source`, which come at about `rate_hz`;
    /// `columns` name their numbers, `timestamp` first.
    ///
    /// # Errors
    /// If the columns are no recording's, or the file may not be written.
    pub fn begin(
        out: &Path,
        source: &str,
        rate_hz: f64,
        columns: &[String],
    ) -> Result<Self, LiveError> {
        let refused = |why: String| LiveError::Record(format!("{source}: {why}"));
        let [time, names @ ..] = columns else {
            return Err(refused("it has no columns".into()));
        };
        if time != "timestamp" {
            return Err(refused(format!(
                "its first column is {time}, where timestamp is expected"
            )));
        }
        let mut recorder = Self {
            out: out.into(),
            source: source.into(),
            names: names.to_vec(),
            journal: None,
            most: most_rows(columns.len()),
            finishing: Vec::new(),
            parts: 0,
            rows: 0,
            gaps: Gaps::new(rate_hz),
            first: None,
            last: 0.0,
            recorded_s: 0.0,
        };
        recorder.next_file()?;
        Ok(recorder)
    }

    /// Begins the next file; the one before is finished meanwhile.
    fn next_file(&mut self) -> Result<(), LiveError> {
        self.finish_file()?;
        self.parts += 1;
        let path = numbered(&self.out, self.parts);
        files::may_write(&path)
            .map_err(|refused| LiveError::Record(format!("{}: {refused}", path.display())))?;
        self.journal = Some(Journal::begin(&path, &self.names)?);
        Ok(())
    }

    fn finish_file(&mut self) -> Result<(), LiveError> {
        if let Some(journal) = self.journal.take() {
            let source = self.source.clone();
            let work = Builder::new().name("finishes".into());
            let work = work.spawn(move || journal.end(&source)).map_err(LiveError::Thread)?;
            self.finishing.push(work);
        }
        Ok(())
    }

    fn is_full(&self) -> bool {
        self.journal.as_ref().map_or(0, Journal::rows) >= self.most
    }

    /// Rows so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Length so far by the controller's clock, s.
    pub fn length_s(&self) -> f64 {
        self.recorded_s + self.first.map_or(0.0, |first| self.last - first)
    }

    /// Takes a row; what people should know of it, where there is something.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, row: &[f64]) -> Result<Option<String>, LiveError> {
        let (time, mut note) = (row[0], None);
        match self.gaps.step(time) {
            // A row that came twice.
            Step::Back(0.0) => return Ok(None),
            Step::Back(by) => {
                note = Some(format!(
                    "the controller's clock went back by {by:.3} s: the recording goes on in a new file"
                ));
                self.recorded_s = self.length_s();
                self.first = None;
                self.next_file()?;
            }
            _ => {}
        }
        if self.is_full() {
            self.next_file()?;
        }
        self.first.get_or_insert(time);
        self.last = time;
        self.rows += 1;
        if let Some(journal) = &mut self.journal {
            journal.add(row)?;
        }
        Ok(note)
    }

    /// Hands the rows over to the system.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn hand_over(&mut self) -> Result<(), LiveError> {
        Ok(self.journal.as_mut().map_or(Ok(()), Journal::hand_over)?)
    }

    /// Hands the rows over to the disk: they outlast a power failure.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn settle(&mut self) -> Result<(), LiveError> {
        Ok(self.journal.as_mut().map_or(Ok(()), Journal::settle)?)
    }

    /// Finishes all files.
    ///
    /// # Errors
    /// If not one row came (nothing is left then), or a file cannot be finished.
    pub fn end(mut self) -> Result<Recorded, LiveError> {
        if self.rows == 0 {
            if let Some(journal) = self.journal.take() {
                let left = journal_of(journal.path());
                drop(journal);
                let gone = std::fs::remove_file(&left);
                gone.map_err(|e| LiveError::Record(format!("{}: {e}", left.display())))?;
            }
            return Err(LiveError::Record(format!("{}: not one row came", self.source)));
        }
        let seconds = self.length_s();
        self.finish_file()?;
        let mut files = Vec::new();
        for work in self.finishing {
            let unfinished = |_| LiveError::Record("a file could not be finished".into());
            files.push(work.join().map_err(unfinished)??);
        }
        Ok(Recorded { files, rows: self.rows, seconds, gaps: self.gaps })
    }
}

/// As many as every command reads.
fn most_rows(columns: usize) -> u64 {
    ROWS.most.min(NUMBERS.most / columns as u64)
}

/// `run.parquet`, `run.2.parquet`, ...
fn numbered(path: &Path, part: u64) -> PathBuf {
    if part == 1 {
        return path.into();
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let end = JOURNALED.iter().rev().find(|end| name.to_lowercase().ends_with(*end));
    let (stem, end) = name.split_at(name.len() - end.map_or(0, |e| e.len()));
    path.with_file_name(format!("{stem}.{part}{end}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_file_is_followed_by_the_next_without_a_row_lost() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("run.parquet");
        let columns = ["timestamp".to_string(), "actual_q_0".to_string()];
        let mut recorder = Recorder::begin(&out, "rtde://arm", 125.0, &columns).unwrap();
        assert_eq!(recorder.most, ROWS.most);
        recorder.most = 400;
        let rows = (0..1000).map(|k| [k as f64 / 125.0, k as f64]);
        rows.clone().for_each(|row| assert_eq!(recorder.add(&row).unwrap(), None));
        let done = recorder.end().unwrap();
        assert_eq!((done.rows, done.gaps.count), (1000, 0));
        let read = |path: &PathBuf| crate::recording::read(path, None).unwrap();
        let parts: Vec<_> = done.files.iter().map(read).collect();
        let lengths: Vec<usize> = parts.iter().map(|part| part.time.len()).collect();
        assert_eq!(lengths, [400, 400, 200]);
        let all = parts.iter().flat_map(|part| part.channel("actual_q_0").unwrap().to_vec());
        assert!(all.eq(rows.map(|row| row[1])));
    }

    /// A clock that goes back begins a new file, and what is no recording nothing.
    #[test]
    fn a_clock_that_goes_back_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("run.csv");
        let columns = ["timestamp".to_string(), "actual_q_0".to_string()];
        let mut recorder = Recorder::begin(&out, "arm", 125.0, &columns).unwrap();
        let row = |k: usize| [k as f64 / 125.0, 0.0];
        (100..150).for_each(|k| assert_eq!(recorder.add(&row(k)).unwrap(), None));
        assert!(recorder.add(&row(0)).unwrap().unwrap().contains("went back by 1.192 s"));
        (1..50).for_each(|k| assert_eq!(recorder.add(&row(k)).unwrap(), None));
        assert_eq!(recorder.end().unwrap().files.len(), 2);
        let wrong = Recorder::begin(&out, "arm", 125.0, &columns[1..]).err().unwrap();
        assert!(wrong.to_string().contains("arm: its first column is actual_q_0"), "{wrong}");
    }

    #[test]
    fn a_file_takes_no_more_than_is_read() {
        for columns in [2, 44, 400] {
            let numbers = most_rows(columns) * columns as u64;
            assert!(ROWS.allow(most_rows(columns)).is_ok() && NUMBERS.allow(numbers).is_ok());
        }
    }

    #[test]
    fn further_files_are_numbered_before_the_extension() {
        let name = |path: &str, part| numbered(Path::new(path), part).display().to_string();
        assert_eq!(name("a/run.parquet", 1), "a/run.parquet");
        assert_eq!(name("a/run.parquet", 2), "a/run.2.parquet");
        assert_eq!(name("run.csv.gz", 12), "run.12.csv.gz");
    }
}
