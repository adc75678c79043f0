//! The formats a recording is read from and written to. A new one is a file with an
//! implementation of [`Format`] and a line in [`FORMATS`].

use std::path::Path;

#[cfg(feature = "bags")]
use super::bag;
use super::format::{Format, WriteOptions};
use super::{
    ColumnMap, Recording, RecordingError, bam_json, movement_folder, rtde_csv, sage_folder,
};
#[cfg(feature = "parquet")]
use super::{lerobot, parquet_file};
use crate::files::{guard, is_stream};

/// Text is the last: it reads whatever is left.
pub const FORMATS: &[&dyn Format] = &[
    #[cfg(feature = "bags")]
    &bag::RosBag,
    #[cfg(feature = "parquet")]
    &lerobot::Lerobot,
    #[cfg(feature = "parquet")]
    &parquet_file::Parquet,
    &sage_folder::SageFolder,
    &movement_folder::MovementFolder,
    &bam_json::BamJson,
    &rtde_csv::RtdeCsv,
];

/// Formats that are Cargo features: ending, feature, whether it is built in.
const FEATURES: [(&str, &str, bool); 3] = [
    (".mcap", "bags", cfg!(feature = "bags")),
    (".db3", "bags", cfg!(feature = "bags")),
    (".parquet", "parquet", cfg!(feature = "parquet")),
];

/// The feature that this file needs, where it was left out of the program.
fn left_out(path: &Path) -> Option<&'static str> {
    let name = path.to_string_lossy().to_lowercase();
    let (_, feature, _) =
        FEATURES.into_iter().find(|(ending, _, built)| !built && name.ends_with(ending))?;
    Some(feature)
}

/// Reads a recording in whatever format it is; `columns` is the path of a column map.
pub fn read(path: &Path, columns: Option<&Path>) -> Result<Recording, RecordingError> {
    let map = columns.map(ColumnMap::load).transpose()?;
    read_by(path, map.as_ref())
}

/// Reads like [`read`], by a column map that is at hand.
pub fn read_by(path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
    reader(path)?.read(path, map)
}

/// Reads what is there of a file that is still being written; `None` while that is nothing yet.
pub fn read_unfinished(
    path: &Path,
    map: Option<&ColumnMap>,
) -> Result<Option<Recording>, RecordingError> {
    let format = reader(path)?;
    match path.metadata().is_ok_and(|m| m.len() == 0) {
        true => Ok(None),
        false => format.read_unfinished(path, map),
    }
}

/// The format to read `path` with.
fn reader(path: &Path) -> Result<&'static dyn Format, RecordingError> {
    if !path.exists() {
        return Err(RecordingError::NotFound { file: path.display().to_string() });
    }
    if path.is_dir() {
        guard::reads(path);
    }
    if let Some(feature) = left_out(path) {
        return Err(RecordingError::LeftOut { file: path.display().to_string(), feature });
    }
    let reads = FORMATS.iter().copied().find(|format| format.reads(path));
    reads.ok_or_else(|| unknown_extension(path))
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
