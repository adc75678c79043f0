//! Rows of numbers in a text file -> columns. Of each block of lines chunks are parsed in parallel; what
//! is wrong with a cell is collected on the way and judged once, in [`Table::settle`].

use rayon::prelude::*;

use super::RecordingError;
use super::mend::{drop_repeated, drop_rows, most_leading, most_without};
use super::text::Text;
use crate::limits::{self, ROWS, TooMuch};

/// No quantity of an arm is larger; memory garbage in real logs is (1e254).
const LARGEST: f64 = 1e12;
/// Times may be nanoseconds since 1970.
const LARGEST_TIME: f64 = 1e20;
const BYTES_PER_CHUNK: usize = 1 << 17;

/// Numbers of the wanted columns.
#[derive(Debug, Default)]
pub struct Table {
    pub columns: Vec<Vec<f64>>,
    /// Line number (from 1) of every row.
    pub lines: Vec<usize>,
    /// What was dropped, one sentence each.
    pub notes: Vec<String>,
}

#[derive(Debug)]
struct Fault {
    row: usize,
    column: usize,
    kind: FaultKind,
}

#[derive(Debug, PartialEq)]
enum FaultKind {
    /// As it stands in the file.
    NotANumber(String),
    /// NaN, infinite or beyond anything an arm does.
    Garbage(f64),
    Columns(usize),
}

#[derive(Default)]
struct Chunk {
    columns: Vec<Vec<f64>>,
    /// From 0 within the chunk.
    lines: Vec<usize>,
    line_count: usize,
    faults: Vec<Fault>,
}

/// Reads the columns `wanted` (from 0, the time column first) of every row of `text`.
pub fn read(text: &mut Text, wanted: &[usize]) -> Result<Table, RecordingError> {
    let mut slots = vec![None; text.width];
    for (slot, column) in wanted.iter().enumerate() {
        slots[*column] = Some(slot);
    }
    let delimiter = text.delimiter.byte();
    let parse = |part: &[u8]| match delimiter {
        b',' => parse_chunk::<b','>(part, &slots, wanted.len()),
        b'\t' => parse_chunk::<b'\t'>(part, &slots, wanted.len()),
        b';' => parse_chunk::<b';'>(part, &slots, wanted.len()),
        _ => parse_chunk::<b' '>(part, &slots, wanted.len()),
    };
    let mut table = Table { columns: vec![Vec::new(); wanted.len()], ..Table::default() };
    let (mut faults, mut line, mut finished) = (Vec::new(), text.lines_before_body + 1, true);
    while !table.is_beyond_mending(&faults)
        && let Some(lines) = text.next_lines()?
    {
        finished = lines.ends_with(b"\n");
        let chunks: Vec<Chunk> = split_lines(lines).into_par_iter().map(parse).collect();
        line = table.append(chunks, line, &mut faults);
        table
            .allow()
            .map_err(|limit| RecordingError::TooMuch { file: text.file.clone(), limit })?;
    }
    table.settle(text, faults, finished)?;
    Ok(table)
}

/// Parts of about [`BYTES_PER_CHUNK`] that end at a line end.
fn split_lines(mut body: &[u8]) -> Vec<&[u8]> {
    let mut parts = Vec::with_capacity(body.len() / BYTES_PER_CHUNK + 1);
    while body.len() > BYTES_PER_CHUNK {
        let Some(end) = memchr::memchr(b'\n', &body[BYTES_PER_CHUNK..]) else { break };
        let (part, rest) = body.split_at(BYTES_PER_CHUNK + end + 1);
        parts.push(part);
        body = rest;
    }
    parts.push(body);
    parts
}

fn parse_chunk<const D: u8>(part: &[u8], slots: &[Option<usize>], wanted: usize) -> Chunk {
    let rows = part.len() / (slots.len() * 8).max(1) + 1;
    let mut chunk = Chunk { columns: vec![Vec::with_capacity(rows); wanted], ..Chunk::default() };
    let mut start = 0;
    while start < part.len() {
        let end = memchr::memchr(b'\n', &part[start..]).map_or(part.len(), |n| start + n);
        let line = trim(&part[start..end]);
        if !line.is_empty() && line[0] != b'#' {
            let row = chunk.lines.len();
            chunk.lines.push(chunk.line_count);
            if let Err((column, kind)) = parse_row::<D>(line, slots, &mut chunk.columns) {
                chunk.columns.iter_mut().for_each(|c| c.resize(row + 1, f64::NAN));
                chunk.faults.push(Fault { row, column, kind });
            }
        }
        chunk.line_count += 1;
        start = end + 1;
    }
    chunk
}

