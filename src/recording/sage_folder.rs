//! Folders of isaac-sim2real/sage: `control.csv` (commands) and `state_motor.csv` (what was measured),
//! times in microseconds, the values of all joints as a list in one quoted cell.

use std::path::{Path, PathBuf};

use super::check::{FEWEST_SAMPLES, refuse_bad};
use super::format::{Format, refuse_map};
use super::whole::whole_text;
use super::{Channel, ColumnMap, Provenance, Recording, RecordingError};
use crate::limits::{COLUMNS, NUMBERS, ROWS, TooMuch};

const CONTROL: &str = "control.csv";
const STATE: &str = "state_motor.csv";
const TIME: &str = "timestamp";
/// Seconds per unit of the time column.
const MICROSECONDS: f64 = 1e-6;
/// Rows of both files this close in time are one sample, s.
const SAME_ROW_S: f64 = 1e-6;
/// Column, the channel it becomes.
const MEASURED: [(&str, &str); 3] =
    [("positions", "actual_q"), ("velocities", "actual_qd"), ("torques", "sage_torques")];

pub struct SageFolder;

impl Format for SageFolder {
    fn name(&self) -> &'static str {
        "SAGE folder"
    }

    fn reads(&self, path: &Path) -> bool {
        path.is_dir() && file(path, STATE).is_some()
    }

    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
        refuse_map(map, || format!("a column map is for a file, {} is a folder", path.display()))?;
        read(path)
    }
}

fn file(folder: &Path, name: &str) -> Option<PathBuf> {
    [name.to_string(), format!("{name}.gz")]
        .iter()
        .map(|name| folder.join(name))
        .find(|path| path.is_file())
}

fn read(folder: &Path) -> Result<Recording, RecordingError> {
    let source = folder.display().to_string();
    let state = Log::read(&file(folder, STATE).unwrap_or_else(|| folder.join(STATE)))?;
    let mut notes = Vec::new();
    let mut channels = Vec::new();
    for (column, stem) in MEASURED {
        match state.lists(column)? {
            Some(joints) => channels.extend(named(stem, joints)),
            None if column == "positions" => return Err(state.lacks(column)),
            None => {}
        }
    }
    if state.column("torques").is_some() {
        notes.push(
            "torques are kept as sage_torques_*: such logs hold the size of the current's register, \
             without its sign, which is no torque"
                .into(),
        );
    }
    match file(folder, CONTROL) {
        Some(path) => {
            let control = Log::read(&path)?;
            let command = control.lists("positions")?.ok_or_else(|| control.lacks("positions"))?;
            let on = onto(&control.time, &command, &state.time, &mut notes);
            channels.splice(0..0, named("target_q", on));
        }
        None => notes.push(format!("there is no {CONTROL}: what was commanded is not known")),
    }
    let recording = Recording {
        time: state.time,
        channels,
        provenance: Provenance { source, format: SageFolder.name().into(), notes },
    };
    refuse_bad(&recording, TIME, &state.lines)?;
    Ok(recording)
}

/// Commands at the instants of the measurements: row by row where they agree, else the last one before.
fn onto(time: &[f64], command: &[Vec<f64>], at: &[f64], notes: &mut Vec<String>) -> Vec<Vec<f64>> {
    let alike =
        time.len() == at.len() && time.iter().zip(at).all(|(a, b)| (a - b).abs() <= SAME_ROW_S);
    if alike {
        return command.to_vec();
    }
    notes.push(format!(
        "commands are held until the next one: {} rows on {}",
        time.len(),
        at.len()
    ));
    let last = |t: &f64| time.partition_point(|c| *c <= t + SAME_ROW_S).saturating_sub(1);
    let rows: Vec<usize> = at.iter().map(last).collect();
    command.iter().map(|joint| rows.iter().map(|&k| joint[k]).collect()).collect()
}

fn named(stem: &str, joints: Vec<Vec<f64>>) -> impl Iterator<Item = Channel> {
    let name = move |j: usize| format!("{stem}_{j}");
    let names: Vec<String> = (0..joints.len()).map(name).collect();
    names.into_iter().zip(joints).map(|(name, values)| Channel { name, values })
}

/// A CSV whose cells may be lists.
struct Log {
    file: String,
    names: Vec<String>,
    /// s
    time: Vec<f64>,
    rows: Vec<Vec<String>>,
    lines: Vec<usize>,
}

