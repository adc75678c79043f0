//! The recordings that effects are grafted onto.

use std::path::{Path, PathBuf};

use super::Ground;
use crate::diagnosis::conditioning;
use crate::recording::{Recording, read};
use crate::signals::Conditioning;
use crate::trials::TrialError;
use crate::twin::Twin;

/// Two or more recordings of one arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Sources {
    recordings: Vec<Recording>,
}

impl Sources {
    /// Reads the recordings; one alone is cut in halves.
    ///
    /// # Errors
    /// If a file cannot be read, or two hold the same samples.
    pub fn read(files: &[PathBuf], columns: Option<&Path>) -> Result<Self, TrialError> {
        let read = |file: &PathBuf| read(file, columns);
        Self::new(files.iter().map(read).collect::<Result<_, _>>()?)
    }

    /// # Errors
    /// If there is none, or two hold the same samples.
    pub fn new(mut recordings: Vec<Recording>) -> Result<Self, TrialError> {
        if let [alone] = recordings.as_slice() {
            recordings = alone.halves().into();
        }
        if recordings.is_empty() {
            return Err(TrialError::Usage("--on: name at least one recording".into()));
        }
        for (i, one) in recordings.iter().enumerate() {
            let same =
                |other: &&Recording| other.time == one.time && other.channels == one.channels;
            if let Some(other) = recordings[..i].iter().find(same) {
                let file = Path::new(&one.provenance.source);
                let problem = format!(
                    "holds the same samples as {}; another recording must decide",
                    other.provenance.source
                );
                return Err(TrialError::file(file, problem));
            }
        }
        Ok(Self { recordings })
    }

    /// Every recording conditioned alike and held against the twin.
    pub(super) fn grounds(&self, twin: &Twin) -> Result<Vec<Ground>, TrialError> {
        let how = self.conditioning(twin.robot.dof());
        self.recordings.iter().map(|r| Ground::new(r.clone(), twin, &how)).collect()
    }

    /// Conditioning as a diagnosis does it; where only some hold the command, all without it.
    fn conditioning(&self, dof: usize) -> Conditioning {
        let each = self.recordings.iter().map(|r| conditioning(r, dof));
        let alike = |a: Conditioning, b: Conditioning| match (
            a.derivatives == b.derivatives,
            a.torque_cutoff_hz >= b.torque_cutoff_hz,
        ) {
            (false, _) => Conditioning::default(),
            (true, true) => a,
            (true, false) => b,
        };
        each.reduce(alike).unwrap_or_default()
    }
}
