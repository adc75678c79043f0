//! CSV of any origin, its columns named by a [`ColumnMap`].

use std::path::Path;

use super::check::refuse_bad;
use super::columns::{Column, Mapped};
use super::text::Text;
use super::{Channel, ColumnMap, Provenance, Recording, RecordingError, table};
use crate::limits;

/// Reads the mapped columns of `path`; all others are left out.
pub fn read(path: &Path, map: &ColumnMap) -> Result<Recording, RecordingError> {
    let mut text = Text::open(path, &map.layout())?;
    if let Some(expected) = map.file_columns.filter(|n| *n != text.width) {
        let (file, row, found) = (text.file, text.first_line, text.width);
        return Err(RecordingError::Ragged { file, row, found, expected });
    }
    let mapped = map.mapped()?;
    let time = locate(map.time()?, &text, map)?;
    let columns: Vec<usize> =
        mapped.iter().map(|m| locate(&m.column, &text, map)).collect::<Result<_, _>>()?;
    let (wanted, slots) = distinct(time, &columns);
    let mut table = table::read(&mut text, &wanted)?;
    let numbers = (table.rows() * (mapped.len() + 1)) as u64;
    limits::allow_numbers(numbers, text.bytes())
        .map_err(|limit| RecordingError::TooMuch { file: text.file.clone(), limit })?;
    let channels = channels(mapped, &slots, &mut table.columns);
    table.columns[0].iter_mut().for_each(|t| *t *= map.time_scale);
    let recording = Recording {
        channels,
        time: std::mem::take(&mut table.columns[0]),
        provenance: Provenance {
            source: text.file.clone(),
            format: format!("CSV, {}, columns by {}", text.delimiter.name(), map.file),
            notes: table.notes,
        },
    };
    refuse_bad(&recording, &text.column_name(time), &table.lines)?;
    Ok(recording)
}

/// A channel takes its column with it where nobody needs that any more.
fn channels(mapped: Vec<Mapped>, slots: &[usize], columns: &mut [Vec<f64>]) -> Vec<Channel> {
    let mut channels = Vec::with_capacity(mapped.len());
    for (k, Mapped { name, scale, .. }) in mapped.into_iter().enumerate() {
        let needed = slots[k] == 0 || slots[k + 1..].contains(&slots[k]);
        let column = &mut columns[slots[k]];
        let mut values = if needed { column.clone() } else { std::mem::take(column) };
        values.iter_mut().for_each(|v| *v *= scale);
        channels.push(Channel { name, values });
    }
    channels
}

/// Position (from 0) of a column of the map in the file.
fn locate(column: &Column, text: &Text, map: &ColumnMap) -> Result<usize, RecordingError> {
    let position = match (column, &text.header) {
        (Column::Number(n), _) => n.checked_sub(1).filter(|c| *c < text.width),
        (Column::Name(name), Some(names)) => {
            text.refuse_duplicates()?;
            names.iter().position(|n| n == name)
        }
        (Column::Name(_), None) => None,
    };
    position.ok_or_else(|| RecordingError::MissingColumn {
        file: text.file.clone(),
        column: map.describe(column),
        found: text.found_columns(),
        remedy: "correct the column map",
    })
}

/// File columns to read, each once, time first; and where among them each mapped one is.
fn distinct(time: usize, columns: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let mut wanted = vec![time];
    let slots = columns
        .iter()
        .map(|c| {
            wanted.iter().position(|w| w == c).unwrap_or_else(|| {
                wanted.push(*c);
                wanted.len() - 1
            })
        })
        .collect();
    (wanted, slots)
}
