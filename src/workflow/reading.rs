//! A recording held against its arm before anything is worked out from it, and thinned where it has more
//! rows than that needs.

use std::borrow::Cow;
use std::ops::Deref;

use super::{Arm, SignalOptions, WorkflowError};
use crate::follow::Watch;
use crate::plausibility::Doubt;
use crate::recording::{Recording, refuse_same};
use crate::signals::thin;

/// How recordings are taken and conditioned, in every job.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Reading {
    pub signals: SignalOptions,
    /// Keep all rows of recordings faster than 125 Hz or longer than 300 000 rows.
    pub every_row: bool,
    /// Go on with a recording that contradicts its column names or the arm.
    pub force: bool,
}

/// A recording that jobs may work on.
#[derive(Debug, Clone)]
pub struct Prepared<'a>(Cow<'a, Recording>);

impl Deref for Prepared<'_> {
    type Target = Recording;

    fn deref(&self) -> &Recording {
        &self.0
    }
}

impl Reading {
    /// Takes the recordings of a job: one to search on and, where there is one, another to decide on.
    ///
    /// # Errors
    /// As [`Reading::take`].
    pub fn both<'a>(
        &self,
        arm: &Arm,
        fit: &'a Recording,
        check: Option<&'a Recording>,
        watch: &dyn Watch,
    ) -> Result<(Prepared<'a>, Option<Prepared<'a>>), WorkflowError> {
        let take = |recording| self.take(Cow::Borrowed(recording), arm, watch);
        Ok((take(fit)?, check.map(take).transpose()?))
    }

    /// Takes a recording of `arm`. `watch` hears what is done with it.
    ///
    /// # Errors
    /// If it is of another number of joints, of an unknown drive, or contradicts itself or the arm and is not
    /// forced.
    pub fn take<'a>(
        &self,
        recording: Cow<'a, Recording>,
        arm: &Arm,
        watch: &dyn Watch,
    ) -> Result<Prepared<'a>, WorkflowError> {
        let mut recording = recording;
        match arm.settles(&recording) {
            true => arm.settle(recording.to_mut())?,
            false => {
                arm.refuse_other_joints(&recording)?;
                arm.refuse_unknown_drive(&recording)?;
            }
        }
        self.stop(&recording, &arm.judge(&recording).doubts, watch)?;
        if self.every_row {
            return Ok(Prepared(recording));
        }
        let Some(thinned) = thin(&recording, self.signals.floor_hz()) else {
            return Ok(Prepared(recording));
        };
        if let Some(note) = thinned.provenance.notes.last() {
            watch.note(&format!("{}: {note}", recording.provenance.source));
        }
        Ok(Prepared(Cow::Owned(thinned)))
    }

    fn stop(
        &self,
        recording: &Recording,
        doubts: &[Doubt],
        watch: &dyn Watch,
    ) -> Result<(), WorkflowError> {
        let file = &recording.provenance.source;
        let doubts: Vec<String> = doubts.iter().map(ToString::to_string).collect();
        if self.force {
            doubts.iter().for_each(|doubt| watch.warn(&format!("{file}: {doubt}")));
            return Ok(());
        }
        match doubts.is_empty() {
            true => Ok(()),
            false => Err(WorkflowError::Doubted { file: file.clone(), doubts }),
        }
    }
}

impl<'a> Prepared<'a> {
    pub(super) fn of(recording: Recording) -> Self {
        Self(Cow::Owned(recording))
    }

    pub fn into_owned(self) -> Recording {
        self.0.into_owned()
    }

    /// Two recordings, to search on and to decide on: this one and the other, or its two halves.
    ///
    /// # Errors
    /// If both hold the same samples.
    pub fn pair(self, other: Option<Prepared<'a>>) -> Result<[Prepared<'a>; 2], WorkflowError> {
        let Some(other) = other else {
            return Ok(self.halves().map(|half| Self(Cow::Owned(half))));
        };
        refuse_same(&self, &other)?;
        Ok([self, other])
    }
}
