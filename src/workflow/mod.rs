//! The program's jobs, each as one call: what the command line and the Python package do with recordings.
//!
//! A recording is held against the arm before anything is worked out from it, thinned where it has more rows
//! than that needs, halved where there is no other one to decide, conditioned, and handed to
//! `identification` or `diagnosis`. An options struct per job ([`Identify`], [`Diagnose`], [`Simulate`])
//! has the program's defaults; [`identify`], [`diagnose`] and [`simulate`] are the jobs with these.
//!
//! Long work is followed and ended by a [`Watch`](crate::follow::Watch).

mod arm;
mod by;
mod diagnose;
mod error;
mod identify;
mod predict;
mod reading;
mod signals;
mod simulate;

pub use arm::{Arm, Said};
pub use diagnose::{Diagnose, Diagnosed, DiagnosisDocument, Recorded, diagnose};
pub use error::WorkflowError;
pub use identify::{
    BaseRow, INERTIA, IdentificationDocument, Identified, IdentifiedServos, Identify, KnownLoad,
    Left, Link, LinkValue, Scaled, ServosDocument, Summary, Told, Used, identify, words,
};
pub use predict::{Predicted, predict};
pub use reading::{Prepared, Reading};
pub use signals::SignalOptions;
pub use simulate::{Simulate, Simulated, move_along, simulate};

use crate::recording::{Provenance, Recording};
use crate::signals::{Conditioning, Samples, condition};
use crate::twin::Twin;

/// A recording as a document names it: where it came from, and what became of its signals.
#[derive(serde::Serialize)]
pub struct Source<'a> {
    #[serde(flatten)]
    provenance: &'a Provenance,
    signals: &'a [String],
}

impl<'a> Source<'a> {
    fn of(provenance: &'a Provenance, samples: &'a Samples) -> Self {
        Self { provenance, signals: &samples.notes }
    }
}

fn conditioned(
    recording: &Recording,
    twin: &Twin,
    how: &Conditioning,
) -> Result<Samples, WorkflowError> {
    condition(recording, &twin.drive, twin.robot.dof(), how)
        .map_err(|error| WorkflowError::from(error).at(&recording.provenance.source))
}

#[cfg(test)]
mod tests;
