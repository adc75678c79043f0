//! A first column map of a table nobody described: columns by their names where these speak, else by what
//! the numbers say of each other (a velocity is what a position changes by, friction follows velocity),
//! units by sizes. Every guess says why; it is a draft to look through.

mod by_data;
mod by_name;
mod source;
#[cfg(test)]
mod tests;
mod units;
mod words;
mod write;

use std::path::Path;

use super::RecordingError;

/// A column map as text, and the signals it has.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    /// TOML with comments.
    pub map: String,
    pub joints: usize,
    pub stems: Vec<&'static str>,
}

/// One signal of all joints.
#[derive(Debug, Clone, PartialEq)]
struct Block {
    stem: &'static str,
    /// From 0, base to wrist.
    columns: Vec<usize>,
    /// SI units per unit of the file.
    scale: f64,
    why: String,
}

/// Reads `path`, a delimited text or Parquet file, and guesses what its columns are.
///
/// # Errors
/// If it is no table of numbers, or nothing in it looks like positions of joints.
pub fn draft(path: &Path) -> Result<Draft, RecordingError> {
    let columns = source::read(path)?;
    let file = || path.display().to_string();
    let time = columns.time.ok_or_else(|| RecordingError::ColumnMap {
        file: file(),
        what: format!(
            "no column of it rises like time ({}); write the map by hand, the keys are explained in \
             scenarios/columns",
            columns.found()
        ),
    })?;
    let clock = units::clock(&columns, time);
    let mut blocks = by_name::blocks(&columns, time);
    if !blocks.iter().any(|b| b.stem == "actual_q") {
        blocks = by_data::blocks(&columns, time, clock.scale);
    }
    if blocks.is_empty() {
        return Err(RecordingError::ColumnMap {
            file: file(),
            what: format!(
                "neither names nor numbers tell which columns are joint positions ({}); write the map by \
                 hand, the keys are explained in scenarios/columns",
                columns.found()
            ),
        });
    }
    units::guess(&mut blocks, &columns, time, clock.scale);
    let joints = blocks.iter().map(|b| b.columns.len()).max().unwrap_or(0);
    let stems = blocks.iter().map(|b| b.stem).collect();
    Ok(Draft { map: write::map(path, &columns, time, &clock, &blocks), joints, stems })
}
