//! Names that two recordings together do not tell from each other: positions tell ratios of torques, and a softer servo with a
//! lighter arm moves alike.
//!
//! Whether something is there is asked of a recording that it was not fitted to. What it is called is another question, to which
//! both recordings speak: values that the one hardly tells may well be told by the other. Fits end at a thousandth of their
//! cost, which is less than the steps of encoders leave: of what is simulated without steps or noise they tell less.

use rayon::prelude::*;

use super::ServoError;
use super::fit::Fit;
use super::refit::{Refits, is_at_bound};
use super::sizes::as_little;
use super::yardstick::Yardstick;
use crate::diagnosis::Change;
use crate::twin::Twin;

/// Fits of changes to two recordings.
pub struct Rivals<'a> {
    /// Fits to the one of them.
    pub refits: &'a Refits<'a>,
    /// That one, and the other.
    pub both: [&'a Yardstick<'a>; 2],
    /// Share of what a name takes off that no law is exact to.
    pub inexact: f64,
}

/// Changes of a twin, the last of which is a name for what it lacks.
pub struct Named<'a> {
    /// The twin with the changes, near whose values a fit begins.
    pub near: &'a Twin,
    pub changes: Vec<Change>,
}

impl Rivals<'_> {
    /// Does each of `others` take off as much of what `without` leaves of both recordings as `best`, all of them fitted to both?
    ///
    /// # Errors
    /// As [`super::identify`].
    pub fn equals(
        &self,
        without: &Named<'_>,
        best: &Named<'_>,
        others: &[Named<'_>],
    ) -> Result<Vec<bool>, ServoError> {
        if others.is_empty() {
            return Ok(Vec::new());
        }
        let [without, best] = [without, best].map(|named| self.left(named));
        let most = as_little(without?.0, best?.0, self.inexact);
        let left = others.par_iter().map(|named| self.left(named));
        let is_equal = |(left, is_at_bound): (f64, bool)| left <= most && !is_at_bound;
        left.map(|left| left.map(is_equal)).collect()
    }

    /// What is left of both recordings, as [`super::sizes::Sizes::ln`] has it, infinite where the twin runs away; and is a value of the name at
    /// the end of its range?
    fn left(&self, Named { near, changes }: &Named<'_>) -> Result<(f64, bool), ServoError> {
        let tracks = self.both.map(|one| one.track);
        let twin = match self.refits.fitted_to(&tracks, Fit::About, near, (changes, None)) {
            Err(ServoError::Diverged { .. }) => return Ok((f64::INFINITY, false)),
            fitted => fitted?,
        };
        let is_at_bound = changes.last().map_or(Ok(false), |name| is_at_bound(&twin, name))?;
        let left = self.both.map(|one| Ok(one.left(&twin)?.ln()));
        Ok((left.into_iter().sum::<Result<f64, ServoError>>()?, is_at_bound))
    }
}
