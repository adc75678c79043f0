//! A case folder: all that an answerer sees.

use std::fs;
use std::path::{Path, PathBuf};

use super::TrialError;
use crate::diagnosis::Settings;
use crate::files::write_own;
use crate::limits::read_settings;

pub const FIT: &str = "fit.csv.gz";
pub const CHECK: &str = "check.csv.gz";
pub const TWIN: &str = "twin.toml";
pub const SETTINGS: &str = "settings.toml";
/// The arm, where it is none that is built in.
pub const ROBOT: &str = "robot.urdf";
const PREFIX: &str = "case-";

/// A case as the answerer gets it.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name of the folder, `case-0000`.
    pub name: String,
    pub folder: PathBuf,
    /// What the answerer is told: effects taken out of the catalogue, how well masses are known.
    pub settings: Settings,
}

impl Case {
    /// # Errors
    /// If the settings of the case cannot be read.
    pub fn open(folder: &Path) -> Result<Self, TrialError> {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let file = folder.join(SETTINGS);
        let text = read_settings(&file).map_err(TrialError::io(&file, "read"))?;
        let settings = toml::from_str(&text).map_err(|e| TrialError::file(&file, e))?;
        Ok(Self { name, folder: folder.into(), settings })
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }
}

/// `case-0007`
pub fn case_name(number: usize) -> String {
    format!("{PREFIX}{number:04}")
}

/// The case folders of a trial, in order.
///
/// # Errors
/// If `dir` cannot be read or holds none.
pub fn case_folders(dir: &Path) -> Result<Vec<PathBuf>, TrialError> {
    let entries = fs::read_dir(dir).map_err(TrialError::io(dir, "read"))?;
    let is_case = |p: &PathBuf| {
        p.is_dir() && p.file_name().is_some_and(|n| n.to_string_lossy().starts_with(PREFIX))
    };
    let mut folders: Vec<_> =
        entries.filter_map(|e| e.ok().map(|e| e.path())).filter(is_case).collect();
    folders.sort();
    match folders.is_empty() {
        true => Err(TrialError::file(dir, "holds no cases; make some with `armtwin trial draw`")),
        false => Ok(folders),
    }
}

/// Makes the folder of a case, which must be new: nothing in it is written over.
///
/// # Errors
/// If it is there or cannot be made.
pub fn new_folder(folder: &Path) -> Result<(), TrialError> {
    let made = folder.parent().map_or(Ok(()), fs::create_dir_all);
    made.and_then(|()| fs::create_dir(folder)).map_err(TrialError::io(folder, "made"))
}

/// Writes what the answerer is told.
///
/// # Errors
/// If it cannot be written.
pub fn write_settings(folder: &Path, settings: &Settings) -> Result<(), TrialError> {
    let file = folder.join(SETTINGS);
    let text = toml::to_string(settings).map_err(|e| TrialError::file(&file, e))?;
    write_text(&file, &text)
}

/// # Errors
/// If it cannot be written.
pub fn write_text(file: &Path, text: &str) -> Result<(), TrialError> {
    write_own(file, |out| out.write_all(text.as_bytes())).map_err(TrialError::io(file, "written"))
}
