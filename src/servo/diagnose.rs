//! A diagnosis of position servos: the search of `diagnosis`, on what a simulation leaves of recorded positions.
//!
//! The recordings are seen from the motion of a twin that follows them ([`linearised`]): the one given, with whatever
//! a servo and plain friction can be at every joint fitted by simulation. What the twin as given lacks along that motion
//! is the torque by which both differ, and what the recorded position shows beyond it: the first is exact however
//! far the twin is off, the second is small, so that its sensitivities are good. Values of what is found are then
//! fitted by simulation, too.

use super::choice::Sifted;
use super::folds::{Folds, Halved};
use super::following::{AsSent, Following};
use super::judge::{Mended, prove};
use super::refit::{Refits, Refitted};
use super::scatter::{birge_ratio, widen};
use super::sift::Sieve;
use super::sizes::Sizes;
use super::{ServoError, Settings, Track, linearised};
use crate::diagnosis::{self, Change, CrossValidated, Diagnosis, Offer, Traces, diagnose_proved};
use crate::follow::Watch;
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::twin::Twin;

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
    let [fit_track, noted] = Track::of_one_arm([Track::new(fit, twin)?, Track::new(check, twin)?]);
    watch.tell("fitting what the twin leaves open", 0, 0);
    let refits = Refits::new(twin, vec![&fit_track], watch)?;
    let following = Following::new(&refits.before, &fit_track, watch)?;
    let check_as_sent = following.as_sent([&fit_track, &noted], watch)?;
    let horizon_s = Settings::default().horizon_s;
    let [seen_fit, seen_check] = [(fit, &fit_track), (check, &check_as_sent.track)]
        .map(|(recorded, track)| linearised(&following.twin, recorded, track, horizon_s));
    let halved = Halved::new([fit_track.clone(), check_as_sent.track.clone()]);
    let folds = Folds::new(twin, &halved, watch)?;
    let mut mended = unchanged(&refits.before, check_as_sent.clone());
    let mut proof = |offers: &[Offer]| {
        let sieve = Sieve { folds: &folds, settings };
        let Sifted { stand, mended: near, left, before } = sieve.sift(offers)?;
        let changes: Vec<Change> = stand.iter().map(|s| offers[s.index].change.clone()).collect();
        if !changes.is_empty() {
            let near = folds.nearer(&near)?;
            // What is found follows better than whatever lets a servo follow.
            let following = Following::new(near, &fit_track, watch)?;
            let check = following.as_sent([&fit_track, &noted], watch)?.or(&check_as_sent);
            mended = mend(&refits, check, near, changes)?;
        }
        let [before_rad, after_rad] = [&before, &left].map(Sizes::mean_rad);
        mended.decided = CrossValidated { before_rad, after_rad };
        Ok(stand)
    };
    watch.tell(diagnosis::SEARCHING, 0, 0);
    let (mut diagnosis, traces) =
        diagnose_proved(twin, &seen_fit?, &seen_check?, settings, &mut proof, watch)?;
    let simulated = prove(&mut diagnosis, twin, &refits.before, &mended)?;
    Ok(Found { diagnosis, traces, simulated })
}

/// Nothing is changed.
fn unchanged(before: &Twin, check: AsSent) -> Mended {
    Mended {
        changes: Vec::new(),
        told: Refitted { twin: before.clone(), estimates: Vec::new() },
        alone: before.clone(),
        decided: CrossValidated::default(),
        check,
        birge_ratio: 1.0,
    }
}

/// Values of changes, which are near those of a twin, by both recordings and by the fit recording alone.
fn mend(
    of_fit: &Refits<'_>,
    check: AsSent,
    near: &Twin,
    changes: Vec<Change>,
) -> Result<Mended, ServoError> {
    let tracks = vec![of_fit.tracks[0], &check.track];
    let of_both = Refits::new(of_fit.twin, tracks, of_fit.watch)?;
    let mut told = of_both.all(near, &changes)?;
    let by_fit = of_fit.all(&told.twin, &changes)?;
    let by_check = of_both.by(&check.track).all(&told.twin, &changes)?;
    let birge_ratio = birge_ratio([&by_fit.estimates, &by_check.estimates]);
    widen(&mut told.estimates, birge_ratio);
    let alone = by_fit.twin;
    Ok(Mended { changes, told, alone, birge_ratio, ..unchanged(near, check) })
}
