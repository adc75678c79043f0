//! A delimited text file in memory: gzip, byte order mark, header line and delimiter found out.

use std::io::Read;
use std::path::Path;

use super::RecordingError;
use super::file::cannot;

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
#[derive(Debug)]
pub struct Text {
    pub file: String,
    pub bytes: Vec<u8>,
    pub delimiter: Delimiter,
    /// Column names, where the first line holds names.
    pub header: Option<Vec<String>>,
    /// Columns of the first line.
    pub width: usize,
    /// Line number (from 1) of the first line that is not blank.
    pub first_line: usize,
    /// Where the numbers begin, and the number of lines before.
    pub body: usize,
    pub lines_before_body: usize,
}

impl Text {
    pub fn open(path: &Path, layout: &Layout) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        Self::from_bytes(load(path)?, file, layout)
    }

    fn from_bytes(
        mut bytes: Vec<u8>,
        file: String,
        layout: &Layout,
    ) -> Result<Self, RecordingError> {
        refuse_foreign_text(&bytes, &file)?;
        let Some((start, end, line)) = head_line(&bytes, layout.skip_rows) else {
            return Err(RecordingError::Empty { file });
        };
        let first = std::str::from_utf8(&bytes[start..end])
            .map_err(|_| RecordingError::NotText { file: file.clone(), why: "other encoding" })?
            .trim_start_matches(['\u{feff}', '#'])
            .trim()
            .to_string();
        let delimiter = match layout.delimiter.or_else(|| detect(&first)) {
            Some(delimiter) => delimiter,
            None => {
                let start = first.chars().take(60).collect();
                return Err(RecordingError::Delimiter { file, row: line, start });
            }
        };
        if layout.decimal_comma {
            bytes[end..].iter_mut().filter(|b| **b == b',').for_each(|b| *b = b'.');
        }
        let cells = delimiter.split(&first);
        let header = is_header(&cells).then(|| {
            cells.iter().map(|c| c.trim_matches(['"', '\'']).trim().to_string()).collect::<Vec<_>>()
        });
        let width = cells.len();
        let (body, lines_before_body) =
            if header.is_some() { ((end + 1).min(bytes.len()), line) } else { (start, line - 1) };
        if layout.decimal_comma && header.is_none() {
            bytes[start..end].iter_mut().filter(|b| **b == b',').for_each(|b| *b = b'.');
        }
        let body = if header.is_none() && bytes[body..].starts_with(b"\xef\xbb\xbf") {
            body + 3
        } else {
            body
        };
        let (first_line, lines_before_body) = (line, lines_before_body);
        Ok(Self { file, bytes, delimiter, header, width, first_line, body, lines_before_body })
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

/// Reads a file whole, through gzip where its first bytes say so.
fn load(path: &Path) -> Result<Vec<u8>, RecordingError> {
    let file = path.display().to_string();
    let bytes = std::fs::read(path).map_err(cannot(path, "read"))?;
    if bytes.is_empty() {
        return Err(RecordingError::Empty { file });
    }
    let named_gz = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    if !bytes.starts_with(&[0x1f, 0x8b]) && !named_gz {
        return Ok(bytes);
    }
    let mut text = Vec::with_capacity(bytes.len() * 4);
    match flate2::read::MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut text) {
        Ok(_) => Ok(text),
        Err(source) => Err(RecordingError::Gzip { file, source }),
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

/// Start, end and number (from 1) of the first line after `skip` lines that is not blank.
fn first_line(bytes: &[u8], skip: usize) -> Option<(usize, usize, usize)> {
    let mut start = 0;
    for line in 1.. {
        let rest = bytes.get(start..).filter(|r| !r.is_empty())?;
        let end = start + memchr::memchr(b'\n', rest).unwrap_or(rest.len());
        if line > skip && !bytes[start..end].iter().all(u8::is_ascii_whitespace) {
            return Some((start, end, line));
        }
        start = end + 1;
    }
    None
}

/// The first line after `skip` that is not blank. Where it and others begin with `#`: the first that does
/// not, unless it holds numbers and the last comment as many names.
fn head_line(bytes: &[u8], skip: usize) -> Option<(usize, usize, usize)> {
    let text = |(start, end, _): (usize, usize, usize)| {
        String::from_utf8_lossy(&bytes[start..end])
            .trim()
            .trim_start_matches('\u{feff}')
            .to_string()
    };
    let first = first_line(bytes, skip)?;
    let (mut comment, mut line) = (None, first);
    for _ in 0..MOST_COMMENTS {
        if !text(line).starts_with('#') {
            break;
        }
        comment = Some(line);
        line = match first_line(bytes, line.2) {
            Some(next) => next,
            None => return Some(first),
        };
    }
    let Some(comment) = comment else { return Some(first) };
    let (row, names) = (text(line), text(comment));
    let names = names.trim_start_matches('#').trim();
    let width = |line: &str| detect(line).map(|d| d.split(line).len());
    let row_is_header = detect(&row).is_some_and(|d| is_header(&d.split(&row)));
    let named = width(names).is_some() && width(names) == width(&row);
    Some(if named && !row_is_header { comment } else { line })
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
