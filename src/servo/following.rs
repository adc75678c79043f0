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

/// Two recordings, commands of the second one as they were sent beside the first.
#[derive(Clone)]
pub struct AsSent {
    pub both: [Track; 2],
    pub time_offset: Option<TimeOffset>,
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

    /// By how much commands of the second track are sent later beside positions than those of the first ([`time_offset`]).
    ///
    /// # Errors
    /// If `watch` ends it.
    pub fn time_offset(
        &self,
        tracks: [&Track; 2],
        watch: &dyn Watch,
    ) -> Result<Option<TimeOffset>, ServoError> {
        time_offset(&self.twin, tracks, &self.free, watch)
    }
    /// Two recordings as this tells them, of which the first is followed.
    ///
    /// # Errors
    /// If `watch` ends it.
    pub fn as_sent(
        &self,
        [first, second]: &[Track; 2],
        watch: &dyn Watch,
    ) -> Result<AsSent, ServoError> {
        let time_offset = self.time_offset([first, second], watch)?;
        let sent = second.later(time_offset.map_or(0.0, |o| o.late_s));
        Ok(AsSent { both: [first.clone(), sent], time_offset })
    }
}
