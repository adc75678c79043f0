//! A recording while it is made: rows go into a journal, `run.parquet.part.csv`, that is a recording
//! itself at any moment (RTDE CSV; a last line that is cut is dropped when it is read), and becomes the
//! file that was asked for at the end. Memory does not grow with it.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use super::file::{cannot, replace, unwritten};
use super::parquet_file::{self, Batches};
use super::rtde_csv::{TIME, write_number};
use super::{Channel, Provenance, Recording, RecordingError};
use crate::files::{Growing, write_whole};

/// What a journal can become.
pub const JOURNALED: [&str; 3] = [".csv", ".csv.gz", ".parquet"];

/// Rows that are copied at once.
const BATCH: usize = 1 << 13;

pub struct Journal {
    becomes: PathBuf,
    grows: Growing,
    names: Vec<String>,
    rows: u64,
}

/// Where the rows are until the recording at `path` is whole.
pub fn journal_of(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part.csv");
    name.into()
}

impl Journal {
    /// Begins the recording `path`; `names` are those of the channels, beside time.
    ///
    /// # Errors
    /// If the journal of a recording that was cut short is there, or the system refuses.
    pub fn begin(path: &Path, names: &[String]) -> Result<Self, RecordingError> {
        let journal = journal_of(path);
        let begin = || {
            let mut grows = Growing::begin(&journal)?;
            write!(grows, "{TIME}")?;
            names.iter().try_for_each(|name| write!(grows, ",{name}"))?;
            grows.write_all(b"\n")?;
            grows.hand_over()?;
            Ok(grows)
        };
        let grows = begin().map_err(cannot(&journal, "written"))?;
        Ok(Self { becomes: path.into(), grows, names: names.to_vec(), rows: 0 })
    }

    /// Where it will be.
    pub fn path(&self) -> &Path {
        &self.becomes
    }

    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Adds a row, time first.
    ///
    /// # Errors
    /// If the disk is full.
    pub fn add(&mut self, row: &[f64]) -> Result<(), RecordingError> {
        let mut put = || {
            for (c, value) in row.iter().enumerate() {
                if c > 0 {
                    self.grows.write_all(b",")?;
                }
                write_number(*value, &mut self.grows)?;
            }
            self.grows.write_all(b"\n")
        };
        put().map_err(cannot(self.grows.path(), "written"))?;
        self.rows += 1;
        Ok(())
    }

    /// From now on all rows survive the death of the program.
    ///
    /// # Errors
    /// If the disk is full.
    pub fn hand_over(&mut self) -> Result<(), RecordingError> {
        self.grows.hand_over().map_err(cannot(self.grows.path(), "written"))
    }

    /// From now on all rows survive a power failure. Waits for the disk.
    ///
    /// # Errors
    /// If the disk is full.
    pub fn settle(&mut self) -> Result<(), RecordingError> {
        self.grows.settle().map_err(cannot(self.grows.path(), "written"))
    }

    /// Makes the recording that was asked for; `source` is what it says of where it is from.
    ///
    /// # Errors
    /// If it cannot be written; the journal is still there then.
    pub fn end(mut self, source: &str) -> Result<PathBuf, RecordingError> {
        self.settle()?;
        let (path, journal) = (self.becomes.clone(), self.grows.path().to_path_buf());
        let name = path.to_string_lossy().to_lowercase();
        if name.ends_with(".csv") {
            self.grows.becomes(&path).map_err(cannot(&path, "written"))?;
            return Ok(path);
        }
        if name.ends_with(".gz") {
            pack(&journal, &path).map_err(cannot(&path, "written"))?;
        } else {
            replace(&path, |file, _| self.convert(&journal, file, source, &path))?;
        }
        self.grows.remove().map_err(cannot(&journal, "removed"))?;
        Ok(path)
    }

    fn convert(
        &self,
        journal: &Path,
        file: File,
        source: &str,
        path: &Path,
    ) -> Result<(), RecordingError> {
        let read = cannot(journal, "read");
        let mut lines = BufReader::new(File::open(journal).map_err(&read)?).lines().skip(1);
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        let wrong = |e| unwritten(path, e);
        let mut out = Batches::new(file, &names, source).map_err(wrong)?;
        loop {
            let mut columns = vec![Vec::with_capacity(BATCH); names.len() + 1];
            for line in lines.by_ref().take(BATCH) {
                let line = line.map_err(&read)?;
                let cells = line.split(',').map(|c| c.parse::<f64>());
                for (column, cell) in columns.iter_mut().zip(cells) {
                    column.push(cell.map_err(|e| unwritten(path, e))?);
                }
            }
            if columns[0].is_empty() {
                return out.end().map_err(wrong);
            }
            out.add(columns).map_err(wrong)?;
        }
    }
}

