//! The seal on what a case hides: SHA-256 of every file in `sealed/`, published in `seals.json`.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{TrialError, Truth};
use crate::files::{sha256, write_own, write_whole};

const SCHEMA: &str = "armtwin.seals/1";
const FOLDER: &str = "sealed";
const LIST: &str = "seals.json";

/// `seals.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Seals {
    pub schema: String,
    pub armtwin: String,
    /// How the cases were made, for people.
    pub made: String,
    /// File name in `sealed/` -> SHA-256, hexadecimal.
    pub sha256: BTreeMap<String, String>,
}

/// Where the sealed file `name` of the trial in `dir` lies.
pub fn sealed_file(dir: &Path, name: &str) -> PathBuf {
    dir.join(FOLDER).join(name)
}

/// Makes the folder for sealed files.
///
/// # Errors
/// If it cannot be made.
pub fn make_folder(dir: &Path) -> Result<(), TrialError> {
    let folder = dir.join(FOLDER);
    fs::create_dir_all(&folder).map_err(TrialError::io(&folder, "made"))
}

/// Writes the truth of a case into `sealed/`.
///
/// # Errors
/// If it cannot be written.
pub fn write_truth(dir: &Path, truth: &Truth) -> Result<(), TrialError> {
    let file = sealed_file(dir, &format!("{}.json", truth.case));
    write_own(&file, |out| pretty(truth, out)).map_err(TrialError::io(&file, "written"))
}

/// Hashes everything in `sealed/` and publishes the hashes.
///
/// # Errors
/// If a file cannot be read or `seals.json` not be written.
pub fn seal(dir: &Path, made: String) -> Result<Seals, TrialError> {
    let mut seals = Seals {
        schema: SCHEMA.into(),
        armtwin: env!("CARGO_PKG_VERSION").into(),
        made,
        sha256: BTreeMap::new(),
    };
    let folder = dir.join(FOLDER);
    for entry in fs::read_dir(&folder).map_err(TrialError::io(&folder, "read"))? {
        let path = entry.map_err(TrialError::io(&folder, "read"))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        seals.sha256.insert(name, sha256(&read(&path)?));
    }
    write_json(&dir.join(LIST), &seals)?;
    Ok(seals)
}

impl Seals {
    /// # Errors
    /// If `dir` holds no trial.
    pub fn load(dir: &Path) -> Result<Self, TrialError> {
        let file = dir.join(LIST);
        serde_json::from_slice(&read(&file)?).map_err(|e| TrialError::file(&file, e))
    }

    /// Number of sealed cases.
    pub fn cases(&self) -> usize {
        self.sha256.keys().filter(|name| name.ends_with(".json")).count()
    }

    /// Opens what is hidden in the case `name`.
    ///
    /// # Errors
    /// If the file is gone, was never sealed or does not match its seal.
    pub fn open(&self, dir: &Path, case: &str) -> Result<Truth, TrialError> {
        let name = format!("{case}.json");
        let bytes = self.open_file(dir, &name)?;
        let file = sealed_file(dir, &name);
        serde_json::from_slice(&bytes).map_err(|e| TrialError::file(&file, e))
    }

    /// The bytes of a sealed file, its seal checked.
    ///
    /// # Errors
    /// As [`Seals::open`].
    pub fn open_file(&self, dir: &Path, name: &str) -> Result<Vec<u8>, TrialError> {
        let file = sealed_file(dir, name);
        let Some(sealed) = self.sha256.get(name) else {
            return Err(TrialError::file(&file, "has no seal in seals.json; draw the cases again"));
        };
        let bytes = read(&file)?;
        let found = sha256(&bytes);
        match found == *sealed {
            true => Ok(bytes),
            false => Err(TrialError::Broken { file, found, sealed: sealed.clone() }),
        }
    }
}

fn read(file: &Path) -> Result<Vec<u8>, TrialError> {
    fs::read(file).map_err(TrialError::io(file, "read"))
}

/// Pretty JSON, whole or not at all.
pub fn write_json(file: &Path, value: &impl Serialize) -> Result<(), TrialError> {
    write_whole(file, |out| pretty(value, out)).map_err(TrialError::io(file, "written"))
}

fn pretty(value: &impl Serialize, out: &mut dyn io::Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, value)?;
    writeln!(out)
}