impl Log {
    fn read(path: &Path) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        let text = whole_text(path)?;
        let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty());
        let head = lines.next().map(|(_, l)| cells(l)).unwrap_or_default();
        let mut log = Self { file, names: head, time: vec![], rows: vec![], lines: vec![] };
        let time = log.column(TIME).ok_or_else(|| log.lacks(TIME))?;
        for (at, line) in lines {
            let row = cells(line);
            if row.len() != log.names.len() {
                let (found, expected) = (row.len(), log.names.len());
                return Err(RecordingError::Ragged {
                    file: log.file,
                    row: at + 1,
                    found,
                    expected,
                });
            }
            log.time.push(MICROSECONDS * log.number(&row[time], at + 1, TIME)?);
            log.rows.push(row);
            log.lines.push(at + 1);
            ROWS.allow(log.rows.len() as u64).map_err(|limit| log.too_much(limit))?;
        }
        if log.rows.len() < FEWEST_SAMPLES {
            let samples = log.rows.len();
            return Err(RecordingError::TooFew { file: log.file, samples, needed: FEWEST_SAMPLES });
        }
        Ok(log)
    }

    fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    fn lacks(&self, column: &str) -> RecordingError {
        RecordingError::MissingColumn {
            file: self.file.clone(),
            column: column.into(),
            found: self.names.join(", "),
            remedy: "SAGE writes it; copy the folder again",
        }
    }

    fn too_much(&self, limit: TooMuch) -> RecordingError {
        RecordingError::TooMuch { file: self.file.clone(), limit }
    }

    fn number(&self, cell: &str, row: usize, column: &str) -> Result<f64, RecordingError> {
        let number = cell.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        number.ok_or_else(|| RecordingError::Cell {
            file: self.file.clone(),
            row,
            column: column.into(),
            what: format!("{cell:?} is no number"),
            remedy: "mend or delete the row",
        })
    }

    /// A column of lists, joint by joint; `None` where there is no such column.
    fn lists(&self, column: &str) -> Result<Option<Vec<Vec<f64>>>, RecordingError> {
        let Some(at) = self.column(column) else { return Ok(None) };
        let mut joints: Vec<Vec<f64>> = Vec::new();
        for (row, line) in self.rows.iter().zip(&self.lines) {
            let inner = row[at].trim().trim_start_matches('[').trim_end_matches(']');
            let values: Vec<&str> = inner.split(',').collect();
            if joints.is_empty() {
                COLUMNS.allow(values.len() as u64).map_err(|limit| self.too_much(limit))?;
                let numbers = (values.len() * self.rows.len()) as u64;
                NUMBERS.allow(numbers).map_err(|limit| self.too_much(limit))?;
                joints = vec![Vec::with_capacity(self.rows.len()); values.len()];
            }
            if values.len() != joints.len() {
                let what = format!("{} values where {} are expected", values.len(), joints.len());
                return Err(RecordingError::Cell {
                    file: self.file.clone(),
                    row: *line,
                    column: column.into(),
                    what,
                    remedy: "mend or delete the row",
                });
            }
            for (joint, value) in joints.iter_mut().zip(values) {
                joint.push(self.number(value, *line, column)?);
            }
        }
        Ok(Some(joints))
    }
}

/// Cells of a line, commas between quotation marks among them.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            c => cells.last_mut().into_iter().for_each(|cell| cell.push(c)),
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(kind: &str, k: usize, lists: &[&str]) -> String {
        let lists: Vec<String> = lists.iter().map(|l| format!("\"{l}\"")).collect();
        format!("{kind},{}.5,{}\n", 20_000 * k, lists.join(","))
    }

    fn folder(control: Option<&str>, state: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(STATE), state).unwrap();
        control.into_iter().for_each(|c| std::fs::write(folder.path().join(CONTROL), c).unwrap());
        folder
    }

    fn state(rows: usize) -> String {
        let head = "type,timestamp,positions,velocities,torques\n";
        let rows =
            (0..rows).map(|k| row("STATE_MOTOR", k, &["[0.5, -1.0]", "[0.0, 0.1]", "[0, 1]"]));
        head.to_string() + &rows.collect::<String>()
    }

    #[test]
    fn lists_in_cells_become_joints_and_commands_are_held() {
        let head = "type,timestamp,positions\n".to_string();
        let commands = [0, 3, 6].map(|k| row("CONTROL", k, &[&format!("[{k}, 0.25]")]));
        let folder = folder(Some(&(head + &commands.concat() + &tail())), &state(12));
        let read = super::super::read(folder.path(), None).unwrap();
        assert!((read.time[1] - read.time[0] - 0.02).abs() < 1e-12);
        assert_eq!(read.channel("actual_q_1").unwrap()[7], -1.0);
        assert_eq!(read.channel("target_q_0").unwrap()[..8], [0., 0., 0., 3., 3., 3., 6., 6.]);
        assert!(read.channel("joint_torque_0").is_none(), "they are no torques");
        assert_eq!(read.provenance.notes.len(), 2, "{:?}", read.provenance.notes);
    }

    /// Commands after the last measurement.
    fn tail() -> String {
        (50..58).map(|k| row("CONTROL", k, &["[9, 0.25]"])).collect()
    }

    #[test]
    fn what_is_damaged_is_refused_by_row_and_column() {
        let message = |state: &str| {
            let folder = folder(None, state);
            super::super::read(folder.path(), None).unwrap_err().to_string()
        };
        assert!(message(&state(3)).contains("3 samples"));
        assert!(message(&state(12).replacen("0.5, -1.0", "0.5", 3)).contains("positions"));
        let wrong = message(&state(12).replacen("-1.0", "x", 1));
        assert!(wrong.contains("row 2") && wrong.contains("\" x\" is no number"), "{wrong}");
        assert!(message(&state(12).replace("positions", "place")).contains("no column positions"));
        assert!(message(&state(12)[..250]).contains("state_motor.csv"));
    }
}
