//! Names that two recordings together do not tell from each other: positions tell ratios of torques, and a softer servo with a
//! lighter arm moves alike.
//!
//! Whether something is there is asked of a recording that it was not fitted to. What it is called is another question, to which
//! both recordings speak: values that the one hardly tells may well be told by the other.

use rayon::prelude::*;

use super::fit::Fit;
use super::refit::{Refits, is_at_bound};
use super::sizes::Sizes;
use super::{ServoError, Settings, Track};
use crate::diagnosis::Change;
use crate::twin::Twin;

/// Fits of changes to both recordings.
pub struct Rivals<'a> {
    pub refits: &'a Refits<'a>,
    pub check: &'a Track,
    /// Share of what a name takes off that no law is exact to.
    pub inexact: f64,
}

/// A twin, near which its values are, with changes, the last of which is a name for what others lack.
pub struct Named<'a> {
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

    /// What is left of both recordings, as [`Sizes::ln`] has it, infinite where the twin runs away; and is a value of the name at
    /// the end of its range?
    fn left(&self, Named { near, changes }: &Named<'_>) -> Result<(f64, bool), ServoError> {
        let tracks = [self.refits.fit, self.check];
        let free = self.refits.free(near, changes)?;
        let fitted = match free.is_empty() {
            true => Ok((*near).clone()),
            false => Fit::About.of(near, &tracks, &free, self.refits.watch),
        };
        let twin = match fitted {
            Err(ServoError::Diverged { .. }) => return Ok((f64::INFINITY, false)),
            fitted => fitted?,
        };
        let is_at_bound = changes.last().map_or(Ok(false), |name| is_at_bound(&twin, name))?;
        let horizon_s = Settings::default().horizon_s;
        let left = tracks.map(|track| Ok(Sizes::along(track, &twin, horizon_s)?.ln()));
        Ok((left.into_iter().sum::<Result<f64, ServoError>>()?, is_at_bound))
    }
}

/// The most that is as little as `least`, of what is left: a share of what is taken off is none. Where a twin runs away without,
/// what is taken off is no measure.
pub fn as_little(without: f64, least: f64, inexact: f64) -> f64 {
    let gain = without - least;
    least + if gain.is_finite() { inexact * gain } else { 0.0 }
}
