//! The columns of a table, whatever its layout.

use std::path::Path;

#[cfg(feature = "parquet")]
use crate::recording::format::Format;
#[cfg(feature = "parquet")]
use crate::recording::parquet_file::{self, Parquet};
use crate::recording::text::{Delimiter, Layout, Text};
use crate::recording::{RecordingError, table};

/// Lines of a preamble that are tried.
const MOST_SKIPPED: usize = 50;
/// Rows that are looked at to tell numbers from words.
const LOOKED_AT: usize = 50;

/// A table in memory.
pub struct Columns {
    /// As the file has them; none without a header.
    pub names: Option<Vec<String>>,
    /// One per column of the file; empty where it holds no numbers.
    pub values: Vec<Vec<f64>>,
    /// The column that rises.
    pub time: Option<usize>,
    /// Lines of the map that say how to read the file.
    pub layout: Vec<String>,
    /// What reading dropped.
    pub notes: Vec<String>,
}

impl Columns {
    /// The columns, for messages.
    pub fn found(&self) -> String {
        match &self.names {
            Some(names) => format!("columns there: {}", names.join(", ")),
            None => format!("{} columns without names", self.values.len()),
        }
    }

    pub fn name(&self, column: usize) -> Option<&str> {
        self.names.as_ref()?.get(column).map(String::as_str)
    }
}

pub fn read(path: &Path) -> Result<Columns, RecordingError> {
    #[cfg(feature = "parquet")]
    if Parquet.reads(path) {
        return parquet(path);
    }
    let (layout, lines) = layout(path)?;
    let mut text = Text::open(path, &layout)?;
    let wanted = numeric(&mut text)?;
    let mut wanted: Vec<usize> = (0..text.width).filter(|c| wanted[*c]).collect();
    // The reader takes larger numbers in its first column: nanoseconds since 1970.
    let clock = wanted.iter().position(|c| is_time(text.header.as_deref(), *c)).unwrap_or(0);
    if !wanted.is_empty() {
        wanted.swap(0, clock);
    }
    let table = table::read(&mut text, &wanted)?;
    let mut values = vec![Vec::new(); text.width];
    wanted.iter().zip(table.columns).for_each(|(c, column)| values[*c] = column);
    let time = time(text.header.as_deref(), &values);
    Ok(Columns { names: text.header, values, time, layout: lines, notes: table.notes })
}

#[cfg(feature = "parquet")]
fn parquet(path: &Path) -> Result<Columns, RecordingError> {
    let (names, values) = parquet_file::columns(path)?;
    let time = time(Some(&names), &values);
    Ok(Columns { names: Some(names), values, time, layout: Vec::new(), notes: Vec::new() })
}

/// How the file is to be read, and the lines of a map that say so.
fn layout(path: &Path) -> Result<(Layout, Vec<String>), RecordingError> {
    let plain = Layout::default();
    let first = Text::open(path, &plain);
    let mut tried = vec![(plain, Vec::new())];
    for skip_rows in 0..MOST_SKIPPED {
        let said = match skip_rows {
            0 => Vec::new(),
            n => vec![format!("skip_rows = {n}    # what is before is no table")],
        };
        let skipped = Layout { skip_rows, ..Layout::default() };
        let semicolon = Layout { delimiter: Some(Delimiter::Semicolon), ..skipped.clone() };
        let comma = Layout { decimal_comma: true, ..semicolon.clone() };
        let with = |more: &[&str]| {
            said.iter().cloned().chain(more.iter().map(ToString::to_string)).collect::<Vec<_>>()
        };
        tried.push((skipped, with(&[])));
        tried.push((semicolon, with(&["delimiter = \"semicolon\""])));
        tried.push((comma, with(&["delimiter = \"semicolon\"", "decimal = \",\""])));
    }
    let fits = |layout: &Layout| {
        let text = Text::open(path, layout).ok().filter(|t| t.width > 1);
        text.is_some_and(|mut t| mostly_numbers(&mut t).unwrap_or(false))
    };
    match tried.into_iter().find(|(layout, _)| fits(layout)) {
        Some(found) => Ok(found),
        None => Err(first.err().unwrap_or_else(|| RecordingError::ColumnMap {
            file: path.display().to_string(),
            what: "no rows of numbers in it".into(),
        })),
    }
}

fn rows(text: &mut Text) -> Result<Vec<Vec<String>>, RecordingError> {
    let delimiter = text.delimiter;
    let body = String::from_utf8_lossy(text.peek_lines()?.unwrap_or_default());
    let lines = body.lines().filter(|l| !l.trim().is_empty() && !l.starts_with('#'));
    let cells = |line: &str| {
        let cells = delimiter.split(line.trim());
        cells.iter().map(|c| c.trim_matches(['"', '\'']).trim().to_string()).collect()
    };
    Ok(lines.take(LOOKED_AT).map(cells).collect())
}

fn is_number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok_and(f64::is_finite)
}

/// Rows as wide as the first line, with more numbers than words.
fn mostly_numbers(text: &mut Text) -> Result<bool, RecordingError> {
    let rows = rows(text)?;
    let wide = rows.iter().filter(|r| r.len() == text.width).count();
    let numbers = rows.iter().flatten().filter(|c| is_number(c)).count();
    let cells = rows.iter().map(Vec::len).sum::<usize>();
    Ok(wide * 10 >= rows.len() * 9 && !rows.is_empty() && 2 * numbers > cells)
}

/// By column: numbers in most rows.
fn numeric(text: &mut Text) -> Result<Vec<bool>, RecordingError> {
    let rows = rows(text)?;
    let numbers = |c: usize| rows.iter().filter(|r| r.get(c).is_some_and(|x| is_number(x))).count();
    Ok((0..text.width).map(|c| 2 * numbers(c) > rows.len()).collect())
}

const TIME: [&str; 8] = ["timestamp", "time", "t", "stamp", "clock", "secs", "seconds", "ms"];

fn is_time(names: Option<&[String]>, column: usize) -> bool {
    let Some(name) = names.and_then(|n| n.get(column)) else { return false };
    super::words::words(name).iter().any(|w| TIME.contains(&w.as_str()))
}

/// The first column that rises and has time's name, else the first that rises.
fn time(names: Option<&[String]>, values: &[Vec<f64>]) -> Option<usize> {
    let rises = |c: &usize| {
        let v = &values[*c];
        v.len() > 1 && v.windows(2).all(|w| w[1] > w[0])
    };
    let rising: Vec<usize> = (0..values.len()).filter(rises).collect();
    rising.iter().find(|c| is_time(names, **c)).or(rising.first()).copied()
}
