//! Changes of a twin that bring its simulated position nearer to the recorded one.
//!
//! A search sees them along one motion. What it finds there must hold where the twin is led along another command:
//! a change with which the simulated position does not surely come nearer is none. Sizes of errors count, not their
//! squares: what stops the arm for a moment in one recording alone is not simulated here, and squares would let it decide.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::refit::{Refits, Refitted, is_at_bound};
use super::{ServoError, Track, replay};
use crate::diagnosis::{Change, Offer, Settings, Stands, interval};
use crate::twin::Twin;

/// Fits of changes to one recording, and another command along which a change has to hold.
pub struct Sieve<'a> {
    pub refits: &'a Refits<'a>,
    pub check: &'a Track,
    pub settings: &'a Settings,
}

/// Which changes stand, and the twin with them, about.
pub struct Sifted {
    pub stand: Vec<Stands>,
    pub twin: Twin,
}

/// A twin with one change alone, or with one more.
struct Tried {
    index: usize,
    twin: Twin,
    /// Each joint, rad.
    errors: Vec<Vec<f64>>,
    /// What it takes off the sum of errors alone, each joint in units of what is left of it.
    gain: f64,
    /// Has the change a shape at the end of its range?
    at_bound: bool,
}

impl Sieve<'_> {
    /// Which of the changes that are offered, the most plausible first, take something sure off the simulated position's
    /// error along the command of `check`, taken up one after the other. First comes what, fitted alone, takes most off
    /// that; of what takes as much the most plausible that no other is surely better than beside what there is already,
    /// and the others like that are its equals. Many values always follow the recording better that they are fitted to:
    /// that tells nothing.
    ///
    /// # Errors
    /// If the twin cannot be fitted or simulated.
    pub fn sift(&self, offers: &[Offer]) -> Result<Sifted, ServoError> {
        let mut twin = self.refits.before.twin.clone();
        let mut left = errors(&twin, self.check)?;
        let (mut stand, mut taken) = (Vec::new(), Vec::new());
        let mut open = self.alone(offers)?;
        for round in 0.. {
            if open.is_empty() {
                break;
            }
            // Every round takes up one or more.
            let at_most = round + open.len() as u64;
            self.refits.watch.bound("fitting causes together by simulation", round, at_most);
            let rivals = self.rivals(&open, offers);
            let beside = |alone: &&Tried| self.beside((&twin, &taken), offers, alone);
            let tried: Vec<Tried> = rivals.par_iter().map(beside).collect::<Result<_, _>>()?;
            let mut used: Vec<usize> = rivals.iter().map(|t| t.index).collect();
            let nearer = self.nearer(&left, tried, (&taken, offers))?;
            if let Some((best, equals)) = self.best(nearer) {
                used = vec![best.index];
                taken.push(offers[best.index].change.clone());
                // What looked the same as an earlier one and is there beside it is another.
                stand.iter_mut().for_each(|s: &mut Stands| s.equals.retain(|i| *i != best.index));
                stand.push(Stands { index: best.index, equals });
                (twin, left) = (best.twin, best.errors);
            }
            let overlaps = |t: &Tried| taken.iter().any(|c| offers[t.index].change.overlaps(c));
            open.retain(|t| !used.contains(&t.index) && !overlaps(t));
        }
        Ok(Sifted { stand, twin })
    }

    /// `sifted` with values in full, as long as that brings it no further from the recorded position.
    ///
    /// # Errors
    /// If the twin cannot be fitted or simulated.
    pub fn in_full(&self, sifted: &Twin, changes: &[Change]) -> Result<Refitted, ServoError> {
        let full = self.refits.all(sifted, changes)?;
        let [near, mended] = [sifted, &full.twin].map(|twin| errors(twin, self.check));
        let (near, mended) = (near?, mended?);
        match self.is_nearer(&mended, &near, 1) {
            true => self.refits.as_is(sifted, changes, &full),
            false => Ok(full),
        }
    }

    /// Each change alone, fitted to one recording: that with which the other is predicted best comes first. What no search
    /// says is there has to take something off alone.
    fn alone(&self, offers: &[Offer]) -> Result<Vec<Tried>, ServoError> {
        let before = errors(&self.refits.none()?, self.check)?;
        let units = self.units(&before);
        // Of a twin that runs away as given everything takes off as much.
        let size = |errors: &[Vec<f64>]| summed(errors, &units).iter().sum::<f64>();
        let given = size(&before).min(f64::MAX);
        let (done, count) = (AtomicU64::new(0), offers.len() as u64);
        let tell = |done| self.refits.watch.tell("fitting by simulation, cause", done, count);
        let of = |(index, offer): (usize, &Offer)| -> Result<Tried, ServoError> {
            let tried = self.tried(index, offer, self.refits.alone(&offer.change)?)?;
            tell(1 + done.fetch_add(1, Ordering::Relaxed));
            Ok(Tried { gain: given - size(&tried.errors), ..tried })
        };
        let mut all: Vec<Tried> =
            offers.par_iter().enumerate().map(of).collect::<Result<_, _>>()?;
        all.retain(|t| t.gain > 0.0 || offers[t.index].among == 1);
        all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Ok(all)
    }

    /// A twin that has changes already with one more, along the command of `check`.
    fn beside(
        &self,
        (twin, taken): (&Twin, &[Change]),
        offers: &[Offer],
        alone: &Tried,
    ) -> Result<Tried, ServoError> {
        let offer = &offers[alone.index];
        let twin = self.refits.beside(twin, &with(taken, offer), &alone.twin)?;
        Ok(Tried { gain: alone.gain, ..self.tried(alone.index, offer, twin)? })
    }

    /// A twin that a change was fitted in, along the command of `check`; its gain alone is not known here.
    fn tried(&self, index: usize, offer: &Offer, twin: Twin) -> Result<Tried, ServoError> {
        let errors = errors(&twin, self.check)?;
        let at_bound = is_at_bound(&twin, &offer.change)?;
        Ok(Tried { index, twin, errors, gain: 0.0, at_bound })
    }

    /// What brings the error nearer than `left`. Where that is more than one, fitted in full: of rivals the last bit counts.
    fn nearer(
        &self,
        left: &[Vec<f64>],
        mut tried: Vec<Tried>,
        (taken, offers): (&[Change], &[Offer]),
    ) -> Result<Vec<Tried>, ServoError> {
        // What fits only at the end of its range is no cause.
        let stands =
            |t: &Tried| !t.at_bound && self.is_nearer(left, &t.errors, offers[t.index].among);
        tried.retain(stands);
        if tried.len() > 1 {
            let in_full = |t: &Tried| {
                let offer = &offers[t.index];
                let twin = self.refits.all(&t.twin, &with(taken, offer))?.twin;
                Ok(Tried { gain: t.gain, ..self.tried(t.index, offer, twin)? })
            };
            tried = tried.par_iter().map(in_full).collect::<Result<_, ServoError>>()?;
            tried.retain(stands);
        }
        Ok(tried)
    }

    /// The first, and what alone takes as much off where it acts, as far as simulations are exact and the recording tells.
    fn rivals<'t>(&self, open: &'t [Tried], offers: &[Offer]) -> Vec<&'t Tried> {
        let (first, inexact) = (&open[0], self.settings.criteria.least_gain_inexact);
        let meets = |t: &Tried| offers[t.index].change.meets(&offers[first.index].change);
        let as_much = |t: &Tried| t.gain >= (1.0 - inexact) * first.gain;
        let as_well = |t: &Tried| as_much(t) || !self.is_surely_nearer(&t.errors, &first.errors, 1);
        let is_rival =
            |t: &&Tried| t.index == first.index || meets(t) && t.gain > 0.0 && as_well(t);
        open.iter().filter(is_rival).collect()
    }

    /// The most plausible of those that the best is not surely nearer than, and the others of them.
    fn best(&self, tried: Vec<Tried>) -> Option<(Tried, Vec<usize>)> {
        let units = self.units(&tried.first()?.errors);
        let size = |t: &&Tried| summed(&t.errors, &units).iter().sum::<f64>();
        let nearest = tried.iter().min_by(|a, b| size(a).total_cmp(&size(b)))?.errors.clone();
        let as_near = |t: &Tried| !self.is_nearer(&t.errors, &nearest, 1);
        let mut equals: Vec<Tried> = tried.into_iter().filter(as_near).collect();
        equals.sort_by_key(|t| t.index);
        let mut equals = equals.into_iter();
        let first = equals.next()?;
        Some((first, equals.map(|t| t.index).collect()))
    }

    /// What is left of each joint, rad, at least its rounding.
    fn units(&self, left: &[Vec<f64>]) -> Vec<f64> {
        let least = self.check.resolution.iter().map(|r| r / 12f64.sqrt());
        let known = |left: f64| if left.is_finite() { left } else { 0.0 };
        means(left).into_iter().zip(least).map(|(left, least)| known(left).max(least)).collect()
    }

    /// Do errors surely shrink, and by enough, where so many are looked at? Each joint counts in units of what is left of it.
    fn is_nearer(&self, without: &[Vec<f64>], with: &[Vec<f64>], among: usize) -> bool {
        let (before, after) = (means(without), means(with));
        let moves = |means: &[f64]| means.iter().all(|m| m.is_finite());
        if !(moves(&before) && moves(&after)) {
            return moves(&after);
        }
        let largest = before.iter().zip(&after).map(|(b, a)| share(*b, *a)).fold(0.0, f64::max);
        // No simulation of an arm is exact to less.
        largest >= self.settings.criteria.least_gain_inexact
            && self.is_surely_nearer(without, with, among)
    }

    /// Would errors, both finite, shrink along other stretches of this motion?
    fn is_surely_nearer(&self, without: &[Vec<f64>], with: &[Vec<f64>], among: usize) -> bool {
        let units = self.units(with);
        let [b, a] = [without, with].map(|errors| summed(errors, &units));
        let [low, _] = interval(among, [&b, &a], self.check.dt, self.settings.seed, share);
        low > 0.0
    }
}

