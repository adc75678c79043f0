//! The gap while the arm works: rows come in, and what the twin leaves of the torque comes out, joint by
//! joint and regime by regime, beside what it left when it was fitted; and when that changed.
//!
//! ```text
//! rows -> segments -> Stretch (torque measured less the twin's) -> Figures   how large the gap is
//!                                                               -> Detector  whether it changed
//!                                                               -> flange    which force would explain it
//! ```
//!
//! Segments of [`HOP_S`] with margins on both sides go through the conditioning that a diagnosis uses, so
//! that watching and diagnosing see one residual; it comes [`HOP_S`] and a margin late. Memory is
//! constant: a segment, sums, and the last minutes of rows ([`Memory`]).

mod blocks;
mod change;
mod cusum;
mod detector;
mod figures;
mod flange;
mod memory;
mod rows;
mod segments;
mod self_starting;
mod stretch;
#[cfg(test)]
mod tests;

pub use blocks::FEATURES;
pub use change::{Answer, answer, usual};
pub use cusum::{Cusum, run_length, threshold};
pub use detector::{Alarm, Detector, Expected};
pub use figures::{Figure, Figures, Level, REGIMES};
pub use flange::Flange;
pub use memory::Memory;
pub use segments::{HOP_S, Segments};
pub use self_starting::SelfStarting;
pub use stretch::Stretch;

use crate::recording::Recording;
use crate::signals::SignalError;
use crate::twin::Twin;

/// Choices of watching.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Mean time between false alarms of all joints together, s of sliding motion.
    pub false_alarm_every_s: f64,
    /// Time that the level is learned from where no recording says it, s of sliding motion of a joint.
    pub learn_s: f64,
    /// Time constant of the figures, s of sliding motion.
    pub figures_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { false_alarm_every_s: 7.0 * 86400.0, learn_s: 120.0, figures_s: 30.0 }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum WatchError {
    #[error(transparent)]
    Signals(#[from] SignalError),
    #[error(
        "{0} has no values in the twin: watch with one that was fitted (`armtwin identify FIT --check CHECK \
         --save-twin twin.toml`)"
    )]
    Open(&'static str),
    #[error("the rows begin with {0}, where timestamp is expected")]
    NoTime(String),
}

/// Watches one arm.
pub struct Watch {
    twin: Twin,
    segments: Segments,
    figures: Figures,
    detector: Detector,
    flange: Flange,
}

/// What came of the latest rows.
pub struct Seen {
    pub stretch: Stretch,
    pub alarm: Option<Alarm>,
}

impl Watch {
    /// `columns` are the names of the numbers of a row, time first.
    ///
    /// # Errors
    /// If the twin lacks values, or the rows time.
    pub fn new(twin: Twin, columns: &[String], settings: &Settings) -> Result<Self, WatchError> {
        if let Some(open) = twin.open().next() {
            return Err(WatchError::Open(open.about().name));
        }
        let dof = twin.robot.dof();
        Ok(Self {
            segments: Segments::new(columns)?,
            figures: Figures::new(dof, settings),
            detector: Detector::new(dof, settings.false_alarm_every_s),
            flange: Flange::new(twin.robot.clone()),
            twin,
        })
    }

    /// The level that the twin left of a recording it was fitted on, and what is usual besides.
    ///
    /// # Errors
    /// If the recording cannot be conditioned.
    pub fn learn(&mut self, fitted_on: &Recording) -> Result<(), WatchError> {
        let stretch = Stretch::of(fitted_on, None, &self.twin)?;
        self.figures.learn(&stretch);
        self.flange.learn(&stretch);
        self.detector.learn(&stretch);
        Ok(())
    }

    /// Takes a row; something is seen once per [`HOP_S`].
    ///
    /// # Errors
    /// If the rows cannot be conditioned: columns are missing, or time makes no sense.
    pub fn row(&mut self, row: &[f64]) -> Result<Option<Seen>, WatchError> {
        let Some(segment) = self.segments.add(row) else { return Ok(None) };
        let stretch = Stretch::of(&segment.recording, Some(&segment.core), &self.twin)?;
        self.figures.add(&stretch);
        self.flange.add(&stretch);
        let alarm = self.detector.add(&stretch);
        if alarm.is_some() {
            self.figures.settle();
        }
        Ok(Some(Seen { stretch, alarm }))
    }

    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    pub fn flange(&self) -> &Flange {
        &self.flange
    }

    pub fn detector(&self) -> &Detector {
        &self.detector
    }

    pub fn twin(&self) -> &Twin {
        &self.twin
    }

    /// Numbers held back, rows and sums: what memory could grow by.
    pub fn held(&self) -> usize {
        self.segments.held()
    }
}
