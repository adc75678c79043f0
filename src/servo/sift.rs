//! Changes of a twin that bring its simulated position nearer to the recorded one.
//!
//! A search sees them along one motion. What it finds there must hold where the twin is led along another command:
//! a change with which the simulated position does not surely come nearer is none. With and without it the twin is fitted
//! the same way: what another fit of the same values changes is no merit of a change.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::refit::{Refits, Refitted, is_at_bound};
use super::sizes::Sizes;
use super::{ServoError, Track};
use crate::diagnosis::{Change, Offer, Settings, Stands};
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
#[derive(Clone)]
pub struct Sifted {
    pub stand: Vec<Stands>,
    pub mended: Refitted,
    /// Along the command of the other recording.
    left: Sizes,
}

/// A twin with one change alone, or with one more.
struct Tried {
    index: usize,
    twin: Twin,
    left: Sizes,
    /// Has the change a value at the end of its range?
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
    /// error, taken up one after the other: each time that with which it comes nearest along the command of `check` beside
    /// what there is already; of what takes off as much the most plausible, and the others like that are its equals. Many
    /// values always follow the recording better that they are fitted to: that tells nothing. In the end each has to
    /// take something off beside all others.
    ///
    /// # Errors
    /// If the twin cannot be fitted or simulated.
    pub fn sift(&self, offers: &[Offer]) -> Result<Sifted, ServoError> {
        let mended = self.refits.before.clone();
        let left = self.left(&mended.twin)?;
        let mut sifted = Sifted { stand: Vec::new(), mended, left };
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
            if let Some((best, equals)) = self.best(&sifted, tried, offers)? {
                used = vec![best.index];
                sifted = self.taken_up(sifted, (best, equals), offers)?;
            }
            let taken = sifted.changes(offers);
            let overlaps = |t: &Tried| taken.iter().any(|c| offers[t.index].change.overlaps(c));
            open.retain(|t| !used.contains(&t.index) && !overlaps(t));
        }
        self.needed(sifted, offers)
    }

    /// What stands with one more and all values fitted, beside which that may come to nothing: then without it.
    fn taken_up(
        &self,
        sifted: Sifted,
        (one, equals): (Tried, Vec<usize>),
        offers: &[Offer],
    ) -> Result<Sifted, ServoError> {
        let mut with = sifted.clone();
        with.add(one.index, equals);
        self.fit_all(&mut with, &one.twin, offers)?;
        let in_full = self.tried(one.index, offers, with.mended.twin.clone())?;
        Ok(if self.stands(&sifted, &in_full, offers) { with } else { sifted })
    }

    /// Without what the others, taken up later, have made needless: what takes nothing sure off beside them, or has gone to the
    /// end of its range, the least first.
    fn needed(&self, mut sifted: Sifted, offers: &[Offer]) -> Result<Sifted, ServoError> {
        while sifted.stand.len() > 1 {
            let changes = sifted.changes(offers);
            let without = |i: usize| -> Result<(usize, Twin, Sizes), ServoError> {
                let twin = self.refits.without(&sifted.mended.twin, &changes, i)?;
                let left = self.left(&twin)?;
                Ok((i, twin, left))
            };
            let all = 0..changes.len();
            let mut idle: Vec<_> =
                all.into_par_iter().map(without).collect::<Result<_, ServoError>>()?;
            let among = |i: usize| offers[sifted.stand[i].index].among;
            let takes_off = |i: usize, without: &Sizes| {
                sifted.left.are_nearer(without, among(i), self.settings)
            };
            let is_at_bound = |c: &Change| is_at_bound(&sifted.mended.twin, c);
            let at_bound: Vec<bool> = changes.iter().map(is_at_bound).collect::<Result<_, _>>()?;
            idle.retain(|(i, _, without)| at_bound[*i] || !takes_off(*i, without));
            let units = sifted.left.units();
            let sum = |left: &Sizes| left.sum(&units);
            let least = idle.into_iter().min_by(|a, b| sum(&a.2).total_cmp(&sum(&b.2)));
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
        let [as_near, mended] = [near, &full.twin].map(|twin| self.left(twin));
        let (as_near, mended) = (as_near?, mended?);
        let is_nearer = as_near.are_nearer(&mended, 1, self.settings);
        (sifted.mended, sifted.left) = match is_nearer {
            true => (self.refits.as_is(near, &changes)?, as_near),
            false => (full, mended),
        };
        Ok(())
    }

    /// Each change alone, fitted to one recording: that with which the other is predicted best comes first. What no search
    /// says is there has to take something off alone.
    fn alone(&self, offers: &[Offer]) -> Result<Vec<Tried>, ServoError> {
        let before = self.left(&self.refits.none()?)?;
        let units = before.units();
        // Of a twin that runs away as given everything takes off as much.
        let given = before.sum(&units).min(f64::MAX);
        let (done, count) = (AtomicU64::new(0), offers.len() as u64);
        let tell = |done| self.refits.watch.tell("fitting by simulation, cause", done, count);
        let of = |(index, offer): (usize, &Offer)| -> Result<(f64, Tried), ServoError> {
            let tried = self.tried(index, offers, self.refits.alone(&offer.change)?)?;
            tell(1 + done.fetch_add(1, Ordering::Relaxed));
            Ok((given - tried.left.sum(&units), tried))
        };
        let mut all: Vec<(f64, Tried)> =
            offers.par_iter().enumerate().map(of).collect::<Result<_, _>>()?;
        all.retain(|(gain, t)| *gain > 0.0 || offers[t.index].among == 1);
        all.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        Ok(all.into_iter().map(|(_, tried)| tried).collect())
    }

    /// What stands with one more.
    fn beside(
        &self,
        sifted: &Sifted,
        offers: &[Offer],
        alone: &Tried,
    ) -> Result<Tried, ServoError> {
        let changes = with(&sifted.changes(offers), &offers[alone.index]);
        let twin = self.refits.beside(&sifted.mended.twin, &changes, &alone.twin)?;
        self.tried(alone.index, offers, twin)
    }

    /// A twin that a change was fitted in.
    fn tried(&self, index: usize, offers: &[Offer], twin: Twin) -> Result<Tried, ServoError> {
        let left = self.left(&twin)?;
        let at_bound = is_at_bound(&twin, &offers[index].change)?;
        Ok(Tried { index, twin, left, at_bound })
    }

    /// The most plausible of those with which the error comes nearest, if it does, and the others of them.
    fn best(
        &self,
        sifted: &Sifted,
        mut tried: Vec<Tried>,
        offers: &[Offer],
    ) -> Result<Option<(Tried, Vec<usize>)>, ServoError> {
        tried.retain(|t| self.stands(sifted, t, offers));
        let refined = |t: &Tried| {
            let changes = with(&sifted.changes(offers), &offers[t.index]);
            let twin = self.refits.refined(&t.twin, &changes)?;
            self.tried(t.index, offers, twin)
        };
        // What stands is fitted by long stretches: another fit of the same values is no merit of a change.
        tried = tried.par_iter().map(refined).collect::<Result<_, ServoError>>()?;
        tried.retain(|t| self.stands(sifted, t, offers));
        let mut nearest = self.nearest(&sifted.left, tried);
        nearest.sort_by_key(|t| t.index);
        let mut nearest = nearest.into_iter();
        let Some(first) = nearest.next() else { return Ok(None) };
        let meets = |t: &Tried| offers[t.index].change.meets(&offers[first.index].change);
        let equals = nearest.filter(meets).map(|t| t.index).collect();
        Ok(Some((first, equals)))
    }

    /// Those that take off as much as any of them, or surely no less: a twin that is wrong otherwise tells no more.
    fn nearest(&self, before: &Sizes, mut tried: Vec<Tried>) -> Vec<Tried> {
        let Some(first) = tried.first() else { return tried };
        let units = first.left.units();
        let sum = |sizes: &Sizes| sizes.sum(&units);
        let all = tried.iter().map(|t| &t.left);
        let Some(nearest) = all.min_by(|a, b| sum(a).total_cmp(&sum(b))).cloned() else {
            return tried;
        };
        let gain = sum(before) - sum(&nearest);
        let wrong_by = self.settings.criteria.least_gain_inexact * gain;
        // Where the twin runs away without, gains are no measure.
        let most = sum(&nearest) + if gain.is_finite() { wrong_by } else { 0.0 };
        let is_near =
            |sizes: &Sizes| sum(sizes) <= most || !nearest.are_nearer(sizes, 1, self.settings);
        tried.retain(|t| is_near(&t.left));
        tried
    }

    /// Does a change come nearer than without it? What fits only at the end of its range is no cause.
    fn stands(&self, before: &Sifted, with: &Tried, offers: &[Offer]) -> bool {
        let among = offers[with.index].among;
        !with.at_bound && with.left.are_nearer(&before.left, among, self.settings)
    }

    fn left(&self, twin: &Twin) -> Result<Sizes, ServoError> {
        Sizes::along(self.check, twin)
    }
}

/// What was taken up, and one more.
fn with(taken: &[Change], offer: &Offer) -> Vec<Change> {
    taken.iter().chain([&offer.change]).cloned().collect()
}