/// What was taken up, and one more.
fn with(taken: &[Change], offer: &Offer) -> Vec<Change> {
    taken.iter().chain([&offer.change]).cloned().collect()
}

/// Sizes of the simulated position's errors joint by joint, rad; infinite where the twin runs away.
fn errors(twin: &Twin, track: &Track) -> Result<Vec<Vec<f64>>, ServoError> {
    let used: Vec<usize> = (0..track.len()).filter(|&k| track.usable[k]).collect();
    match replay(twin, track, &track.stretches(f64::INFINITY)) {
        Ok(q) => {
            let size = |j: usize, k: usize| (q.joint(j)[k] - track.q.joint(j)[k]).abs();
            let of = |j: usize| used.iter().map(|&k| size(j, k)).collect();
            Ok((0..track.joints()).map(of).collect())
        }
        Err(ServoError::Diverged { .. }) => {
            Ok(vec![vec![f64::INFINITY; used.len()]; track.joints()])
        }
        Err(other) => Err(other),
    }
}

/// Share of a square that is taken off.
fn share(before: f64, after: f64) -> f64 {
    if before > 0.0 { 1.0 - (after / before).powi(2) } else { 0.0 }
}

fn means(errors: &[Vec<f64>]) -> Vec<f64> {
    errors.iter().map(|e| e.iter().sum::<f64>() / e.len().max(1) as f64).collect()
}

/// Over all joints, sample by sample.
fn summed(errors: &[Vec<f64>], units: &[f64]) -> Vec<f64> {
    let samples = errors.first().map_or(0, Vec::len);
    (0..samples).map(|k| errors.iter().zip(units).map(|(e, unit)| e[k] / unit).sum()).collect()
}
