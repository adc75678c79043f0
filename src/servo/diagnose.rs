//! A diagnosis of position servos: the search of `diagnosis`, on what a simulation leaves of recorded positions.
//!
//! The twin's open values are fitted by simulation, the recordings are seen from the motion it then makes
//! ([`linearised`]), and the causes that are found are fitted by simulation, too. Seen from the motion of the
//! mended twin what is sought is nearer to linear: a second round looks from there (Gauss and Newton's method,
//! with a search of the catalogue for its step).

use super::judge::{ELASTIC, Refitted, prove, refit};
use super::{ServoError, Settings, Track, linearised};
use crate::diagnosis::{self, Diagnosis, Traces, diagnose_traced, mend};
use crate::follow::Watch;
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::twin::Twin;

/// Rounds of looking from the mended twin.
const ROUNDS: usize = 2;

/// What was found of an arm of position servos.
pub struct Found {
    pub diagnosis: Diagnosis,
    pub traces: Traces,
    /// Positions (rad) of the twin as given and of the mended one, led along the command of the check recording.
    pub simulated: Vec<JointSeries>,
}

/// Searches causes on `fit`, decides on `check`, and proves on `check` by simulation what they bring.
///
/// # Errors
/// If the twin has no servos or runs away, a recording is too short, or `watch` ends it.
pub fn diagnose(
    twin: &Twin,
    [fit, check]: [&Samples; 2],
    settings: &diagnosis::Settings,
    watch: &dyn Watch,
) -> Result<Found, ServoError> {
    let servo = twin.drive.servo.as_ref().ok_or(ServoError::NoServo)?;
    let [fit_track, check_track] = [Track::new(fit, servo)?, Track::new(check, servo)?];
    let horizon_s = Settings::default().horizon_s;
    let settings = without_elastic(settings);
    watch.tell("fitting what the twin leaves open", 0, 0);
    let before = refit(twin, twin, &[], &fit_track, watch)?;
    let mut point = before.twin.clone();
    let mut best: Option<(Diagnosis, Traces, Refitted)> = None;
    for _ in 0..ROUNDS {
        watch.tell("searching for what the twin lacks", 0, 0);
        let seen = [fit, check].map(|s| linearised(&point, s, horizon_s));
        let [seen_fit, seen_check] = seen;
        let (found, traces) = diagnose_traced(twin, &seen_fit?, &seen_check?, &settings, watch)?;
        watch.tell("fitting causes by simulation", 0, 0);
        let changes = found.changes();
        let after = refit(&mend(twin, &found.fitted, &changes), twin, &changes, &fit_track, watch)?;
        let better = best.as_ref().is_none_or(|(_, _, b)| after.rms_rad < b.rms_rad);
        let settled = best.as_ref().is_some_and(|(b, _, _)| named(b) == named(&found));
        point = after.twin.clone();
        let nothing = changes.is_empty();
        if better || settled {
            best = Some((found, traces, after));
        }
        if settled || nothing || !better {
            break;
        }
    }
    let Some((mut diagnosis, traces, after)) = best else { return Err(ServoError::NothingToFit) };
    let simulated = prove(&mut diagnosis, twin, [before, after], &check_track)?;
    Ok(Found { diagnosis, traces, simulated })
}

/// Effects and joints of the causes.
fn named(d: &Diagnosis) -> Vec<(&str, &[usize])> {
    let mut all: Vec<_> =
        d.causes.iter().map(|c| (c.effect.as_str(), c.joints.as_slice())).collect();
    all.sort_unstable();
    all
}

/// What gives way between motor and link is not simulated here, and so cannot be proved.
fn without_elastic(settings: &diagnosis::Settings) -> diagnosis::Settings {
    let mut settings = settings.clone();
    settings.without.extend(ELASTIC.map(String::from));
    settings
}
