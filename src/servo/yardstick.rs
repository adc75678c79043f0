//! How far a twin is from a recording that it is held against, led along its command from the first sample to the last.
//!
//! What a twin leaves open is what that recording says of it, with a change and without, as by torque: gears that are warmer
//! have less friction, and one motion hardly tells how a joint brakes at the speeds of another. Values of changes stay as they are.

use super::fit::{ABOUT, Search, minimised, starts, weigh};
use super::parameters::{Free, with_values};
use super::problem::Problem;
use super::sizes::Sizes;
use super::{ServoError, Settings, Track, free_parameters};
use crate::identification::levenberg_marquardt::Residuals;
use crate::regression::bounds::Bounds;
use crate::twin::Twin;

/// Simulations of a twin with other open values, at most: columns are those of a twin nearby, so that a step or two do, and more
/// of them bring it no nearer.
const STEPS: usize = 5;

/// A recording that twins are held against.
pub struct Yardstick<'a> {
    /// The whole of it.
    track: &'a Track,
    /// What of it counts.
    part: &'a Track,
    /// Effects whose values the twin leaves open.
    open: Vec<String>,
    /// How errors change with each open value, rad by its unit, joint after joint; empty where none is open or the twin cannot be
    /// simulated.
    columns: Vec<Vec<f64>>,
}

impl<'a> Yardstick<'a> {
    /// For twins near `twin`, the effects `open` of which are open.
    ///
    /// # Errors
    /// If an open effect cannot be fitted.
    pub fn new(
        twin: &Twin,
        open: Vec<String>,
        (track, part): (&'a Track, &'a Track),
    ) -> Result<Self, ServoError> {
        let free = free_parameters(twin, &open)?;
        if free.is_empty() {
            return Ok(Self { track, part, open, columns: Vec::new() });
        }
        let tracks = [part];
        let mut problem = Problem::new(twin, &tracks, &free, Settings::default().horizon_s);
        problem.with_priors = false;
        let x = starts(&free);
        let mut columns = problem.jacobian(&x, &problem.errors(&x), &Bounds::unbounded(x.len()));
        if columns.iter().flatten().any(|c| !c.is_finite()) {
            columns.clear();
        }
        Ok(Self { track, part, open, columns })
    }

    /// What a twin leaves of the recording, its open values as the recording has them.
    ///
    /// # Errors
    /// If the twin cannot be simulated.
    pub fn left(&self, twin: &Twin) -> Result<Sizes, ServoError> {
        Sizes::along(self.track, &self.part.usable, &self.opened(twin)?)
    }

    /// `twin` with its open values as the recording has them; as it is where that cannot be told.
    fn opened(&self, twin: &Twin) -> Result<Twin, ServoError> {
        if self.columns.is_empty() {
            return Ok(twin.clone());
        }
        let free = free_parameters(twin, &self.open)?;
        let free: Vec<Free> = free.into_iter().map(|f| f.near_start(twin)).collect();
        let tracks = [self.part];
        let mut problem = Problem::new(twin, &tracks, &free, Settings::default().horizon_s);
        let errors = problem.errors(&starts(&free));
        if errors.iter().any(|e| !e.is_finite()) {
            return Ok(twin.clone());
        }
        (problem.counts_independent, problem.is_robust) = (true, true);
        weigh(&mut problem, &errors);
        let chord = Chord { problem, columns: &self.columns };
        let found = minimised(&chord, &free, Search::new(&free), (ABOUT, STEPS));
        Ok(with_values(twin, &free, &found.x))
    }
}

/// A problem with the columns of a twin nearby (the chord method).
struct Chord<'a> {
    problem: Problem<'a>,
    columns: &'a [Vec<f64>],
}

impl Residuals for Chord<'_> {
    fn count(&self) -> usize {
        self.problem.count()
    }

    fn residuals(&self, x: &[f64], out: &mut [f64]) {
        self.problem.residuals(x, out);
    }

    fn jacobian(&self, _: &[f64], r: &[f64], _: &Bounds) -> Vec<Vec<f64>> {
        self.problem.counted_columns(self.columns.to_vec(), r)
    }
}
