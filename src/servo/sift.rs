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

/// Changes that are tried beside what stands, in one round: those that take off most alone, in which order they
/// are beside others is not known.
const TRIED: usize = 10;

/// Which changes stand, and the twin with them.
pub struct Sifted {
    pub stand: Vec<Stands>,
    pub mended: Refitted,
    /// What is left along the command of the other recording, each joint, rad.
    errors: Vec<Vec<f64>>,
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

impl Sifted {
    fn changes(&self, offers: &[Offer]) -> Vec<Change> {
        self.stand.iter().map(|s| offers[s.index].change.clone()).collect()
    }

    /// With one more, and others that do as well in its place.
    fn add(&mut self, index: usize, equals: Vec<usize>) {
        // What looked the same as an earlier one and is there beside it is another.
        self.stand.iter_mut().for_each(|s| s.equals.retain(|i| *i != index));
        self.stand.push(Stands { index, equals });
    }
}

impl Sieve<'_> {
    /// Which of the changes that are offered, the most plausible first, take something sure off the simulated position's
    /// error along the command of `check`, taken up one after the other: each time that with which it comes nearest beside
    /// what there is already; of what takes off as much the most plausible, and the others like that are its equals. Many
    /// values always follow the recording better that they are fitted to: that tells nothing. In the end each has to
    /// take something off beside all others.
    ///
    /// # Errors
    /// If the twin cannot be fitted or simulated.
    pub fn sift(&self, offers: &[Offer]) -> Result<Sifted, ServoError> {
        let mended = self.refits.before.clone();
        let errors = errors(&mended.twin, self.check)?;
        let mut sifted = Sifted { stand: Vec::new(), mended, errors };
        let mut open = self.alone(offers)?;
        for round in 0.. {
            if open.is_empty() {
                break;
            }
            // Every round takes one up, or puts several aside.
            let at_most = round + open.len() as u64;
            self.refits.watch.bound("fitting causes together by simulation", round, at_most);
            let beside = |alone: &Tried| self.beside(&sifted, offers, alone);
            let first = &open[..open.len().min(TRIED)];
            let tried: Vec<Tried> = first.par_iter().map(beside).collect::<Result<_, _>>()?;
            let mut used: Vec<usize> = first.iter().map(|t| t.index).collect();
            if let Some((best, equals)) = self.best(&sifted, tried, offers) {
                used = vec![best.index];
                sifted.add(best.index, equals);
                self.fit_all(&mut sifted, &best.twin, offers)?;
            }
            let taken = sifted.changes(offers);
            let overlaps = |t: &Tried| taken.iter().any(|c| offers[t.index].change.overlaps(c));
            open.retain(|t| !used.contains(&t.index) && !overlaps(t));
        }
        self.needed(sifted, offers)
    }

    /// Without what the others, taken up later, have made needless: what takes nothing sure off beside them, the least first.
    fn needed(&self, mut sifted: Sifted, offers: &[Offer]) -> Result<Sifted, ServoError> {
        while sifted.stand.len() > 1 {
            let changes = sifted.changes(offers);
            let without = |i: usize| -> Result<(usize, Twin, Vec<Vec<f64>>), ServoError> {
                let twin = self.refits.without(&sifted.mended.twin, &changes, i)?;
                let errors = errors(&twin, self.check)?;
                Ok((i, twin, errors))
            };
            let all = 0..changes.len();
            let mut idle: Vec<_> =
                all.into_par_iter().map(without).collect::<Result<_, ServoError>>()?;
            let among = |i: usize| offers[sifted.stand[i].index].among;
            idle.retain(|(i, _, without)| !self.is_nearer(without, &sifted.errors, among(*i)));
            let units = self.units(&sifted.errors);
            let least =
                idle.into_iter().min_by(|a, b| size(&a.2, &units).total_cmp(&size(&b.2, &units)));
            let Some((i, twin, _)) = least else { break };
            sifted.stand.remove(i);
            self.fit_all(&mut sifted, &twin, offers)?;
        }
        Ok(sifted)
    }

    /// All values of what stands, which are near those of a twin, fitted together, as long as that brings it no further from
    /// the recorded position.
    fn fit_all(
        &self,
        sifted: &mut Sifted,
        near: &Twin,
        offers: &[Offer],
    ) -> Result<(), ServoError> {
        let changes = sifted.changes(offers);
        let full = self.refits.all(near, &changes)?;
        let [as_near, mended] = [near, &full.twin].map(|twin| errors(twin, self.check));
        let (as_near, mended) = (as_near?, mended?);
        (sifted.mended, sifted.errors) = match self.is_nearer(&mended, &as_near, 1) {
            true => (self.refits.as_is(near, &changes, &full)?, as_near),
            false => (full, mended),
        };
        Ok(())
    }

