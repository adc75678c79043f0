//! A delimited text file: byte order mark, header line and delimiter found out.

use std::path::Path;

use super::RecordingError;
use super::blocks::Blocks;
use crate::limits::COLUMNS;

/// What separates columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Delimiter {
    Comma,
    /// Any run of blanks.
    Blank,
    Tab,
    Semicolon,
}

impl Delimiter {
    pub fn byte(self) -> u8 {
        match self {
            Delimiter::Comma => b',',
            Delimiter::Blank => b' ',
            Delimiter::Tab => b'\t',
            Delimiter::Semicolon => b';',
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Delimiter::Comma => "comma",
            Delimiter::Blank => "blank",
            Delimiter::Tab => "tab",
            Delimiter::Semicolon => "semicolon",
        }
    }

    /// The cells of one line, blanks around them removed; a delimiter at the very end adds none.
    pub fn split(self, line: &str) -> Vec<&str> {
        if self == Delimiter::Blank {
            return line.split_ascii_whitespace().collect();
        }
        let mut cells: Vec<&str> = line.split(char::from(self.byte())).map(str::trim).collect();
        if cells.len() > 1 && cells.last() == Some(&"") {
            cells.pop();
        }
        cells
    }
}

/// How to read a text file; everything not given is found out.
#[derive(Debug, Clone, Default)]
pub struct Layout {
    pub delimiter: Option<Delimiter>,
    /// Lines in front of the header or the first row.
    pub skip_rows: usize,
    pub decimal_comma: bool,
}

/// Lines of comment in front of the header that are read past.
const MOST_COMMENTS: usize = 1000;

/// A text file, its first line taken apart.
pub struct Text {
    pub file: String,
    pub delimiter: Delimiter,
    /// Column names, where the first line holds names.
    pub header: Option<Vec<String>>,
    /// Columns of the first line.
    pub width: usize,
    /// Line number (from 1) of the first line that is not blank.
    pub first_line: usize,
    /// Number of lines before the numbers begin.
    pub lines_before_body: usize,
    decimal_comma: bool,
    rest: Blocks,
}

impl Text {
    pub fn open(path: &Path, layout: &Layout) -> Result<Self, RecordingError> {
        let mut rest = Blocks::open(path)?;
        let file = rest.file.clone();
        let first = head_line(&mut rest, layout.skip_rows)?;
        let names = first.text.trim_start_matches(['\u{feff}', '#']).trim();
        let delimiter = match layout.delimiter.or_else(|| detect(names)) {
            Some(delimiter) => delimiter,
            None => {
                let start = names.chars().take(60).collect();
                return Err(RecordingError::Delimiter { file, row: first.number, start });
            }
        };
        let cells = delimiter.split(names);
        COLUMNS.allow(cells.len() as u64).map_err(|limit| rest.too_much(limit))?;
        let header = is_header(&cells).then(|| {
            cells.iter().map(|c| c.trim_matches(['"', '\'']).trim().to_string()).collect::<Vec<_>>()
        });
        let width = cells.len();
        let mark = if first.text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let body = if header.is_some() { first.end + 1 } else { first.start + mark };
        rest.put_back(first.block, body);
        let (first_line, decimal_comma) = (first.number, layout.decimal_comma);
        let lines_before_body = first_line - usize::from(header.is_none());
        Ok(Self {
            file,
            delimiter,
            header,
            width,
            first_line,
            lines_before_body,
            decimal_comma,
            rest,
        })
    }

    /// The next whole lines with numbers.
    pub fn next_lines(&mut self) -> Result<Option<&[u8]>, RecordingError> {
        let Some(lines) = self.rest.next()? else { return Ok(None) };
        if self.decimal_comma {
            lines.iter_mut().filter(|b| **b == b',').for_each(|b| *b = b'.');
        }
        Ok(Some(lines))
    }

    /// The next whole lines, which [`Self::next_lines`] gives once more.
    pub fn peek_lines(&mut self) -> Result<Option<&[u8]>, RecordingError> {
        let Some(block) = self.next_lines()?.map(<[u8]>::len) else { return Ok(None) };
        self.rest.put_back(block, 0);
        Ok(Some(self.rest.last(block)))
    }

    /// Bytes of text that were read.
    pub fn bytes(&self) -> u64 {
        self.rest.bytes()
    }

    /// The name of column `c` (from 0) for a message: its header name, else its number from 1.
    pub fn column_name(&self, c: usize) -> String {
        match self.header.as_ref().and_then(|h| h.get(c)) {
            Some(name) => name.clone(),
            None => format!("{}", c + 1),
        }
    }

