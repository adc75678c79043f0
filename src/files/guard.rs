//! What a run may write over: files that armtwin wrote and nobody changed since, if the run does not
//! read them.
//!
//! Every folder that armtwin writes into has a list `.armtwin` of SHA-256 and name (`sha256sum -c
//! .armtwin` reads it): what it says is armtwin's as long as it reads so, in whatever format, in a
//! folder that is moved or copied as well. Without the list nothing is armtwin's.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::digest::sha256_of_file;

const LIST: &str = ".armtwin";
const HEAD: &str = "# Files that armtwin wrote here. It replaces them as long as they read so.\n";

/// Why a file is not written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    #[error("this command reads it and would destroy it; name another output")]
    Input,
    #[error(
        "is there already, and not as armtwin wrote it; name another output, or replace it by \
         --overwrite"
    )]
    Foreign,
    #[error("is a folder; name a file")]
    Folder,
    #[error("there is no folder {}; make it first", .0.display())]
    NoFolder(PathBuf),
}

impl From<Refused> for io::Error {
    fn from(refused: Refused) -> Self {
        Self::new(ErrorKind::AlreadyExists, refused)
    }
}

/// This run of the program.
#[derive(Default)]
struct Run {
    reads: BTreeSet<PathBuf>,
    overwrites: bool,
}

static RUN: Mutex<Run> = Mutex::new(Run { reads: BTreeSet::new(), overwrites: false });

fn run() -> MutexGuard<'static, Run> {
    RUN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on files that armtwin did not write may be written over, but none that is read.
pub fn overwrite() {
    run().overwrites = true;
}

/// From now on `path` is not written over; of a folder, none of the files that are in it.
pub fn reads(path: &Path) {
    let inside = fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    run().reads.extend(inside.chain([path.into()]));
}

/// Asked before work begins whose result could not be written, and again by whoever writes.
///
/// # Errors
/// Says why not.
pub fn may_write(path: &Path) -> Result<(), Refused> {
    if super::is_stream(path) {
        return Ok(());
    }
    let path = resolved(path);
    let Ok(there) = fs::metadata(&path) else {
        let folder = folder_of(&path);
        return if folder.is_dir() { Ok(()) } else { Err(Refused::NoFolder(folder.into())) };
    };
    let run = run();
    match () {
        () if there.is_dir() => Err(Refused::Folder),
        () if run.reads.iter().any(|read| is_same(read, &path)) => Err(Refused::Input),
        // Who makes an empty file for the result has nothing to lose by it.
        () if run.overwrites || there.len() == 0 || is_listed(&path) => Ok(()),
        () => Err(Refused::Foreign),
    }
}

/// Where a name leads: a link stays one, and the file it names is written.
pub fn resolved(path: &Path) -> PathBuf {
    let dangling = || fs::read_link(path).map(|to| folder_of(path).join(to));
    let name = path.file_name().unwrap_or_default();
    let new = || fs::canonicalize(folder_of(path)).map(|folder| folder.join(name));
    let there = fs::canonicalize(path);
    there.or_else(|_| dangling()).or_else(|_| new()).unwrap_or_else(|_| path.into())
}

pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// By whatever names, hard links among them.
#[cfg(unix)]
fn is_same(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |path| fs::metadata(path).map(|m| (m.dev(), m.ino())).ok();
    place(a).is_some() && place(a) == place(b)
}

#[cfg(not(unix))]
fn is_same(a: &Path, b: &Path) -> bool {
    matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// (name, digest) of the list in `folder`.
fn listed(folder: &Path) -> Vec<(String, String)> {
    let text = fs::read_to_string(folder.join(LIST)).unwrap_or_default();
    let lines = text.lines().filter_map(|line| line.split_once("  "));
    lines.map(|(digest, name)| (name.into(), digest.into())).collect()
}

fn is_listed(path: &Path) -> bool {
    let name = name_of(path);
    let mut own = listed(folder_of(path)).into_iter().filter(|l| l.0 == name).peekable();
    own.peek().is_some()
        && sha256_of_file(path).is_ok_and(|found| own.any(|(_, digest)| digest == found))
}

/// Notes that `path` will read so, beside what it reads now. Where the list cannot be written, the file
/// is somebody else's afterwards, which costs a flag and loses nothing.
pub fn list(path: &Path, digest: String) {
    let folder = folder_of(path);
    // Released with the handle; several programs may write into the folder.
    let lock = File::open(folder);
    let _ = lock.as_ref().map(File::lock);
    let mut all = listed(folder);
    let line = (name_of(path), digest);
    if !all.contains(&line) {
        let now = all.iter().rposition(|l| l.0 == line.0).map(|at| all[at].clone());
        all.retain(|l| l.0 != line.0);
        all.extend(now.into_iter().chain([line]));
        all.sort_by(|a, b| a.0.cmp(&b.0));
        let _ = write(folder, &all);
    }
}

fn write(folder: &Path, all: &[(String, String)]) -> io::Result<()> {
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    let lines = all.iter().map(|(name, digest)| format!("{digest}  {name}\n"));
    file.write_all((HEAD.to_string() + &lines.collect::<String>()).as_bytes())?;
    super::make_readable(file.as_file())?;
    file.persist(folder.join(LIST)).map(drop).map_err(|e| e.error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::write_whole;

    fn put(path: &Path, text: &str) -> io::Result<()> {
        write_whole(path, |out| out.write_all(text.as_bytes()))
    }

    #[test]
    fn a_file_is_armtwins_until_somebody_changes_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("twin.toml");
        put(&file, "one").unwrap();
        put(&file, "two").unwrap();
        fs::write(&file, "three").unwrap();
        assert_eq!(may_write(&file), Err(Refused::Foreign));
        assert_eq!(put(&file, "four").unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(fs::read_to_string(&file).unwrap(), "three");
        // What it wrote the last time but one is put back: nobody's work is lost.
        fs::write(&file, "one").unwrap();
        put(&file, "five").unwrap();
        fs::remove_file(folder.path().join(LIST)).unwrap();
        assert_eq!(may_write(&file), Err(Refused::Foreign));
    }

    /// Killed after the list was written and before the file took its place.
    #[test]
    fn the_list_knows_what_is_there_and_what_comes() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.csv");
        put(&file, "old").unwrap();
        list(&file, "f00d".into());
        assert_eq!(may_write(&file), Ok(()));
        put(&folder.path().join("b.csv"), "new").unwrap();
        let names: Vec<String> = listed(folder.path()).into_iter().map(|l| l.0).collect();
        assert_eq!(names, ["a.csv", "a.csv", "b.csv"]);
    }

    #[test]
    fn what_is_read_is_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("log.csv");
        put(&inside, "made here").unwrap();
        reads(folder.path());
        assert_eq!(may_write(&folder.path().join("./log.csv")), Err(Refused::Input));
        assert_eq!(may_write(&folder.path().join("other.csv")), Ok(()));
        let none = folder.path().join("none");
        assert_eq!(may_write(&none.join("a.csv")), Err(Refused::NoFolder(none)));
    }
}
