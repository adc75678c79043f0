//! Output files that appear under their final name only when whole.

use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Writes through `fill` into a temporary neighbour of `path`, then renames it.
/// On any error nothing is left under `path` that was not there before.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let file = tempfile::NamedTempFile::new_in(folder)?;
    let mut buffer = BufWriter::with_capacity(1 << 16, file);
    fill(&mut buffer)?;
    let file = buffer.into_inner().map_err(io::IntoInnerError::into_error)?;
    make_readable(file.as_file())?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

/// As [`write_whole`], for writers that want a file: `fill` gets a new one beside `path`, which takes
/// its place if all went well.
pub fn replace_whole<E>(
    path: &Path,
    fill: impl FnOnce(&tempfile::NamedTempFile) -> Result<(), E>,
) -> io::Result<Result<(), E>> {
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let file = tempfile::NamedTempFile::new_in(folder)?;
    if let Err(error) = fill(&file) {
        return Ok(Err(error));
    }
    make_readable(file.as_file())?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(Ok(()))
}

/// Temporary files are private to their owner; results are not.
#[cfg(unix)]
fn make_readable(file: &std::fs::File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_: &std::fs::File) -> io::Result<()> {
    Ok(())
}
