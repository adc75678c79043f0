//! The recordings that effects are grafted onto.

use super::Ground;
use crate::diagnosis::conditioning;
use crate::recording::{Recording, refuse_same};
use crate::signals::Conditioning;
use crate::trials::TrialError;
use crate::twin::Twin;

/// Two or more recordings of one arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Sources {
    recordings: Vec<Recording>,
}

impl Sources {
    /// Recordings of one arm; one alone is cut in halves.
    ///
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
            recordings[..i].iter().try_for_each(|other| refuse_same(other, one))?;
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
