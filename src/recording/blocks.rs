//! The text of a file in blocks of whole lines, through gzip where its first bytes say so: never more
//! than a block of it is in memory.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::rc::Rc;

use flate2::bufread::MultiGzDecoder;

use super::RecordingError;
use super::file::cannot;
use crate::limits::{Expansion, LINE, TEXT, TooMuch};

const BLOCK: usize = LINE.most as usize;
const GZIP: &[u8] = &[0x1f, 0x8b];

pub struct Blocks {
    pub file: String,
    from: Box<dyn Read>,
    packed: bool,
    buffer: Vec<u8>,
    /// What of the buffer was not given out begins here, ...
    at: usize,
    /// ... and here its last whole line ends.
    whole: usize,
    ended: bool,
    /// Bytes of text that were read so far.
    bytes: u64,
}

impl Blocks {
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        let taken = Rc::new(Cell::new(0));
        let opened = File::open(path).map_err(cannot(path, "read"))?;
        let mut from =
            BufReader::with_capacity(1 << 16, Counted { from: opened, count: taken.clone() });
        let first = from.fill_buf().map_err(cannot(path, "read"))?;
        if first.is_empty() {
            return Err(RecordingError::Empty { file });
        }
        let named = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
        let packed = first.starts_with(GZIP) || named;
        let from: Box<dyn Read> = match packed {
            true => {
                let from = MultiGzDecoder::new(from);
                Box::new(Unpacked { from, taken, expansion: Expansion::default() })
            }
            false => Box::new(from),
        };
        let buffer = Vec::with_capacity(BLOCK);
        Ok(Self { file, from, packed, buffer, at: 0, whole: 0, ended: false, bytes: 0 })
    }

    /// The next whole lines; the last line of the file may have no end.
    pub fn next(&mut self) -> Result<Option<&mut [u8]>, RecordingError> {
        if self.at == self.whole && !self.ended {
            self.fill()?;
        }
        let lines = self.at..self.whole;
        self.at = self.whole;
        Ok(Some(&mut self.buffer[lines]).filter(|lines| !lines.is_empty()))
    }

    /// Gives back all but the first `used` bytes of the `block` that came last: they come again.
    pub fn put_back(&mut self, block: usize, used: usize) {
        self.at = self.whole - block + used.min(block);
    }

    /// The block of this length that came last.
    pub fn last(&self, block: usize) -> &[u8] {
        &self.buffer[self.whole - block..self.whole]
    }

    /// Bytes of text that were read so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    fn fill(&mut self) -> Result<(), RecordingError> {
        self.buffer.drain(..self.whole);
        let room = BLOCK - self.buffer.len();
        let read = (&mut self.from).take(room as u64).read_to_end(&mut self.buffer);
        let read = read.map_err(|e| self.unreadable(e))?;
        self.bytes += read as u64;
        TEXT.allow(self.bytes).map_err(|limit| self.too_much(limit))?;
        self.ended = read < room;
        let end = memchr::memrchr(b'\n', &self.buffer).map(|end| end + 1);
        self.at = 0;
        self.whole = match end {
            _ if self.ended => self.buffer.len(),
            Some(end) => end,
            None => return Err(self.too_much(TooMuch(&LINE))),
        };
        Ok(())
    }

    pub fn too_much(&self, limit: TooMuch) -> RecordingError {
        RecordingError::TooMuch { file: self.file.clone(), limit }
    }

    fn unreadable(&self, error: io::Error) -> RecordingError {
        let file = self.file.clone();
        match error.get_ref().and_then(|e| e.downcast_ref::<TooMuch>()) {
            Some(limit) => self.too_much(*limit),
            None if self.packed => RecordingError::Gzip { file, source: error },
            None => RecordingError::Io { file, action: "read", source: error },
        }
    }
}

/// Counts what is read.
struct Counted<R> {
    from: R,
    count: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        let read = self.from.read(room)?;
        self.count.set(self.count.get() + read as u64);
        Ok(read)
    }
}

/// Compares what comes out with what went in.
struct Unpacked<R> {
    from: R,
    taken: Rc<Cell<u64>>,
    expansion: Expansion,
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        let read = self.from.read(room)?;
        self.expansion.take(self.taken.replace(0));
        self.expansion.make(read as u64).map_err(io::Error::other)?;
        Ok(read)
    }
}
