//! Rows from files: a recording at its own pace, or one that is still being written.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::{Feed, LiveError, News, Outbox};
use crate::limits::{LINE, TooMuch};
use crate::recording::{ColumnMap, Recording, RecordingError, read_by};

/// How fast a recording is played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// Times its own pace.
    Times(f64),
    AsFastAsItGoes,
}

/// How often a file is looked at that is being written.
const LOOKS: Duration = Duration::from_millis(100);
/// Share of its time that reading a whole file again may take, where only that tells what is new.
const READS: u32 = 10;

/// Plays a recording.
///
/// # Errors
/// If the system has no thread left.
pub fn replay(recording: Recording, pace: Pace) -> Result<Feed, LiveError> {
    Feed::start(true, move |out| {
        out.tell(News::Columns(columns(&recording)));
        let begun = Instant::now();
        let first = recording.time.first().copied().unwrap_or(0.0);
        for row in recording.rows() {
            if let Pace::Times(speed) = pace {
                let due = Duration::try_from_secs_f64((row[0] - first) / speed).unwrap_or_default();
                while !out.stopped() && begun.elapsed() < due {
                    std::thread::sleep((due - begun.elapsed().min(due)).min(LOOKS));
                }
            }
            if out.stopped() {
                break;
            }
            out.row(row);
        }
        Ok(())
    })
}

fn columns(recording: &Recording) -> Vec<String> {
    let names = recording.channels.iter().map(|c| c.name.clone());
    std::iter::once("timestamp".to_string()).chain(names).collect()
}

/// Reads what is there and what comes, until it is stopped. Text with RTDE names is read line by line as it
/// grows; every other file is read again as a whole, ever more seldom as it grows.
///
/// # Errors
/// If the system has no thread left.
pub fn follow(path: &Path, map: Option<ColumnMap>) -> Result<Feed, LiveError> {
    let path = path.to_path_buf();
    let name = path.to_string_lossy().to_lowercase();
    let lines = map.is_none() && [".csv", ".txt", ".log"].iter().any(|end| name.ends_with(end));
    Feed::start(true, move |out| match lines {
        true => follow_text(&path, out),
        false => follow_whole(&path, map.as_ref(), out),
    })
}

fn wait(out: &Outbox, long: Duration) {
    let begun = Instant::now();
    while !out.stopped() && begun.elapsed() < long {
        std::thread::sleep(LOOKS.min(long));
    }
}

/// Lines that are whole, as they come.
fn follow_text(path: &PathBuf, out: &Outbox) -> Result<(), LiveError> {
    let file = path.display().to_string();
    let io = |source| RecordingError::Io { file: file.clone(), action: "read", source };
    let mut opened = File::open(path).map_err(io)?;
    let mut lines =
        Lines { file: file.clone(), rest: Vec::new(), delimiter: b',', columns: 0, row: 0 };
    let mut buffer = vec![0; 1 << 16];
    let mut read_so_far = 0;
    while !out.stopped() {
        let length = opened.metadata().map_err(io)?.len();
        if length < read_so_far {
            return Err(LiveError::Follow(format!(
                "{file}: it was cut or begun anew while it was followed"
            )));
        }
        if length == read_so_far {
            wait(out, LOOKS);
            continue;
        }
        opened.seek(SeekFrom::Start(read_so_far)).map_err(io)?;
        let count = opened.read(&mut buffer).map_err(io)?;
        read_so_far += count as u64;
        lines.push(&buffer[..count], out)?;
    }
    Ok(())
}

/// Text that came, cut into rows.
struct Lines {
    file: String,
    rest: Vec<u8>,
    delimiter: u8,
    /// 0 before the header.
    columns: usize,
    row: usize,
}

impl Lines {
    fn push(&mut self, bytes: &[u8], out: &Outbox) -> Result<(), LiveError> {
        self.rest.extend_from_slice(bytes);
        while let Some(end) = memchr::memchr(b'\n', &self.rest) {
            let line: Vec<u8> = self.rest.drain(..=end).collect();
            let line = String::from_utf8_lossy(&line).trim().to_string();
            self.row += 1;
            if !line.is_empty() {
                self.line(&line, out)?;
            }
        }
        match LINE.allow(self.rest.len() as u64) {
            Ok(()) => Ok(()),
            Err(limit @ TooMuch(_)) => {
                Err(RecordingError::TooMuch { file: self.file.clone(), limit }.into())
            }
        }
    }

    fn line(&mut self, line: &str, out: &Outbox) -> Result<(), LiveError> {
        if self.columns == 0 {
            return self.header(line, out);
        }
        let cells = self.cells(line);
        let row: Vec<f64> =
            cells.iter().filter_map(|c| c.parse().ok()).filter(|v: &f64| v.is_finite()).collect();
        if row.len() != self.columns || cells.len() != self.columns {
            let what = format!(
                "row {} of {} is no row of {} numbers, and left out",
                self.row, self.file, self.columns
            );
            out.tell(News::Note(what));
            return Ok(());
        }
        out.row(row);
        Ok(())
    }

    fn header(&mut self, line: &str, out: &Outbox) -> Result<(), LiveError> {
        let delimiter = |d: &&u8| line.as_bytes().contains(d);
        self.delimiter = *[b',', b'\t', b';'].iter().find(delimiter).unwrap_or(&b' ');
        let names: Vec<String> =
            self.cells(line).into_iter().map(|c| c.trim_matches('"').to_string()).collect();
        if names.first().map(String::as_str) != Some("timestamp") {
            return Err(LiveError::Follow(format!(
                "{}: its first column is {:?}, and only text with RTDE names, timestamp first, is followed line \
                 by line: map its columns (--columns)",
                self.file,
                names.first().map_or("", String::as_str)
            )));
        }
        self.columns = names.len();
        out.tell(News::Columns(names));
        Ok(())
    }

    fn cells<'l>(&self, line: &'l str) -> Vec<&'l str> {
        match self.delimiter {
            b' ' => line.split_whitespace().collect(),
            d => line.split(char::from(d)).map(str::trim).collect(),
        }
    }
}

/// A bag, or another file whose end tells what is in it: read again, and what is later than before is new.
fn follow_whole(path: &Path, map: Option<&ColumnMap>, out: &Outbox) -> Result<(), LiveError> {
    let mut seen: Option<(f64, Vec<String>)> = None;
    let mut length = None;
    while !out.stopped() {
        let now = std::fs::metadata(path).ok().map(|m| (m.len(), m.modified().ok()));
        if now == length && now.is_some() {
            wait(out, LOOKS);
            continue;
        }
        let begun = Instant::now();
        let recording = match (read_by(path, map), &seen) {
            (Ok(recording), _) => recording,
            // Half a record may be there; what was read once can be read again.
            (Err(_), Some(_)) => {
                wait(out, LOOKS * READS);
                continue;
            }
            (Err(error), None) => return Err(error.into()),
        };
        length = now;
        let names = columns(&recording);
        match &seen {
            None => out.tell(News::Columns(names.clone())),
            Some((_, before)) if *before != names => {
                return Err(LiveError::Follow(format!("{}: its columns changed", path.display())));
            }
            Some(_) => {}
        }
        let after = seen.as_ref().map_or(f64::NEG_INFINITY, |(last, _)| *last);
        recording.rows().filter(|row| row[0] > after).for_each(|row| out.row(row));
        seen = Some((recording.time.last().copied().unwrap_or(after), names));
        wait(out, (begun.elapsed() * READS).max(LOOKS * READS));
    }
    Ok(())
}
