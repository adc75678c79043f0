//! What a file format must be able to do.

use std::path::Path;

use super::{ColumnMap, Delimiter, Recording, RecordingError};

/// Contract of a file format.
pub trait Format: Sync {
    fn name(&self) -> &'static str;
    /// Whether this is the format to read `path` with; the first in [`super::FORMATS`] that says yes does.
    fn reads(&self, path: &Path) -> bool;
    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError>;
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
