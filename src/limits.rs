//! What a file may ask of its reader: one limit for each thing that a file can announce or repeat, with
//! a message and a reason. Nothing is made room for because a file says so: counts are of what was read.
//!
//! Reading takes at most three times the memory of the numbers that come out of it (8 bytes each, with
//! time and row numbers), and 64 MB besides.

use std::io::{self, Read};

/// How much of something is read at most.
#[derive(Debug, PartialEq, Eq)]
pub struct Limit {
    pub most: u64,
    /// What is counted, after the number: "rows in a recording".
    pub of: &'static str,
    /// What makes it enough.
    pub why: &'static str,
    pub remedy: &'static str,
}

/// A file asked for more than a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it has more than {} {}; {}", grouped(.0.most), .0.of, .0.remedy)]
pub struct TooMuch(pub &'static Limit);

/// With blanks between thousands.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let parts: Vec<_> = digits.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy).collect();
    parts.join(" ")
}

impl Limit {
    /// # Errors
    /// If `count` is beyond the limit.
    pub fn allow(&'static self, count: u64) -> Result<(), TooMuch> {
        if count > self.most { Err(TooMuch(self)) } else { Ok(()) }
    }
}

pub static ROWS: Limit = Limit {
    most: 5_000_000,
    of: "rows in a recording",
    why: "83 minutes at 1 kHz; half a minute to a minute is enough for a diagnosis",
    remedy: "cut it into shorter recordings",
};
pub static COLUMNS: Limit = Limit {
    most: 2_000,
    of: "columns in a recording",
    why: "all that a UR controller sends is some 300",
    remedy: "write the columns that are needed to a file of their own",
};
pub static NUMBERS: Limit = Limit {
    most: 100_000_000,
    of: "numbers in a recording",
    why: "0.8 GB: 55 columns for an hour at 500 Hz",
    remedy: "cut it, or take fewer columns with a column map (--columns)",
};
pub static LINE: Limit = Limit {
    most: 1 << 22,
    of: "bytes in a line of text",
    why: "2 000 columns of 20 characters take 40 kB",
    remedy: "check that this is a table with one sample in a line",
};
pub static TEXT: Limit = Limit {
    most: 1 << 32,
    of: "bytes of text",
    why: "40 for each of the numbers that are read at most",
    remedy: "cut it, or leave columns out of it",
};
pub static EXPANSION: Limit = Limit {
    most: 1_000,
    of: "times its own size once unpacked (beyond 64 MB)",
    why: "gzip packs no better, and columns that never change come to some hundred",
    remedy: "it is no recording, or unpack it and take what is needed of it",
};
pub static CHUNK: Limit = Limit {
    most: 1 << 28,
    of: "bytes in a record or chunk of a bag",
    why: "recorders close a chunk at 1 to 16 MB",
    remedy: "write the bag again with smaller chunks, or record the joints alone",
};
pub static MESSAGE: Limit = Limit {
    most: 1 << 20,
    of: "bytes in a message of a joint topic",
    why: "a state of 256 joints with long names takes 20 kB",
    remedy: "record the arm's joints on a topic of their own",
};
pub static JOINTS: Limit = Limit {
    most: 256,
    of: "joints in a message",
    why: "a humanoid with two hands has some 70",
    remedy: "record the arm's joints on a topic of their own",
};
pub static TOPICS: Limit = Limit {
    most: 10_000,
    of: "topics in a bag",
    why: "a large robot has some hundred",
    remedy: "record the joints alone",
};
pub static STEPS: Limit = Limit {
    most: 10,
    of: "steps of SQLite for each of its bytes (beyond a hundred thousand)",
    why: "to pass a message takes some 10 steps, and it has 20 bytes or more",
    remedy: "its tables lead in circles; mend it with `sqlite3 FILE .recover`",
};
pub static FOOTER: Limit = Limit {
    most: 1 << 23,
    of: "bytes in the footer of a Parquet file",
    why: "2 000 columns in 50 row groups take 8 MB",
    remedy: "write it again with fewer row groups",
};
pub static NESTING: Limit = Limit {
    most: 64,
    of: "levels of nesting",
    why: "a URDF has 6, a recording 1 to 3",
    remedy: "write it without elements inside elements",
};
pub static ATTRIBUTES: Limit = Limit {
    most: 64,
    of: "attributes of an element",
    why: "a URDF's have 6 or fewer",
    remedy: "take out what is no URDF",
};
pub static PREFIXES: Limit = Limit {
    most: 256,
    of: "prefixes (xmlns) in a URDF",
    why: "those that have any declare some ten",
    remedy: "take out what is no URDF",
};
pub static DESCRIPTION: Limit = Limit {
    most: 1 << 22,
    of: "bytes in a URDF",
    why: "a humanoid's has 200 kB",
    remedy: "give the URDF of the robot alone; meshes belong into files of their own",
};
pub static LINKS: Limit = Limit {
    most: 2_000,
    of: "links and joints in a URDF",
    why: "a humanoid with two hands has some 300",
    remedy: "give the URDF of the arm without what stands around it",
};
pub static ARM: Limit = Limit {
    most: 64,
    of: "moving joints between base and tip",
    why: "arms have 6 or 7, snakes some 30, and work grows with the cube of it",
    remedy: "choose a shorter chain with --base and --tip",
};
pub static SETTINGS: Limit = Limit {
    most: 1 << 20,
    of: "bytes in a file of settings",
    why: "the longest that comes with armtwin has 4 kB",
    remedy: "check that this is the twin, scenario, study or column map that was meant",
};
pub static SINES: Limit = Limit {
    most: 100_000,
    of: "sines times seconds in a series",
    why: "a designed minute of six joints has 4 320",
    remedy: "design a shorter motion, or one of fewer harmonics",
};
pub static RECIPE: Limit = Limit {
    most: 512,
    of: "quantities in a recipe of RTDE",
    why: "controllers have some 400, registers included",
    remedy: "ask for fewer",
};
pub static CLIENTS: Limit = Limit {
    most: 16,
    of: "clients of a served arm at once",
    why: "each costs two threads; a controller serves fewer",
    remedy: "end one of them",
};
pub static UNREAD: Limit = Limit {
    most: 1 << 20,
    of: "bytes that a client has not read",
    why: "half a second of all quantities at 500 Hz",
    remedy: "read faster, ask for fewer quantities or a lower rate",
};