    /// The header, for messages: all names, or the first few.
    pub fn found_columns(&self) -> String {
        match &self.header {
            None => format!("{} without names", self.width),
            Some(names) if names.len() <= 8 => names.join(", "),
            Some(names) => format!("{}, ... ({} in all)", names[..8].join(", "), names.len()),
        }
    }

    /// Refuses a header in which a name stands twice or a column has none.
    pub fn refuse_duplicates(&self) -> Result<(), RecordingError> {
        let Some(names) = &self.header else { return Ok(()) };
        let mut seen = std::collections::HashMap::new();
        for (c, name) in names.iter().enumerate() {
            if let Some(first) = seen.insert(name, c + 1) {
                return Err(RecordingError::DuplicateColumn {
                    file: self.file.clone(),
                    row: self.first_line,
                    name: name.clone(),
                    first,
                    second: c + 1,
                });
            }
        }
        Ok(())
    }
}

fn refuse_foreign_text(bytes: &[u8], file: &str) -> Result<(), RecordingError> {
    let head = &bytes[..bytes.len().min(4096)];
    let why = match head {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "it is UTF-16",
        _ if head.contains(&0) => "it is binary",
        _ => return Ok(()),
    };
    Err(RecordingError::NotText { file: file.into(), why })
}

/// A line of the block of text that came last.
#[derive(Clone)]
struct Line {
    text: String,
    /// Number of the line, from 1 in the file.
    number: usize,
    /// Beginning and end of the line in the block, and the block's length.
    start: usize,
    end: usize,
    block: usize,
}

/// The first line after `skip` lines that is not blank.
fn first_line(from: &mut Blocks, skip: usize) -> Result<Line, RecordingError> {
    let file = from.file.clone();
    let mut number = 0;
    while let Some(lines) = from.next()? {
        if number == 0 {
            refuse_foreign_text(lines, &file)?;
        }
        let (mut start, block) = (0, lines.len());
        while start < block {
            let end = start + memchr::memchr(b'\n', &lines[start..]).unwrap_or(block - start);
            let line = &lines[start..end];
            number += 1;
            if number > skip && !line.iter().all(u8::is_ascii_whitespace) {
                let text = std::str::from_utf8(line)
                    .map_err(|_| RecordingError::NotText { file, why: "other encoding" })?;
                return Ok(Line { text: text.into(), number, start, end, block });
            }
            start = end + 1;
        }
    }
    Err(RecordingError::Empty { file })
}

/// The first line after `skip` that is not blank. Where it and others begin with `#`: the first that does
/// not, unless it holds numbers and the last comment as many names.
fn head_line(from: &mut Blocks, skip: usize) -> Result<Line, RecordingError> {
    let first = first_line(from, skip)?;
    let lines = from.last(first.block);
    let (mut comment, mut line) = (None, first.clone());
    for _ in 0..MOST_COMMENTS {
        if !line.text.trim_start_matches('\u{feff}').starts_with('#') {
            break;
        }
        let Some(next) = line_after(lines, &line) else { return Ok(first) };
        comment = Some(std::mem::replace(&mut line, next));
    }
    let Some(comment) = comment else { return Ok(first) };
    let row = line.text.trim();
    let names = comment.text.trim_start_matches(['\u{feff}', '#']).trim();
    let width = |line: &str| detect(line).map(|d| d.split(line).len());
    let row_is_header = detect(row).is_some_and(|d| is_header(&d.split(row)));
    let named = width(names).is_some() && width(names) == width(row);
    Ok(if named && !row_is_header { comment } else { line })
}

/// The next line of a block that is not blank; `None` where the block ends or is no text.
fn line_after(lines: &[u8], line: &Line) -> Option<Line> {
    let (mut start, mut number) = (line.end + 1, line.number);
    while start < lines.len() {
        let end = memchr::memchr(b'\n', &lines[start..]).map_or(lines.len(), |n| start + n);
        number += 1;
        if !lines[start..end].iter().all(u8::is_ascii_whitespace) {
            let text = std::str::from_utf8(&lines[start..end]).ok()?.into();
            return Some(Line { text, number, start, end, block: lines.len() });
        }
        start = end + 1;
    }
    None
}

/// Semicolons hint at decimal commas, which only the user can tell: never guessed.
fn detect(line: &str) -> Option<Delimiter> {
    if line.contains(';') {
        None
    } else if line.contains(',') {
        Some(Delimiter::Comma)
    } else if line.contains('\t') {
        Some(Delimiter::Tab)
    } else if line.contains(' ') {
        Some(Delimiter::Blank)
    } else {
        None
    }
}

/// Names, not numbers: fewer than half of the cells can be read as a number.
fn is_header(cells: &[&str]) -> bool {
    let number = |c: &&&str| c.trim_matches(['"', '\'']).replace(',', ".").parse::<f64>().is_ok();
    2 * cells.iter().filter(number).count() < cells.len()
}
