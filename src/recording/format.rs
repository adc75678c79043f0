//! The formats a recording is read from and written to. A new one is a file with an
//! implementation of [`Format`] and a line in [`FORMATS`].

use std::path::Path;

use super::{
    ColumnMap, Delimiter, Recording, RecordingError, bag, bam_json, lerobot, movement_folder,
    parquet_file, rtde_csv, sage_folder,
};
use crate::files::{guard, is_stream};

/// Contract of a file format.
pub trait Format: Sync {
    fn name(&self) -> &'static str;
    /// Whether this is the format to read `path` with; the first in [`FORMATS`] that says yes does.
    fn reads(&self, path: &Path) -> bool;
    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError>;
    /// Endings of file names it is written under; empty if it is only read.
    fn extensions(&self) -> &'static [&'static str] {
        &[]
    }
    /// Called for a `path` with one of [`Format::extensions`].
    fn write(
        &self,
        _recording: &Recording,
        path: &Path,
        _options: &WriteOptions,
    ) -> Result<(), RecordingError> {
        Err(unknown_extension(path))
    }
}

/// Text is the last: it reads whatever is left.
pub const FORMATS: &[&dyn Format] = &[
    &bag::RosBag,
    &lerobot::Lerobot,
    &parquet_file::Parquet,
    &sage_folder::SageFolder,
    &movement_folder::MovementFolder,
    &bam_json::BamJson,
    &rtde_csv::RtdeCsv,
];

#[derive(Debug, Clone, Default)]
pub struct WriteOptions {
    /// Comma if not given.
    pub delimiter: Option<Delimiter>,
}

/// Reads a recording in whatever format it is; `columns` is the path of a column map.
pub fn read(path: &Path, columns: Option<&Path>) -> Result<Recording, RecordingError> {
    let map = columns.map(ColumnMap::load).transpose()?;
    read_by(path, map.as_ref())
}

/// Reads like [`read`], by a column map that is at hand.
pub fn read_by(path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
    if !path.exists() {
        return Err(RecordingError::NotFound { file: path.display().to_string() });
    }
    if path.is_dir() {
        guard::reads(path);
    }
    for format in FORMATS {
        if format.reads(path) {
            return format.read(path, map);
        }
    }
    Err(unknown_extension(path))
}

/// The format that writes under the name of `path`, CSV into what has none, such as a pipe; checked before
/// work begins.
pub fn writer(path: &Path) -> Result<&'static dyn Format, RecordingError> {
    let name = path.to_string_lossy().to_lowercase();
    let fits = |f: &&dyn Format| f.extensions().iter().any(|e| name.ends_with(e));
    let stream: Option<&dyn Format> = if is_stream(path) { Some(&rtde_csv::RtdeCsv) } else { None };
    FORMATS.iter().copied().find(fits).or(stream).ok_or_else(|| unknown_extension(path))
}

/// Writes a recording in the format its file name ends in; whole or not at all.
pub fn write(
    recording: &Recording,
    path: &Path,
    options: &WriteOptions,
) -> Result<(), RecordingError> {
    writer(path)?.write(recording, path, options)
}

fn unknown_extension(path: &Path) -> RecordingError {
    let known: Vec<_> = FORMATS.iter().flat_map(|f| f.extensions()).copied().collect();
    RecordingError::UnknownExtension { file: path.display().to_string(), known: known.join(", ") }
}