/// All limits, as the guide lists them.
pub static ALL: &[&Limit] = &[
    &ROWS,
    &COLUMNS,
    &NUMBERS,
    &LINE,
    &TEXT,
    &EXPANSION,
    &CHUNK,
    &MESSAGE,
    &JOINTS,
    &TOPICS,
    &STEPS,
    &FOOTER,
    &NESTING,
    &ATTRIBUTES,
    &PREFIXES,
    &DESCRIPTION,
    &LINKS,
    &ARM,
    &SETTINGS,
    &SINES,
    &RECIPE,
    &CLIENTS,
    &UNREAD,
];

/// Bytes that any file may become: what is less can do no harm.
const HARMLESS: u64 = 1 << 26;

/// What is made of a file against what was read of it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Expansion {
    taken: u64,
    made: u64,
}

impl Expansion {
    /// `bytes` were read from the file.
    pub fn take(&mut self, bytes: u64) {
        self.taken = self.taken.saturating_add(bytes);
    }

    /// `bytes` were, or would be, made of that.
    ///
    /// # Errors
    /// If that is too much of too little.
    pub fn make(&mut self, bytes: u64) -> Result<(), TooMuch> {
        self.made = self.made.saturating_add(bytes);
        match self.made > self.allowed() {
            true => Err(TooMuch(&EXPANSION)),
            false => Ok(()),
        }
    }

    /// Bytes that may still be made.
    pub fn left_to_make(&self) -> u64 {
        self.allowed().saturating_sub(self.made)
    }

    fn allowed(&self) -> u64 {
        HARMLESS.max(self.taken.saturating_mul(EXPANSION.most))
    }
}

/// May a recording have so many `numbers` if `bytes` of its file were read?
///
/// # Errors
/// If they are too many, or too many of so little.
pub fn allow_numbers(numbers: u64, bytes: u64) -> Result<(), TooMuch> {
    NUMBERS.allow(numbers)?;
    Expansion { taken: bytes, made: 0 }.make(8 * numbers)
}

/// Reads a whole file of text that is small by its nature.
///
/// # Errors
/// As reading does; [`TooMuch`] inside if the file is longer than `limit`.
pub fn read_small(path: &std::path::Path, limit: &'static Limit) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(limit.most + 1).read_to_end(&mut bytes)?;
    limit.allow(bytes.len() as u64).map_err(io::Error::other)?;
    Ok(bytes)
}

/// The text of a file of settings.
///
/// # Errors
/// As [`read_small`], and where it is not UTF-8.
pub fn read_settings(path: &std::path::Path) -> io::Result<String> {
    let bytes = read_small(path, &SETTINGS)?;
    String::from_utf8(bytes)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_made_of_little_is_limited() {
        let mut small = Expansion::default();
        small.take(10);
        assert_eq!(small.make(HARMLESS), Ok(()));
        let message = small.make(1).unwrap_err().to_string();
        assert!(message.contains("more than 1 000 times its own size"), "{message}");
        let mut large = Expansion::default();
        large.take(HARMLESS);
        assert_eq!(large.make(HARMLESS * EXPANSION.most), Ok(()));
        assert_eq!(large.make(u64::MAX), Err(TooMuch(&EXPANSION)));
    }

    /// The guide has a row for every limit, with its number and its reason.
    #[test]
    fn the_guide_states_every_limit() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/guide/src/own-recording.md");
        let guide = std::fs::read_to_string(path).unwrap();
        for limit in ALL {
            let row = format!("| {} {} | {} |", grouped(limit.most), limit.of, limit.why);
            assert!(guide.contains(&row), "the guide lacks the line\n{row}");
        }
    }

    #[test]
    fn settings_are_read_up_to_their_limit() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), vec![b'#'; SETTINGS.most as usize]).unwrap();
        assert_eq!(read_settings(file.path()).unwrap().len() as u64, SETTINGS.most);
        std::fs::write(file.path(), vec![b'#'; SETTINGS.most as usize + 1]).unwrap();
        let message = read_settings(file.path()).unwrap_err().to_string();
        assert!(message.contains("more than 1 048 576 bytes in a file of settings"), "{message}");
    }
}
