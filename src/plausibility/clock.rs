//! Is time in seconds?

use super::{Doubt, FACTOR, speed};
use crate::recording::Recording;
use crate::recording::inspection::{plausible_step, step};

/// Time in another unit than seconds.
pub struct Clock {
    /// Seconds per unit.
    pub scale: f64,
    pub doubt: Doubt,
}

/// Seconds per unit, and its name.
const UNITS: [(f64, &str); 5] = [
    (1e-3, "milliseconds"),
    (1e-6, "microseconds"),
    (1e-9, "nanoseconds"),
    (3600.0, "hours"),
    (86_400.0, "days"),
];

/// The unit in which the steps of time are those of a recording, where they are not in seconds. A recorded
/// velocity that agrees with time as it stands decides for seconds.
pub fn guess(recording: &Recording) -> Option<Clock> {
    let step = step(&recording.time);
    if plausible_step(step) {
        return None;
    }
    let agreed = speed::common_slope(recording, 1.0);
    if agreed.is_some_and(|slope| (1.0 / FACTOR..FACTOR).contains(&slope)) {
        return None;
    }
    let (scale, unit) = UNITS.into_iter().find(|(scale, _)| plausible_step(step * scale))?;
    let what = format!(
        "the time column steps by {step} per row, which is no recording in seconds: it is in {unit}"
    );
    let remedy = format!("say time_scale = {scale:e} in a column map (--columns)");
    Some(Clock { scale, doubt: Doubt { what, remedy } })
}
