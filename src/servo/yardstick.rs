//! How far a twin is from a recording that it is held against, led along its command from the first sample to the last.
//!
//! What a twin leaves open is what that recording says of it, with a change and without, as by torque: gears that are warmer
//! have less friction, and one motion hardly tells how a joint brakes at the speeds of another. Values of changes stay as they are.

use super::fit::{ABOUT, Search, minimised, starts, weigh};
use super::parameters::{Free, with_values};
use super::problem::Problem;
use super::sizes::Sizes;
use super::{ServoError, Settings, Track, free_parameters};
use crate::twin::Twin;

/// Simulations of a twin with other open values, at most: more of them bring it no nearer.
const STEPS: usize = 5;

/// A recording that twins are held against.
pub struct Yardstick<'a> {
    /// The whole of it.
    pub track: &'a Track,
    /// What of it counts.
    pub part: &'a Track,
    /// Effects whose values the twin leaves open.
    pub open: Vec<String>,
}

impl Yardstick<'_> {
    /// What a twin leaves of the recording, its open values as the recording has them.
    ///
    /// # Errors
    /// If the twin cannot be simulated.
    pub fn left(&self, twin: &Twin) -> Result<Sizes, ServoError> {
        let [left] = Sizes::along(self.track, [&self.part.usable], &self.opened(twin)?)?;
        Ok(left)
    }

    /// What a twin leaves with all values that it has, of this part of the recording and of another one.
    ///
    /// # Errors
    /// If the twin cannot be simulated.
    pub fn left_as_is(&self, other: &Track, twin: &Twin) -> Result<[Sizes; 2], ServoError> {
        Sizes::along(self.track, [&self.part.usable, &other.usable], twin)
    }

    /// `twin` with its open values as the recording has them; as it is where that cannot be told.
    fn opened(&self, twin: &Twin) -> Result<Twin, ServoError> {
        let free = free_parameters(twin, &self.open)?;
        if free.is_empty() {
            return Ok(twin.clone());
        }
        let free: Vec<Free> = free.into_iter().map(|f| f.near_start(twin)).collect();
        let tracks = [self.part];
        let mut problem = Problem::new(twin, &tracks, &free, Settings::default().horizon_s);
        let errors = problem.errors(&starts(&free));
        if errors.iter().any(|e| !e.is_finite()) {
            return Ok(twin.clone());
        }
        (problem.counts_independent, problem.is_robust) = (true, true);
        weigh(&mut problem, &errors);
        let found = minimised(&problem, &free, Search::new(&free), (ABOUT, STEPS));
        Ok(with_values(twin, &free, &found.x))
    }
}