fn parse_row<const D: u8>(
    line: &[u8],
    slots: &[Option<usize>],
    columns: &mut [Vec<f64>],
) -> Result<(), (usize, FaultKind)> {
    let ragged = || (0, FaultKind::Columns(count_cells::<D>(line)));
    let mut at = 0;
    let mut garbage = None;
    for (c, slot) in slots.iter().enumerate() {
        if at >= line.len() {
            let empty = D != b' ' && c + 1 == slots.len() && line.ends_with(&[D]);
            return Err(if empty { (c, FaultKind::NotANumber(String::new())) } else { ragged() });
        }
        let next = match slot {
            None => cell_end::<D>(line, at),
            Some(slot) => {
                let (value, end) = number::<D>(line, at).ok_or_else(|| {
                    let cell = String::from_utf8_lossy(&line[at..cell_end::<D>(line, at)]);
                    (c, FaultKind::NotANumber(cell.trim().chars().take(40).collect()))
                })?;
                let largest = if *slot == 0 { LARGEST_TIME } else { LARGEST };
                if (value.is_nan() || value.abs() > largest) && garbage.is_none() {
                    garbage = Some((c, FaultKind::Garbage(value)));
                }
                columns[*slot].push(value);
                end
            }
        };
        at = after_delimiter::<D>(line, next);
    }
    if at < line.len() {
        return Err(ragged());
    }
    garbage.map_or(Ok(()), Err)
}

/// The number that fills the cell beginning at `at`, and where the cell ends.
#[inline]
fn number<const D: u8>(line: &[u8], at: usize) -> Option<(f64, usize)> {
    let quote = line.get(at).copied().filter(|b| matches!(b, b'"' | b'\''));
    let at = at + usize::from(quote.is_some());
    let (value, length) = fast_float2::parse_partial::<f64, _>(&line[at..]).ok()?;
    let mut end = at + length;
    if quote.is_some() {
        if line.get(end).copied() != quote {
            return None;
        }
        end += 1;
    }
    while D != b' ' && line.get(end).is_some_and(|b| *b == b' ' || (*b == b'\t' && D != b'\t')) {
        end += 1;
    }
    let full = line.get(end).is_none_or(|b| *b == D || (D == b' ' && *b == b'\t'));
    (length > 0 && full).then_some((value, end))
}

fn cell_end<const D: u8>(line: &[u8], at: usize) -> usize {
    let rest = &line[at..];
    let length = match D {
        b' ' => memchr::memchr2(b' ', b'\t', rest),
        _ => memchr::memchr(D, rest),
    };
    at + length.unwrap_or(rest.len())
}

/// Where the next cell begins: past the delimiter and the blanks around it.
#[inline]
fn after_delimiter<const D: u8>(line: &[u8], end: usize) -> usize {
    let mut at = if D == b' ' { end } else { end + 1 };
    while line.get(at).is_some_and(|b| *b == b' ' || (*b == b'\t' && D != b'\t')) {
        at += 1;
    }
    at
}

fn count_cells<const D: u8>(line: &[u8]) -> usize {
    let (mut at, mut count) = (0, 0);
    while at < line.len() {
        at = after_delimiter::<D>(line, cell_end::<D>(line, at));
        count += 1;
    }
    count
}

fn trim(line: &[u8]) -> &[u8] {
    let end = line.iter().rposition(|b| !matches!(b, b' ' | b'\r')).map_or(0, |e| e + 1);
    let start = line[..end].iter().position(|b| *b != b' ').unwrap_or(end);
    &line[start..end]
}

impl Table {
    pub fn rows(&self) -> usize {
        self.lines.len()
    }

    /// Adds the rows of chunks of which the first begins at `line`; returns the line after them.
    fn append(&mut self, chunks: Vec<Chunk>, mut line: usize, faults: &mut Vec<Fault>) -> usize {
        for chunk in &chunks {
            self.lines.extend(chunk.lines.iter().map(|l| line + l));
            line += chunk.line_count;
        }
        let mut first = self.columns.first().map_or(0, Vec::len);
        self.columns.par_iter_mut().enumerate().for_each(|(c, column)| {
            chunks.iter().for_each(|chunk| column.extend_from_slice(&chunk.columns[c]));
        });
        for chunk in chunks {
            faults.extend(chunk.faults.into_iter().map(|f| Fault { row: f.row + first, ..f }));
            first += chunk.lines.len();
        }
        line
    }

    fn allow(&self) -> Result<(), TooMuch> {
        ROWS.allow(self.rows() as u64)?;
        limits::NUMBERS.allow((self.rows() * self.columns.len()) as u64)
    }

    /// Is there a fault that no row left out mends, before a last line that may be cut?
    fn is_beyond_mending(&self, faults: &[Fault]) -> bool {
        let wrong = |f: &Fault| !f.kind.says_nothing() && f.row + 1 < self.rows();
        faults.len() > most_leading(ROWS.most as usize) || faults.iter().any(wrong)
    }

