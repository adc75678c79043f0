//! What a file format must be able to do.

use std::path::Path;

use super::{ColumnMap, Delimiter, Recording, RecordingError};

/// Contract of a file format.
pub trait Format: Sync {
    fn name(&self) -> &'static str;
    /// Whether this is the format to read `path` with; the first in [`super::FORMATS`] that says yes does.
    fn reads(&self, path: &Path) -> bool;
    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError>;
    /// What is in a file that is still being written; `None` while that is nothing yet.
    fn read_unfinished(
        &self,
        path: &Path,
        map: Option<&ColumnMap>,
    ) -> Result<Option<Recording>, RecordingError> {
        self.read(path, map).map(Some)
    }
    /// Endings of file names it is written under; empty if it is only read.
    fn extensions(&self) -> &'static [&'static str] {
        &[]
    }
    /// Called for a `path` with one of [`Format::extensions`] alone.
    fn write(
        &self,
        _recording: &Recording,
        path: &Path,
        _options: &WriteOptions,
    ) -> Result<(), RecordingError> {
        let (file, known) = (path.display().to_string(), self.extensions().join(", "));
        Err(RecordingError::UnknownExtension { file, known })
    }
}

#[derive(Debug, Clone, Default)]
pub struct WriteOptions {
    /// Comma if not given.
    pub delimiter: Option<Delimiter>,
}

/// Formats that say themselves what is in them take no column map.
///
/// # Errors
/// If there is one; `why` it has no use, in words.
pub fn refuse_map(map: Option<&ColumnMap>, why: impl Fn() -> String) -> Result<(), RecordingError> {
    match map {
        None => Ok(()),
        Some(map) => Err(RecordingError::ColumnMap { file: map.file.clone(), what: why() }),
    }
}
