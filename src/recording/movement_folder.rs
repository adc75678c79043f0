//! Folders with one log per signal, as in kkufieta/ur5_modeling_force_estimate: no header, comma
//! and blank, time in s and one column per joint. Logs end at different rows.

use std::path::{Path, PathBuf};

use super::check::{FEWEST_SAMPLES, refuse_bad};
use super::format::{Format, refuse_map};
use super::table::{self, Table};
use super::text::{Delimiter, Layout, Text};
use super::{Channel, ColumnMap, Provenance, Recording, RecordingError};
use crate::limits::NUMBERS;

/// Log name, RTDE name.
const SIGNALS: &[(&str, &str)] = &[
    ("q_target", "target_q"),
    ("qd_target", "target_qd"),
    ("qdd_target", "target_qdd"),
    ("q_actual", "actual_q"),
    ("qd_actual", "actual_qd"),
    ("i_actual", "actual_current"),
    ("i_target", "target_current"),
    ("m_target", "target_moment"),
    ("tcp_force", "actual_TCP_force"),
];
const REFERENCE: &str = "q_actual";
/// Stamps of one controller packet differ by less than this share of a step.
const SAME_PACKET: f64 = 0.1;

pub struct MovementFolder;

impl Format for MovementFolder {
    fn name(&self) -> &'static str {
        "folder with one log per signal"
    }

    fn reads(&self, path: &Path) -> bool {
        path.is_dir()
    }

    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
        refuse_map(map, || format!("a column map is for a file, {} is a folder", path.display()))?;
        read(path)
    }
}

struct Log {
    /// RTDE name without the joint.
    stem: &'static str,
    file_name: String,
    table: Table,
}

impl Log {
    fn time(&self) -> &[f64] {
        &self.table.columns[0]
    }
}

fn read(folder: &Path) -> Result<Recording, RecordingError> {
    let name = folder.display().to_string();
    let Some(path) = log_path(folder, REFERENCE) else {
        return Err(RecordingError::NotAMovement { folder: name });
    };
    let reference = read_log(&path, "actual_q")?;
    let mut notes = table_notes(&reference);
    let mut time = reference.time().to_vec();
    let (mut logs, mut numbers) = (Vec::new(), 0);
    for (signal, stem) in SIGNALS {
        if let Some(path) = log_path(folder, signal) {
            let log = read_log(&path, stem)?;
            numbers += log.table.rows() * log.table.columns.len();
            NUMBERS
                .allow(numbers as u64)
                .map_err(|limit| RecordingError::TooMuch { file: name.clone(), limit })?;
            if *signal != REFERENCE {
                notes.extend(table_notes(&log));
            }
            logs.push(log);
        }
    }
    let longest = time.len();
    let aligned: Vec<Aligned> = logs.iter().map(|log| align(log, &time)).collect();
    let (from, to) = common_range(&aligned, longest);
    if from >= to {
        return Err(RecordingError::TooFew { file: name, samples: 0, needed: FEWEST_SAMPLES });
    }
    notes.extend(alignment_notes(&logs, &aligned, &time));
    if log_path(folder, "force_sensor").is_some() {
        notes.push("log_force_sensor has a clock of its own and was left out".into());
    }
    if to - from < longest {
        notes.push(format!("the shortest log leaves {} of {longest} samples", to - from));
    }
    let channels = logs.iter().zip(aligned).flat_map(|(log, a)| a.channels(log.stem, from, to));
    let recording = Recording {
        channels: channels.collect(),
        time: time.drain(from..to).collect(),
        provenance: Provenance { source: name, format: MovementFolder.name().into(), notes },
    };
    refuse_bad(&recording, "1", &reference.table.lines[from..to])?;
    Ok(recording)
}

fn log_path(folder: &Path, signal: &str) -> Option<PathBuf> {
    ["csv", "csv.gz"]
        .iter()
        .map(|extension| folder.join(format!("log_{signal}.{extension}")))
        .find(|path| path.is_file())
}