fn pack(journal: &Path, path: &Path) -> io::Result<()> {
    write_whole(path, |out| {
        let mut packer = flate2::write::GzEncoder::new(out, flate2::Compression::default());
        io::copy(&mut BufReader::new(File::open(journal)?), &mut packer)?;
        packer.finish().map(drop)
    })
}

/// What a journal holds or has become (Parquet), however few rows there are; a line that is cut ends it.
///
/// # Errors
/// If it cannot be read.
pub fn journaled(path: &Path) -> Result<Recording, RecordingError> {
    let (names, columns) = match path.extension().is_some_and(|e| e == "parquet") {
        true => parquet_file::columns(path)?,
        false => lines(path).map_err(cannot(path, "read"))?,
    };
    let mut columns = columns.into_iter();
    let time = columns.next().unwrap_or_default();
    let channels = names.into_iter().skip(1).zip(columns);
    let provenance = Provenance { source: path.display().to_string(), ..Provenance::default() };
    let channel = |(name, values)| Channel { name, values };
    Ok(Recording { time, channels: channels.map(channel).collect(), provenance })
}

fn lines(path: &Path) -> io::Result<(Vec<String>, Vec<Vec<f64>>)> {
    let mut lines = BufReader::new(File::open(path)?).lines();
    let header = lines.next().transpose()?.unwrap_or_default();
    let names: Vec<String> = header.split(',').map(String::from).collect();
    let mut columns = vec![Vec::new(); names.len()];
    for line in lines {
        let line = line?;
        let row: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
        if row.len() != names.len() {
            break;
        }
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    Ok((names, columns))
}

impl Recording {
    /// Rows, time first, under the names of its channels.
    pub fn rows(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let row = |k: usize| {
            let values = self.channels.iter().map(move |c| c.values[k]);
            std::iter::once(self.time[k]).chain(values).collect()
        };
        (0..self.time.len()).map(row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::read;

    fn rows(journal: &mut Journal, count: usize) -> Vec<Vec<f64>> {
        let row = |k: usize| vec![k as f64 * 0.008, (k as f64).sin(), 1e-9 * k as f64];
        let all: Vec<Vec<f64>> = (0..count).map(row).collect();
        all.iter().for_each(|row| journal.add(row).unwrap());
        all
    }

    #[test]
    fn what_a_journal_becomes_holds_its_rows_to_the_last_bit() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["actual_q_0".to_string(), "actual_current_0".into()];
        for end in JOURNALED {
            let path = folder.path().join(format!("run{end}"));
            let mut journal = Journal::begin(&path, &names).unwrap();
            let all = rows(&mut journal, 20_000);
            assert_eq!(journal.end("here").unwrap(), path);
            let back = read(&path, None).unwrap();
            assert!(back.rows().eq(all.iter().cloned()), "{end}");
            assert!(!journal_of(&path).exists());
        }
        let few = folder.path().join("few.parquet");
        let mut journal = Journal::begin(&few, &names).unwrap();
        let all = rows(&mut journal, 2);
        journal.end("here").unwrap();
        assert!(journaled(&few).unwrap().rows().eq(all.iter().cloned()));
    }

    #[test]
    fn a_journal_is_a_recording_before_its_end_and_is_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.parquet");
        let mut journal = Journal::begin(&path, &["actual_q_0".into(), "b".into()]).unwrap();
        let all = rows(&mut journal, 500);
        journal.hand_over().unwrap();
        journal.add(&[5.0, 1.0, 2.0]).unwrap();
        std::mem::forget(journal);
        let back = read(&journal_of(&path), None).unwrap();
        assert!(back.rows().eq(all.iter().cloned()));
        assert!(journaled(&journal_of(&path)).unwrap().rows().eq(all.iter().cloned()));
        let Err(refused) = Journal::begin(&path, &["actual_q_0".into()]) else { panic!() };
        let refused = refused.to_string();
        assert!(
            refused.contains("run.parquet.part.csv") && refused.contains("can be read as it is"),
            "{refused}"
        );
    }
}