    /// Each change alone, fitted to one recording: that with which the other is predicted best comes first. What no search
    /// says is there has to take something off alone.
    fn alone(&self, offers: &[Offer]) -> Result<Vec<Tried>, ServoError> {
        let before = errors(&self.refits.none()?, self.check)?;
        let units = self.units(&before);
        // Of a twin that runs away as given everything takes off as much.
        let given = size(&before, &units).min(f64::MAX);
        let (done, count) = (AtomicU64::new(0), offers.len() as u64);
        let tell = |done| self.refits.watch.tell("fitting by simulation, cause", done, count);
        let of = |(index, offer): (usize, &Offer)| -> Result<Tried, ServoError> {
            let tried = self.tried(index, offer, self.refits.alone(&offer.change)?)?;
            tell(1 + done.fetch_add(1, Ordering::Relaxed));
            Ok(Tried { gain: given - size(&tried.errors, &units), ..tried })
        };
        let mut all: Vec<Tried> =
            offers.par_iter().enumerate().map(of).collect::<Result<_, _>>()?;
        all.retain(|t| t.gain > 0.0 || offers[t.index].among == 1);
        all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Ok(all)
    }

    /// What stands with one more, along the command of `check`.
    fn beside(
        &self,
        sifted: &Sifted,
        offers: &[Offer],
        alone: &Tried,
    ) -> Result<Tried, ServoError> {
        let changes = with(&sifted.changes(offers), &offers[alone.index]);
        let twin = self.refits.beside(&sifted.mended.twin, &changes, &alone.twin)?;
        Ok(Tried { gain: alone.gain, ..self.tried(alone.index, &offers[alone.index], twin)? })
    }

    /// A twin that a change was fitted in, along the command of `check`; its gain alone is not known here.
    fn tried(&self, index: usize, offer: &Offer, twin: Twin) -> Result<Tried, ServoError> {
        let errors = errors(&twin, self.check)?;
        let at_bound = is_at_bound(&twin, &offer.change)?;
        Ok(Tried { index, twin, errors, gain: 0.0, at_bound })
    }

    /// The most plausible of those with which the error comes nearest, if it does, and the others of them.
    fn best(
        &self,
        sifted: &Sifted,
        mut tried: Vec<Tried>,
        offers: &[Offer],
    ) -> Option<(Tried, Vec<usize>)> {
        // What fits only at the end of its range is no cause.
        let stands = |t: &Tried| {
            let among = offers[t.index].among;
            !t.at_bound && self.is_nearer(&sifted.errors, &t.errors, among)
        };
        tried.retain(stands);
        let mut nearest = self.nearest(&sifted.errors, tried);
        nearest.sort_by_key(|t| t.index);
        let mut nearest = nearest.into_iter();
        let first = nearest.next()?;
        let meets = |t: &Tried| offers[t.index].change.meets(&offers[first.index].change);
        let equals = nearest.filter(meets).map(|t| t.index).collect();
        Some((first, equals))
    }

    /// Those that take off as much as any of them, or surely no less: a twin that is wrong otherwise tells no more.
    fn nearest(&self, before: &[Vec<f64>], mut tried: Vec<Tried>) -> Vec<Tried> {
        let Some(first) = tried.first() else { return tried };
        let units = self.units(&first.errors);
        let size = |errors: &[Vec<f64>]| size(errors, &units);
        let nearest = tried.iter().min_by(|a, b| size(&a.errors).total_cmp(&size(&b.errors)));
        let nearest = nearest.map(|t| t.errors.clone()).unwrap_or_default();
        let gain = size(before) - size(&nearest);
        let wrong_by = self.settings.criteria.least_gain_inexact * gain;
        // Where the twin runs away without, gains are no measure.
        let most = size(&nearest) + if gain.is_finite() { wrong_by } else { 0.0 };
        let is_near = |t: &Tried| size(&t.errors) <= most;
        tried.retain(|t| is_near(t) || !self.is_nearer(&t.errors, &nearest, 1));
        tried
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

/// Errors of all joints together, each in units of its own.
fn size(errors: &[Vec<f64>], units: &[f64]) -> f64 {
    summed(errors, units).iter().sum()
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