fn read_log(path: &Path, stem: &'static str) -> Result<Log, RecordingError> {
    let mut text =
        Text::open(path, &Layout { delimiter: Some(Delimiter::Comma), ..Layout::default() })?;
    if text.header.is_some() || text.width < 2 {
        return Err(RecordingError::MissingColumn {
            column: "2 (time, then one column per joint, no names)".into(),
            found: text.found_columns(),
            file: text.file,
            remedy: "a log of one signal is expected in such a folder",
        });
    }
    let wanted: Vec<usize> = (0..text.width).collect();
    let table = table::read(&mut text, &wanted)?;
    if table.rows() < 2 {
        let (file, samples) = (text.file, table.rows());
        return Err(RecordingError::TooFew { file, samples, needed: FEWEST_SAMPLES });
    }
    let time = &table.columns[0];
    if let Some(k) = time.windows(2).position(|w| w[1] <= w[0]) {
        return Err(RecordingError::Time {
            file: text.file,
            row: table.lines[k + 1],
            column: "1".into(),
            what: if time[k + 1] == time[k] { "repeats" } else { "goes backwards" },
            before: time[k],
            after: time[k + 1],
        });
    }
    let file_name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Log { stem, file_name, table })
}

fn table_notes(log: &Log) -> Vec<String> {
    log.table.notes.iter().map(|n| format!("{}: {n}", log.file_name)).collect()
}

/// A log on the reference's rows `from..from + columns[0].len()`.
struct Aligned {
    from: usize,
    columns: Vec<Vec<f64>>,
    /// Largest difference of its stamps from the reference's, s; `None` if it was interpolated.
    shift: Option<f64>,
}

impl Aligned {
    fn channels(self, stem: &str, from: usize, to: usize) -> Vec<Channel> {
        let range = from - self.from..to - self.from;
        let columns = self.columns.into_iter().enumerate();
        let channel = |(j, values): (usize, Vec<f64>)| Channel {
            name: format!("{stem}_{j}"),
            values: values[range.clone()].to_vec(),
        };
        columns.map(channel).collect()
    }
}

/// Row by row where the stamps agree (one packet, stamped signal after signal), else linearly
/// interpolated onto the reference's time.
fn align(log: &Log, time: &[f64]) -> Aligned {
    let own = log.time();
    let step = |t: &[f64]| t.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    let shift = own.iter().zip(time).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if shift <= SAME_PACKET * step(time) {
        let rows = own.len().min(time.len());
        let columns = log.table.columns[1..].iter().map(|c| c[..rows].to_vec()).collect();
        return Aligned { from: 0, columns, shift: Some(shift) };
    }
    let covered = |t: &&f64| own.first() <= Some(*t) && Some(*t) <= own.last();
    let from = time.iter().position(|t| covered(&t)).unwrap_or(time.len());
    let onto: Vec<f64> = time[from..].iter().take_while(covered).copied().collect();
    let columns = log.table.columns[1..].iter().map(|c| interpolate(own, c, &onto)).collect();
    Aligned { from, columns, shift: None }
}

/// Linear between neighbours; `onto` lies within `time`, both rise.
fn interpolate(time: &[f64], values: &[f64], onto: &[f64]) -> Vec<f64> {
    let mut k = 0;
    let at = |t: &f64| {
        while k + 2 < time.len() && time[k + 1] < *t {
            k += 1;
        }
        let share = (t - time[k]) / (time[k + 1] - time[k]);
        values[k] + share * (values[k + 1] - values[k])
    };
    onto.iter().map(at).collect()
}

/// Rows that all logs have; where they do not overlap, it ends before it begins.
fn common_range(aligned: &[Aligned], longest: usize) -> (usize, usize) {
    let from = aligned.iter().map(|a| a.from).max().unwrap_or(0);
    let rows = |a: &Aligned| a.from + a.columns.first().map_or(0, Vec::len);
    let to = aligned.iter().map(rows).min().unwrap_or(longest);
    (from, to)
}

fn alignment_notes(logs: &[Log], aligned: &[Aligned], time: &[f64]) -> Vec<String> {
    let mut notes = Vec::new();
    let largest = aligned.iter().filter_map(|a| a.shift).fold(0.0, f64::max);
    if largest > 0.0 {
        notes.push(format!(
            "time columns differ by up to {:.0} us from log_{REFERENCE}'s: taken as the same \
             sample, on its time",
            largest * 1e6
        ));
    }
    let interpolated: Vec<_> = logs
        .iter()
        .zip(aligned)
        .filter(|(_, a)| a.shift.is_none())
        .map(|(log, _)| log.file_name.as_str())
        .collect();
    if !interpolated.is_empty() {
        notes.push(format!(
            "interpolated linearly onto the {} times of log_{REFERENCE}: {}",
            time.len(),
            interpolated.join(", ")
        ));
    }
    notes
}
