//! Files of recordings on the disk, with the messages people get.

#[cfg(any(feature = "bags", feature = "parquet"))]
use std::error::Error;
#[cfg(any(feature = "bags", feature = "parquet"))]
use std::fs::File;
use std::io;
use std::path::Path;

use super::RecordingError;

/// Why a file cannot be `action`: "read" or "written".
pub fn cannot(path: &Path, action: &'static str) -> impl Fn(io::Error) -> RecordingError {
    let file = path.display().to_string();
    move |source| match source.kind() {
        io::ErrorKind::NotFound if action == "read" => {
            RecordingError::NotFound { file: file.clone() }
        }
        _ => RecordingError::Io { file: file.clone(), action, source },
    }
}

/// What a library says of a file that it could not write.
#[cfg(any(feature = "bags", feature = "parquet"))]
pub fn unwritten(path: &Path, why: impl Into<Box<dyn Error + Send + Sync>>) -> RecordingError {
    cannot(path, "written")(io::Error::other(why))
}

/// Opens a file that must hold something.
#[cfg(any(feature = "bags", feature = "parquet"))]
pub fn open(path: &Path) -> Result<File, RecordingError> {
    let file = File::open(path).map_err(cannot(path, "read"))?;
    match file.metadata().map_err(cannot(path, "read"))?.len() {
        0 => Err(RecordingError::Empty { file: path.display().to_string() }),
        _ => Ok(file),
    }
}

/// Writes a file, whole or not at all, for writers that want a file of their own: `fill` gets a new
/// one and its path.
#[cfg(any(feature = "bags", feature = "parquet"))]
pub fn replace(
    path: &Path,
    fill: impl FnOnce(File, &Path) -> Result<(), RecordingError>,
) -> Result<(), RecordingError> {
    let cannot = cannot(path, "written");
    crate::files::replace_whole(path, |file| fill(file.reopen().map_err(&cannot)?, file.path()))
        .map_err(&cannot)?
}
