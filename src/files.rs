//! Output files: under their final name only when whole, over nothing that armtwin did not write
//! ([`guard`]), and without a trace of them where the program is interrupted.

mod digest;
mod growing;
pub mod guard;

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

pub use digest::{sha256, sha256_of_file};
pub use growing::Growing;
pub use guard::may_write;

/// Writes through `fill` into a temporary neighbour of `path`, then renames it. Standard output (`-`),
/// pipes and devices are written as they are.
///
/// # Errors
/// If [`may_write`] refuses `path`, or the system does; nothing is left under `path` then that was not
/// there before.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    if is_stream(path) {
        return stream(path, fill);
    }
    may_write(path)?;
    let path = &guard::resolved(path);
    filled(path, fill)?.becomes(path, true)
}

/// Like [`write_whole`] for a folder whose owner knows what lies there, or has just made it: whatever
/// is there under the name is replaced, and no list is kept.
///
/// # Errors
/// If the system refuses.
pub fn write_own(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    filled(path, fill)?.becomes(path, false)
}

/// Like [`write_whole`], for writers that want a file: `fill` gets a new one.
///
/// # Errors
/// As [`write_whole`]; the inner ones are those of `fill`.
pub fn replace_whole<E>(
    path: &Path,
    fill: impl FnOnce(&NamedTempFile) -> Result<(), E>,
) -> io::Result<Result<(), E>> {
    let piped = is_stream(path);
    if !piped {
        may_write(path)?;
    }
    let path = &guard::resolved(path);
    let scratch = std::env::temp_dir().join("armtwin");
    let temporary = Temporary::beside(if piped { &scratch } else { path })?;
    if let Err(error) = fill(temporary.file()?) {
        return Ok(Err(error));
    }
    match piped {
        true => stream(path, |out| io::copy(&mut temporary.file()?.reopen()?, out).map(drop))?,
        false => temporary.becomes(path, true)?,
    }
    Ok(Ok(()))
}

/// Standard output.
pub fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name))
}

/// What has no name that a file could take: standard output, what the shell opened, pipes, devices.
pub fn is_stream(path: &Path) -> bool {
    let opened = ["/dev/stderr", "/dev/fd", "/proc/self/fd"].iter().any(|of| path.starts_with(of));
    let other = || fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir());
    is_stdout(path) || opened || other()
}

/// A reader that has seen enough is no error.
fn stream(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let out: Box<dyn Write> = match is_stdout(path) {
        true => Box::new(io::stdout()),
        false => Box::new(OpenOptions::new().append(true).open(path)?),
    };
    let mut out = BufWriter::with_capacity(1 << 16, out);
    match fill(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done,
    }
}

fn filled(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<Temporary> {
    let temporary = Temporary::beside(path)?;
    let mut buffer = BufWriter::with_capacity(1 << 16, temporary.file()?.as_file());
    fill(&mut buffer)?;
    buffer.flush()?;
    drop(buffer);
    Ok(temporary)
}

/// Files that are being written, under their temporary names.
static OPEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn open_files() -> MutexGuard<'static, Vec<PathBuf>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is being written. The program must end now: who writes waits for ever.
pub fn abandon() {
    let open = open_files();
    for path in open.iter() {
        // Who cannot remove it has lost nothing by it.
        let _ = fs::remove_file(path);
    }
    std::mem::forget(open);
}

/// A new file beside the one it may become; gone when dropped before, or abandoned.
struct Temporary(Option<NamedTempFile>);

impl Temporary {
    fn beside(path: &Path) -> io::Result<Self> {
        let mut open = open_files();
        let file = NamedTempFile::new_in(guard::folder_of(path)).map_err(unnamed)?;
        open.push(file.path().into());
        Ok(Self(Some(file)))
    }

    fn file(&self) -> io::Result<&NamedTempFile> {
        self.0.as_ref().ok_or_else(|| ErrorKind::NotFound.into())
    }

    /// Takes the place of `path`, which is `listed` as armtwin's from then on.
    fn becomes(mut self, path: &Path, listed: bool) -> io::Result<()> {
        let digest = if listed { Some(sha256_of_file(self.file()?.path())?) } else { None };
        make_readable(self.file()?.as_file())?;
        // Held, so that an interruption comes before all of it or after.
        let mut open = open_files();
        let Some(file) = self.0.take() else { return Ok(()) };
        open.retain(|other| other != file.path());
        if let Some(digest) = digest {
            guard::list(path, digest);
        }
        file.persist(path).map(drop).map_err(|e| e.error)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(file) = self.0.take() {
            let mut open = open_files();
            open.retain(|other| other != file.path());
            drop(file);
        }
    }
}

/// Without the name of a temporary file, which nobody asked for.
fn unnamed(e: io::Error) -> io::Error {
    match e.to_string().split_once(" at path ") {
        Some((said, _)) => io::Error::new(e.kind(), said.to_string()),
        None => e,
    }
}

/// Temporary files are private to their owner; results are not.
#[cfg(unix)]
fn make_readable(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_: &File) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_names_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = NamedTempFile::new_in(folder.path().join("none")).unwrap_err();
        assert!(error.to_string().contains(".tmp"), "{error}");
        assert!(!unnamed(error).to_string().contains(".tmp"));
    }
}