    /// Drops a cut last line, leading rows and a few others without a number, and rows that repeat a
    /// stamp, with a note each; refuses any other fault. Is the last line `finished`, that is, has it an
    /// end?
    fn settle(
        &mut self,
        text: &Text,
        mut faults: Vec<Fault>,
        finished: bool,
    ) -> Result<(), RecordingError> {
        self.drop_cut_last_line(text, &mut faults, finished);
        let leading = leading_garbage(&faults, most_leading(self.rows()));
        let (first, others) = faults.split_at(leading);
        let most = most_without(self.rows());
        if let Some(fault) = others.iter().find(|f| !f.kind.says_nothing()) {
            return Err(self.refusal(text, fault));
        }
        if others.len() > most {
            let throughout = leading == most_leading(self.rows());
            return Err(self.refusal(text, if throughout { &faults[0] } else { &others[0] }));
        }
        self.note_dropped(text, first, "leading row(s)");
        self.note_dropped(text, others, "row(s)");
        let out: Vec<usize> = faults.iter().map(|f| f.row).collect();
        drop_rows(&mut self.columns, &mut self.lines, &out);
        self.notes.extend(drop_repeated(&mut self.columns, &mut self.lines, "line"));
        Ok(())
    }

    fn drop_cut_last_line(&mut self, text: &Text, faults: &mut Vec<Fault>, finished: bool) {
        let Some(last) = self.rows().checked_sub(1) else { return };
        let short = faults.last().is_some_and(|f| {
            f.row == last && matches!(f.kind, FaultKind::Columns(n) if n < text.width)
        });
        if finished && !short {
            return;
        }
        faults.retain(|f| f.row != last);
        let line = self.lines[last];
        self.notes.push(match short {
            true => format!("dropped the cut last line {line}, which has too few columns"),
            false => format!(
                "dropped the last line {line}: it has no line end, so its last number may be cut"
            ),
        });
        self.lines.truncate(last);
        self.columns.iter_mut().for_each(|c| c.truncate(last));
    }

    fn note_dropped(&mut self, text: &Text, faults: &[Fault], which: &str) {
        let (Some(first), Some(last)) = (faults.first(), faults.last()) else { return };
        let value = match &first.kind {
            FaultKind::Garbage(value) => format!("{value:e}"),
            _ => "no number".into(),
        };
        let lines = match first.row == last.row {
            true => format!("line {}", self.lines[first.row]),
            false => format!("lines {} to {}", self.lines[first.row], self.lines[last.row]),
        };
        self.notes.push(format!(
            "dropped {} {which}, {lines}, with values no arm has (line {}, column {}: {value})",
            faults.len(),
            self.lines[first.row],
            text.column_name(first.column),
        ));
    }

    fn refusal(&self, text: &Text, fault: &Fault) -> RecordingError {
        let (file, row) = (text.file.clone(), self.lines[fault.row]);
        let column = text.column_name(fault.column);
        let (what, remedy) = match &fault.kind {
            FaultKind::Columns(found) => {
                let (found, expected) = (*found, text.width);
                return RecordingError::Ragged { file, row, found, expected };
            }
            FaultKind::NotANumber(cell) if cell.is_empty() => {
                ("the cell is empty".into(), "fill it in or delete the row")
            }
            FaultKind::NotANumber(cell) => (
                format!("{cell:?} is not a number"),
                "mend or delete the row, or take only the columns you need with a column map \
                 (--columns)",
            ),
            FaultKind::Garbage(v) if v.is_nan() => {
                ("the value is NaN".into(), "fill it in or delete the row")
            }
            FaultKind::Garbage(v) => (
                format!("the value {v:e} is beyond anything an arm does"),
                "mend or delete the row",
            ),
        };
        RecordingError::Cell { file, row, column, what, remedy }
    }
}

/// How many rows at the very start say nothing, up to `most`.
fn leading_garbage(faults: &[Fault], most: usize) -> usize {
    let at_start = |(k, f): &(usize, &Fault)| f.row == *k && f.kind.says_nothing();
    faults.iter().enumerate().take(most).take_while(at_start).count()
}

/// What programs write where there is no number.
const MISSING: [&str; 6] = ["", "na", "n/a", "null", "none", "\"\""];

impl FaultKind {
    /// No number, or one no arm has: the row can be left out. Words and other widths are another table.
    fn says_nothing(&self) -> bool {
        match self {
            Self::Garbage(_) => true,
            Self::NotANumber(cell) => MISSING.contains(&cell.to_lowercase().as_str()),
            Self::Columns(_) => false,
        }
    }
}
