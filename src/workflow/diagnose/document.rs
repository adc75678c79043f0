//! `diagnosis.json`: the diagnosis, and everything that led to it.

use serde::Serialize;

use super::Diagnosed;
use crate::diagnosis::{Diagnosis, Settings};
use crate::signals::Conditioning;
use crate::workflow::Source;

/// Document of the schema `armtwin.diagnosis/1`.
#[derive(Serialize)]
pub struct DiagnosisDocument<'a> {
    #[serde(flatten)]
    diagnosis: &'a Diagnosis,
    /// In one sentence.
    says: String,
    seed: u64,
    settings: &'a Settings,
    conditioning: &'a Conditioning,
    fit: Source<'a>,
    check: Source<'a>,
    twin: String,
    mended_twin: String,
    seconds: f64,
}

impl Diagnosed {
    /// What `diagnosis.json` holds.
    pub fn document(&self) -> DiagnosisDocument<'_> {
        DiagnosisDocument {
            diagnosis: &self.diagnosis,
            says: self.sentence(),
            seed: self.settings.seed,
            settings: &self.settings,
            conditioning: &self.fit.samples.conditioning,
            fit: Source::of(&self.fit.provenance, &self.fit.samples),
            check: Source::of(&self.check.provenance, &self.check.samples),
            twin: self.twin.to_toml(),
            mended_twin: self.mended.to_toml(),
            seconds: self.seconds,
        }
    }
}
