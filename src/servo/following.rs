//! A twin that follows a recording, whatever its values stand for.

use super::fit::Fit;
use super::time_offset::{DELAY, time_offset};
use super::{Free, ServoError, Track, free_parameters};
use crate::diagnosis::TimeOffset;
use crate::follow::Watch;
use crate::twin::Twin;

/// What lets a simulated servo follow a recorded one, whatever the cause.
const FOLLOWING: [&str; 7] = [
    "servo_gain",
    "servo_offset",
    "servo_delay",
    "servo_damping",
    "coulomb",
    "viscous",
    "rotor_inertia",
];

/// The twin, and the values by which it follows, which begin where it has them and are expected near those of the twin as given.
pub struct Following {
    pub twin: Twin,
    free: Vec<Free>,
}

/// A recording with its commands as they were sent, beside another.
#[derive(Clone)]
pub struct AsSent {
    pub track: Track,
    /// None where these two do not tell it.
    pub time_offset: Option<TimeOffset>,
}

impl AsSent {
    /// This, or what was told before where it tells nothing.
    pub fn or(self, before: &Self) -> Self {
        if self.time_offset.is_some() { self } else { before.clone() }
    }
}

impl Following {
    /// # Errors
    /// As [`super::identify`].
    pub fn new(given: &Twin, track: &Track, watch: &dyn Watch) -> Result<Self, ServoError> {
        let free = free_parameters(given, &FOLLOWING.map(String::from))?;
        let mut free: Vec<Free> = free.into_iter().map(|f| f.near_start(given)).collect();
        // A servo is never early; beside commands that a logger notes late it looks so.
        free.iter_mut().filter(|f| f.effect.about().name == DELAY).for_each(|f| f.min = -f.max);
        let twin = Fit::FromFar.of(given, &[track], &free, watch)?;
        free.iter_mut().for_each(|f| f.start = f.value_in(&twin).clamp(f.min, f.max));
        Ok(Self { twin, free })
    }

    /// The second of two recordings, of which the first is followed, as it was sent ([`time_offset`]).
    ///
    /// # Errors
    /// If `watch` ends it.
    pub fn as_sent(&self, tracks: [&Track; 2], watch: &dyn Watch) -> Result<AsSent, ServoError> {
        let time_offset = time_offset(&self.twin, tracks, &self.free, watch)?;
        let track = tracks[1].later(time_offset.map_or(0.0, |o| o.late_s));
        Ok(AsSent { track, time_offset })
    }
}
