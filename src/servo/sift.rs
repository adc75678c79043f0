//! Changes of a twin that bring its simulated position nearer to the recorded one.
//!
//! A search sees them along one motion. What it finds there must hold where the twin is led along another command:
//! a change without which the simulated position is as near is none.

use rayon::prelude::*;

use super::judge::{Refitted, taken_out};
use super::{PositionGap, ServoError, Track, replay};
use crate::diagnosis::Cause;
use crate::twin::Twin;

/// Changes that stand, fitted, and those that do not.
pub struct Sifted {
    pub fitted: Refitted,
    pub left_out: Vec<Cause>,
}

/// Leaves out of `changes` those that take nothing off the simulated position's error along the command of `check`,
/// the worst first; `refit` fits the others.
///
/// # Errors
/// If `refit` fails.
pub fn sifted(
    twin: &Twin,
    mut changes: Vec<Cause>,
    refit: impl Fn(&[Cause]) -> Result<Refitted, ServoError>,
    check: &Track,
) -> Result<Sifted, ServoError> {
    let mut left_out = Vec::new();
    loop {
        let fitted = refit(&changes)?;
        let idle = idle(&fitted.twin, twin, &mut changes, check)?;
        if idle.is_empty() {
            return Ok(Sifted { fitted, left_out });
        }
        left_out.extend(idle);
    }
}

/// Takes out of `changes` what the mended twin does no worse without.
fn idle(
    mended: &Twin,
    twin: &Twin,
    changes: &mut Vec<Cause>,
    check: &Track,
) -> Result<Vec<Cause>, ServoError> {
    let (mut mended, mut idle) = (mended.clone(), Vec::new());
    loop {
        let all = error(&mended, check)?;
        let without = |change: &Cause| error(&taken_out(&mended, twin, change), check);
        let errors = changes.par_iter().map(without).collect::<Result<Vec<f64>, _>>()?;
        // What harms most is what it goes best without.
        let least = errors.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        let Some((worst, _)) = least.filter(|(_, error)| **error <= all) else {
            return Ok(idle);
        };
        let change = changes.remove(worst);
        mended = taken_out(&mended, twin, &change);
        idle.push(change);
    }
}

/// Root mean square of the simulated position's error, rad; infinite where the twin runs away.
fn error(twin: &Twin, check: &Track) -> Result<f64, ServoError> {
    match replay(twin, check, &check.stretches(f64::INFINITY)) {
        Ok(q) => Ok(PositionGap::new(check, &q).rms_rad()),
        Err(ServoError::Diverged { .. }) => Ok(f64::INFINITY),
        Err(other) => Err(other),
    }
}
