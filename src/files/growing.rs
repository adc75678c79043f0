//! A file that grows for hours and is worth reading at any moment: under a name of its own from the
//! first byte on, under the final one when it is done.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::digest::sha256_of_file;
use super::guard;

/// Is not among what an interruption removes: what it holds cannot be had again.
#[derive(Debug)]
pub struct Growing {
    path: PathBuf,
    out: BufWriter<File>,
}

impl Growing {
    /// Begins a file.
    ///
    /// # Errors
    /// If there is one, which somebody may still want, or the system refuses.
    pub fn begin(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().write(true).create_new(true).open(path).map_err(|e| {
            let there = e.kind() == ErrorKind::AlreadyExists;
            let message = "it is left of one that did not come to its end, and can be read as it is: keep \
                           it under another name, or remove it";
            if there { io::Error::new(e.kind(), message) } else { e }
        })?;
        Ok(Self { path: path.into(), out: BufWriter::with_capacity(1 << 16, file) })
    }

    /// Begins a file, or goes on behind what is in it.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn go_on(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        Ok(Self { path: path.into(), out: BufWriter::with_capacity(1 << 16, file) })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// From now on another program, or the same one after a crash, reads what was written.
    ///
    /// # Errors
    /// If the disk is full.
    pub fn hand_over(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// As [`Growing::hand_over`], and a power failure does not undo it. Waits for the disk.
    ///
    /// # Errors
    /// If the disk is full or broken.
    pub fn settle(&mut self) -> io::Result<()> {
        self.out.flush()?;
        self.out.get_ref().sync_data()
    }

    /// Takes the final name, as armtwin's own file.
    ///
    /// # Errors
    /// If something is there that armtwin did not write, or the system refuses.
    pub fn becomes(mut self, path: &Path) -> io::Result<()> {
        self.settle()?;
        guard::may_write(path)?;
        let path = guard::resolved(path);
        guard::list(&path, sha256_of_file(&self.path)?);
        std::fs::rename(&self.path, path)
    }

    /// Removes it: its rows are somewhere else.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn remove(self) -> io::Result<()> {
        std::fs::remove_file(&self.path)
    }
}

impl Write for Growing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
