//! SHA-256, hexadecimal.

use std::fs::File;
use std::io;
use std::path::Path;

use sha2::{Digest, Sha256};

pub fn sha256(bytes: &[u8]) -> String {
    text(&Sha256::digest(bytes))
}

/// The digest of a file.
///
/// # Errors
/// If it cannot be read.
pub fn sha256_of_file(path: &Path) -> io::Result<String> {
    let mut hash = Sha256::new();
    io::copy(&mut File::open(path)?, &mut hash)?;
    Ok(text(&hash.finalize()))
}

fn text(digest: &[u8]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
}
