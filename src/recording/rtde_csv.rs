//! CSV with RTDE names: a header with `timestamp` and names such as `actual_q_0`; comma, blank or
//! tab; plain or gzip. As the manufacturer's client writes it (blank) and ur_rtde (comma).

use std::io::{self, Write};
use std::path::Path;

use super::check::{count_from_zero, refuse_bad};
use super::file::cannot;
use super::format::{Format, WriteOptions};
use super::text::{Layout, Text};
use super::{
    Channel, ColumnMap, Delimiter, Provenance, Recording, RecordingError, mapped_csv, table,
};
use crate::files::{write_own, write_whole};

pub const TIME: &str = "timestamp";

pub struct RtdeCsv;

impl Format for RtdeCsv {
    fn name(&self) -> &'static str {
        "RTDE CSV"
    }

    fn reads(&self, _path: &Path) -> bool {
        true
    }

    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
        match map {
            Some(map) => mapped_csv::read(path, map),
            None => read(path),
        }
    }

    fn extensions(&self) -> &'static [&'static str] {
        &[".csv", ".csv.gz"]
    }

    fn write(
        &self,
        recording: &Recording,
        path: &Path,
        options: &WriteOptions,
    ) -> Result<(), RecordingError> {
        let delimiter = options.delimiter.unwrap_or(Delimiter::Comma);
        write_whole(path, |out| write(recording, path, delimiter, out))
            .map_err(cannot(path, "written"))
    }
}

fn read(path: &Path) -> Result<Recording, RecordingError> {
    let mut text = Text::open(path, &Layout::default())?;
    text.refuse_duplicates()?;
    let Some(mut names) = text.header.clone() else {
        let (file, row, columns) = (text.file, text.first_line, text.width);
        return Err(RecordingError::NoHeader { file, row, columns });
    };
    let Some(time) = names.iter().position(|n| n == TIME) else {
        return Err(RecordingError::MissingColumn {
            column: TIME.into(),
            found: text.found_columns(),
            file: text.file,
            remedy: "rename the time column, or map the columns by name (--columns)",
        });
    };
    let mut wanted: Vec<usize> = (0..names.len()).filter(|c| *c != time).collect();
    wanted.insert(0, time);
    let mut table = table::read(&mut text, &wanted)?;
    table.notes.extend(count_from_zero(&mut names));
    let mut columns = std::mem::take(&mut table.columns).into_iter();
    let recording = Recording {
        time: columns.next().unwrap_or_default(),
        channels: wanted[1..]
            .iter()
            .zip(columns)
            .map(|(c, values)| Channel { name: names[*c].clone(), values })
            .collect(),
        provenance: Provenance {
            source: text.file.clone(),
            format: format!("RTDE CSV, {}", text.delimiter.name()),
            notes: table.notes,
        },
    };
    refuse_bad(&recording, TIME, &table.lines)?;
    Ok(recording)
}

/// Writes comma-separated RTDE CSV, time first, gzip where the name ends in `.gz`, into a folder that is
/// the caller's own. Every number is the shortest that reads back as the same bits.
pub fn write_csv(recording: &Recording, path: &Path) -> Result<(), RecordingError> {
    let filled = |out: &mut dyn Write| write(recording, path, Delimiter::Comma, out);
    write_own(path, filled).map_err(cannot(path, "written"))
}

fn write(
    recording: &Recording,
    path: &Path,
    delimiter: Delimiter,
    out: &mut dyn Write,
) -> io::Result<()> {
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("gz")) {
        return write_rows(recording, delimiter, out);
    }
    let mut packer = flate2::write::GzEncoder::new(out, flate2::Compression::default());
    write_rows(recording, delimiter, &mut io::BufWriter::new(&mut packer))?;
    packer.finish().map(drop)
}

fn write_rows(recording: &Recording, delimiter: Delimiter, out: &mut dyn Write) -> io::Result<()> {
    let mark = [delimiter.byte()];
    write!(out, "{TIME}")?;
    for channel in &recording.channels {
        out.write_all(&mark)?;
        out.write_all(channel.name.as_bytes())?;
    }
    for (k, time) in recording.time.iter().enumerate() {
        out.write_all(b"\n")?;
        write_number(*time, out)?;
        for channel in &recording.channels {
            out.write_all(&mark)?;
            write_number(channel.values[k], out)?;
        }
    }
    out.write_all(b"\n")?;
    out.flush()
}

/// Plain digits where they are short, an exponent elsewhere.
pub fn write_number(value: f64, out: &mut dyn Write) -> io::Result<()> {
    if value == 0.0 || (1e-5..1e16).contains(&value.abs()) {
        write!(out, "{value}")
    } else {
        write!(out, "{value:e}")
    }
}
