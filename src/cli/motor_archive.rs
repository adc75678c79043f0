//! A folder of finished searches, so that a study of hours can be stopped and taken up again.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::save;
use crate::files::sha256;
use crate::motor::report::Method;
use crate::motor::scenario::Scenario;
use crate::motor::study::{Archive, Search};

/// `DIGEST-METHOD-SEED.toml`, the digest that of the scenario as it was asked and of the program's
/// version: who changes the search itself names another folder. TOML, because it reads numbers back
/// to the last bit: a study taken up again ends as if it had never stopped.
pub struct Folder(PathBuf);

impl Folder {
    /// # Errors
    /// If it cannot be made.
    pub fn open(dir: &Path) -> anyhow::Result<Self> {
        fs::create_dir_all(dir).with_context(|| format!("cannot make {}", dir.display()))?;
        Ok(Self(dir.into()))
    }

    fn file(&self, scenario: &Scenario, method: Method, seed: u64) -> PathBuf {
        let asked = format!("{} {scenario:?}", env!("CARGO_PKG_VERSION"));
        let digest = &sha256(asked.as_bytes())[..12];
        self.0.join(format!("{digest}-{}-{seed}.toml", method.name()))
    }
}

impl Archive for Folder {
    fn find(&self, scenario: &Scenario, method: Method, seed: u64) -> Option<Search> {
        let text = fs::read_to_string(self.file(scenario, method, seed)).ok()?;
        toml::from_str(&text).ok()
    }

    fn keep(&self, scenario: &Scenario, method: Method, seed: u64, search: &Search) {
        let file = self.file(scenario, method, seed);
        let text = toml::to_string(search).map_err(anyhow::Error::from);
        if let Err(error) = text.and_then(|text| save::text(&file, &text)) {
            let why = super::in_words(&error);
            eprintln!("{why}: this search will have to be made again");
        }
    }
}
