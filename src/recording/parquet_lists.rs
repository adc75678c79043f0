//! Parquet columns whose cells are lists of numbers, all of one length, as LeRobot writes them.

use std::path::Path;

use arrow::array::{Array, ArrayRef, AsArray};
use arrow::datatypes::DataType;
use parquet::arrow::ProjectionMask;

use super::RecordingError;
use super::parquet_file::{allow, damaged, extend, look_at_pages, reader, refusal, too_much};
use crate::limits::{COLUMNS, ROWS};

/// Columns of numbers and of lists of numbers, by name.
pub struct Lists {
    file: String,
    numbers: Vec<(String, Vec<f64>)>,
    lists: Vec<(String, Vec<Vec<f64>>)>,
}

impl Lists {
    /// Empty where there is no such column.
    pub fn numbers(&self, name: &str) -> &[f64] {
        self.numbers.iter().find(|(n, _)| n == name).map_or(&[], |(_, v)| v)
    }

    /// The places of the lists, one column each; empty where there is no such column.
    pub fn lists(&self, name: &str) -> &[Vec<f64>] {
        self.lists.iter().find(|(n, _)| n == name).map_or(&[], |(_, v)| v)
    }

    /// These rows.
    pub fn only(self, rows: &[usize]) -> Self {
        let pick = |v: Vec<f64>| -> Vec<f64> { rows.iter().map(|&k| v[k]).collect() };
        let numbers = self.numbers.into_iter().map(|(n, v)| (n, pick(v))).collect();
        let all = |lists: Vec<Vec<f64>>| lists.into_iter().map(pick).collect();
        let lists = self.lists.into_iter().map(|(n, v)| (n, all(v))).collect();
        Self { file: self.file, numbers, lists }
    }

    /// A column of lists is shorter than it is said to be.
    pub fn short(&self, name: &str) -> RecordingError {
        damaged(Path::new(&self.file), format!("the lists of {name} are too short"))
    }
}

/// Reads `numbers` and columns of `lists`, of equal length in all rows of each; columns that are not there
/// stay away.
///
/// # Errors
/// If it is no Parquet file, too large, or a list is no list of numbers or of another length.
pub fn lists(path: &Path, numbers: &[&str], lists: &[&str]) -> Result<Lists, RecordingError> {
    let (opened, builder) = reader(path)?;
    let wrong = |e: &dyn std::error::Error| damaged(path, e.to_string());
    let schema = builder.schema().clone();
    let there = |name: &&&str| schema.index_of(name).is_ok();
    let names: Vec<&str> = numbers.iter().chain(lists).filter(there).copied().collect();
    let roots = names.iter().filter_map(|n| schema.index_of(n).ok());
    let mask = ProjectionMask::roots(builder.parquet_schema(), roots);
    look_at_pages(&opened, &builder, &mask).map_err(|e| refusal(path, e))?;
    let mut found =
        Lists { file: path.display().to_string(), numbers: Vec::new(), lists: Vec::new() };
    let (mut rows, mut count) = (0, 0);
    for batch in builder.with_projection(mask).build().map_err(|e| wrong(&e))? {
        let batch = batch.map_err(|e| wrong(&e))?;
        for name in &names {
            let Some(values) = batch.column_by_name(name) else { continue };
            let width = if lists.contains(name) {
                let slot = slot(&mut found.lists, name);
                extend_lists(slot, values, rows, name, &found.file)?
            } else {
                let slot = slot(&mut found.numbers, name);
                extend(slot, values, name, &found.file)?;
                1
            };
            count += width * batch.num_rows();
        }
        rows += batch.num_rows();
        ROWS.allow(rows as u64).map_err(|limit| too_much(path, limit))?;
        allow(path, &opened, count)?;
    }
    Ok(found)
}

fn slot<'a, T: Default>(all: &'a mut Vec<(String, T)>, name: &str) -> &'a mut T {
    let at = all.iter().position(|(n, _)| n == name).unwrap_or_else(|| {
        all.push((name.into(), T::default()));
        all.len() - 1
    });
    &mut all[at].1
}

/// Adds lists, one column per place; returns how long they are.
fn extend_lists(
    columns: &mut Vec<Vec<f64>>,
    values: &ArrayRef,
    rows: usize,
    name: &str,
    file: &str,
) -> Result<usize, RecordingError> {
    let wrong = |row: usize, what: String| RecordingError::Cell {
        file: file.into(),
        row: rows + row + 1,
        column: name.into(),
        what,
        remedy: "write it as lists of equally many numbers",
    };
    for row in 0..values.len() {
        let list = match values.data_type() {
            DataType::FixedSizeList(..) => values.as_fixed_size_list().value(row),
            DataType::List(_) => values.as_list::<i32>().value(row),
            kind => return Err(wrong(row, format!("{kind} is no list"))),
        };
        let mut one = Vec::new();
        extend(&mut one, &list, name, file)?;
        if columns.is_empty() && rows + row == 0 {
            COLUMNS
                .allow(one.len() as u64)
                .map_err(|limit| RecordingError::TooMuch { file: file.into(), limit })?;
            *columns = vec![Vec::new(); one.len()];
        }
        if one.len() != columns.len() {
            return Err(wrong(row, format!("{} numbers, not {}", one.len(), columns.len())));
        }
        columns.iter_mut().zip(one).for_each(|(column, v)| column.push(v));
    }
    Ok(columns.len())
}
