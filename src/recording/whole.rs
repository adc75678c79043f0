//! Text files that are read as one piece, packed by gzip or not.

use std::path::Path;

use super::RecordingError;
use super::blocks::Blocks;
use crate::limits::CHUNK;

/// All of a text file.
///
/// # Errors
/// If it cannot be read, is too large or is not UTF-8.
pub fn whole_text(path: &Path) -> Result<String, RecordingError> {
    let mut blocks = Blocks::open(path)?;
    let mut all = Vec::new();
    while let Some(block) = blocks.next()? {
        all.extend_from_slice(block);
        if let Err(limit) = CHUNK.allow(all.len() as u64) {
            return Err(blocks.too_much(limit));
        }
    }
    String::from_utf8(all).map_err(|_| RecordingError::NotText {
        file: path.display().to_string(),
        why: "some bytes are no characters",
    })
}

/// Does the name of `path` end in one of these, whatever its case?
pub fn ends_in(path: &Path, endings: &[&str]) -> bool {
    let name = path.to_string_lossy().to_lowercase();
    endings.iter().any(|e| name.ends_with(e))
}
