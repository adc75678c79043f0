//! Changes of a twin that bring its simulated position nearer to the recorded one.
//!
//! A search sees them along one motion. What it finds there must hold where the twin is led along another command:
//! a change with which the simulated position does not surely come nearer is none. With and without it the twin is fitted
//! the same way: what another fit of the same values changes is no merit of a change.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::ServoError;
use super::refit::{Refits, Refitted, is_at_bound};
use super::rivals::{Named, Rivals};
use super::screen::{Other, Start, Starts, starts};
use super::sizes::{Sizes, as_little};
use super::yardstick::Yardstick;
use crate::diagnosis::{Change, Criteria, Offer, Settings, Stands};
use crate::twin::Twin;

/// Fits of changes to one recording, and another along whose command a change has to hold.
pub struct Sieve<'a> {
    pub refits: &'a Refits<'a>,
    /// The recording of `refits`, and the other.
    pub both: [&'a Yardstick<'a>; 2],
    pub settings: &'a Settings,
}

/// Changes that are fitted beside what stands in one round, at most, and names that are held beside the best of them: those that
/// promise most, of the other recording and of both.
const TRIED: usize = 10;
/// What a change takes off where a fit of it begins is about so large a share of what it takes off in the end: one that promises
/// less than this share of the best cannot pass it.
const PROMISING: f64 = 0.5;

/// Which changes stand, and the twin with them.
#[derive(Clone)]
pub struct Sifted {
    pub stand: Vec<Stands>,
    pub mended: Refitted,
    /// Along the command of the other recording.
    left: Sizes,
}

/// A change with which the twin comes nearer before it is fitted, and where a fit of it begins.
struct Promising {
    index: usize,
    start: Twin,
    /// What it takes off there.
    gain: f64,
}

/// A twin with one change more.
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
    /// error, taken up one after the other: those that promise something are fitted, and each time that stands with which it comes
    /// nearest along the command of the other recording beside what there is already, of what takes off as much the most
    /// plausible. What both recordings do not tell from it is its equal. Many values always follow the recording better that they
    /// are fitted to: that tells nothing. In the end each has to take something off beside all others.
    ///
    /// # Errors
    /// If the twin cannot be fitted or simulated.
    pub fn sift(&self, offers: &[Offer]) -> Result<Sifted, ServoError> {
        let mended = self.refits.before.clone();
        let left = self.left(&mended.twin)?;
        let mut sifted = Sifted { stand: Vec::new(), mended, left };
        let mut open: Vec<usize> = (0..offers.len()).collect();
        // What has no tangent, as it was fitted once.
        let mut fitted = BTreeMap::new();
        for round in 0.. {
            // Every round takes one up, or puts several aside.
            let at_most = round + open.len() as u64;
            self.refits.watch.bound("fitting causes together by simulation", round, at_most);
            let promising = self.promising(&sifted, offers, &open, &mut fitted)?;
            if promising.is_empty() {
                break;
            }
            let worth = worth_a_fit(&promising);
            let mut used: Vec<usize> = worth.iter().map(|p| p.index).collect();
            let beside = |one: &Promising| self.beside(&sifted, offers, one);
            let tried: Vec<Tried> = worth.par_iter().map(beside).collect::<Result<_, _>>()?;
            if let Some(best) = self.best(&sifted, &tried, offers) {
                used = vec![best.index];
                let equals = self.equals(&sifted, (best, &tried), &promising, offers)?;
                sifted = self.taken_up(sifted, (best, equals), offers)?;
            }
            let taken = sifted.changes(offers);
            let overlaps = |i: usize| taken.iter().any(|c| offers[i].change.overlaps(c));
            open.retain(|i| !used.contains(i) && !overlaps(*i));
        }
        self.needed(sifted, offers)
    }

    /// What stands with one more and all values fitted, beside which that may come to nothing: then without it.
    fn taken_up(
        &self,
        sifted: Sifted,
        (one, equals): (&Tried, Vec<usize>),
        offers: &[Offer],
    ) -> Result<Sifted, ServoError> {
        let mut with = sifted.clone();
        with.add(one.index, equals);
        self.fit_all(&mut with, &one.twin, offers)?;
        let in_full = self.tried(one.index, offers, with.mended.twin.clone())?;
        Ok(if self.stands(&sifted, &in_full, offers) { with } else { sifted })
    }

    /// Without what the others, taken up later, have made needless: what takes nothing sure off beside them, is not told by the
    /// recording it was fitted to, or has gone to the end of its range, the least first.
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
            let is_none = |c: &Change| -> Result<bool, ServoError> {
                let twin = &sifted.mended.twin;
                Ok(is_at_bound(twin, c)? || !self.refits.tells(twin, &changes, c)?)
            };
            let none: Vec<bool> = changes.iter().map(is_none).collect::<Result<_, _>>()?;
            idle.retain(|(i, _, without)| none[*i] || !takes_off(*i, without));
            let least = idle.into_iter().min_by(|a, b| a.2.ln().total_cmp(&b.2.ln()));
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

    /// Those of the open changes that promise something beside what stands, most first: with which the twin comes nearer before
    /// they are fitted.
    fn promising(
        &self,
        sifted: &Sifted,
        offers: &[Offer],
        open: &[usize],
        fitted: &mut BTreeMap<usize, Twin>,
    ) -> Result<Vec<Promising>, ServoError> {
        let changes = sifted.changes(offers);
        let other = |i: &usize| Other { change: &offers[*i].change, fitted: fitted.get(i) };
        let others: Vec<Other> = open.iter().map(other).collect();
        let Starts { without, with } =
            starts(self.refits, (&sifted.mended.twin, &changes), &others)?;
        let now = self.left(&without)?;
        let left = with.par_iter().map(|start| self.left(&start.twin));
        let left: Vec<Sizes> = left.collect::<Result<_, _>>()?;
        let mut told = Vec::new();
        for ((&index, Start { twin, has_tangent }), left) in open.iter().zip(with).zip(left) {
            if !has_tangent {
                fitted.entry(index).or_insert_with(|| twin.clone());
            }
            if left.are_nearer(&now, offers[index].among, self.settings) {
                told.push(Promising { index, start: twin, gain: now.ln() - left.ln() });
            }
        }
        told.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Ok(told)
    }

    /// What stands with one more.
    fn beside(
        &self,
        sifted: &Sifted,
        offers: &[Offer],
        Promising { index, start, .. }: &Promising,
    ) -> Result<Tried, ServoError> {
        let changes = with(&sifted.changes(offers), &offers[*index]);
        let twin = self.refits.beside(&sifted.mended.twin, &changes, start)?;
        self.tried(*index, offers, twin)
    }

    /// A twin that a change was fitted in.
    fn tried(&self, index: usize, offers: &[Offer], twin: Twin) -> Result<Tried, ServoError> {
        let left = self.left(&twin)?;
        let at_bound = is_at_bound(&twin, &offers[index].change)?;
        Ok(Tried { index, twin, left, at_bound })
    }

    /// The most plausible of those with which the error comes nearest, if it does.
    fn best<'a>(&self, sifted: &Sifted, tried: &'a [Tried], offers: &[Offer]) -> Option<&'a Tried> {
        let stand = tried.iter().filter(|t| self.stands(sifted, t, offers)).collect();
        self.nearest(&sifted.left, stand).into_iter().min_by_key(|t| t.index)
    }

    /// Names in the place of the best that both recordings together do not tell from it, the most plausible first.
    fn equals(
        &self,
        sifted: &Sifted,
        (best, tried): (&Tried, &[Tried]),
        promising: &[Promising],
        offers: &[Offer],
    ) -> Result<Vec<usize>, ServoError> {
        let Criteria { least_gain_inexact: inexact, .. } = self.settings.criteria;
        let rivals = Rivals { refits: self.refits, both: self.both, inexact };
        let taken = sifted.changes(offers);
        let named = |near, index: usize| Named { near, changes: with(&taken, &offers[index]) };
        let fitted = |p: &Promising| tried.iter().find(|t| t.index == p.index).map(|t| &t.twin);
        let meets = |p: &&Promising| {
            p.index != best.index && offers[p.index].change.meets(&offers[best.index].change)
        };
        let others: Vec<&Promising> = promising.iter().filter(meets).collect();
        let mut others = self.promise_of_both(others)?;
        others.truncate(TRIED);
        others.sort_by_key(|p| p.index);
        let by_name: Vec<Named> =
            others.iter().map(|p| named(fitted(p).unwrap_or(&p.start), p.index)).collect();
        let without = Named { near: &sifted.mended.twin, changes: taken.clone() };
        let are_equal = rivals.equals(&without, &named(&best.twin, best.index), &by_name)?;
        Ok(others.iter().zip(are_equal).filter(|(_, is)| *is).map(|(p, _)| p.index).collect())
    }

    /// Those that leave least of both recordings where a fit of them begins come first.
    fn promise_of_both<'a>(
        &self,
        all: Vec<&'a Promising>,
    ) -> Result<Vec<&'a Promising>, ServoError> {
        let of = |p: &&'a Promising| -> Result<_, ServoError> {
            let [fit, check] = self.both.map(|one| one.left(&p.start));
            Ok((fit?.ln() + check?.ln(), *p))
        };
        let mut all: Vec<(f64, &Promising)> = all.par_iter().map(of).collect::<Result<_, _>>()?;
        all.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        Ok(all.into_iter().map(|(_, p)| p).collect())
    }

    /// Those that take off as much as any of them, or surely no less: a twin that is wrong otherwise tells no more.
    fn nearest<'a>(&self, before: &Sizes, mut tried: Vec<&'a Tried>) -> Vec<&'a Tried> {
        let all = tried.iter().map(|t| &t.left);
        let Some(nearest) = all.min_by(|a, b| a.ln().total_cmp(&b.ln())) else { return tried };
        let inexact = self.settings.criteria.least_gain_inexact;
        let most = as_little(before.ln(), nearest.ln(), inexact);
        let is_near =
            |sizes: &Sizes| sizes.ln() <= most || !nearest.are_nearer(sizes, 1, self.settings);
        tried.retain(|t| is_near(&t.left));
        tried
    }

    /// Does a change come nearer than without it? What fits only at the end of its range is no cause.
    fn stands(&self, before: &Sifted, with: &Tried, offers: &[Offer]) -> bool {
        let among = offers[with.index].among;
        !with.at_bound && with.left.are_nearer(&before.left, among, self.settings)
    }

    fn left(&self, twin: &Twin) -> Result<Sizes, ServoError> {
        self.both[1].left(twin)
    }
}

/// Those that promise most, of changes that promise something, most first.
fn worth_a_fit(promising: &[Promising]) -> &[Promising] {
    // Nearer in sum may be further by shares: then none promises more than another.
    let least = promising.first().map_or(0.0, |most| most.gain.min(PROMISING * most.gain));
    let few = promising.iter().take(TRIED).take_while(|p| p.gain >= least).count();
    &promising[..few]
}

/// What was taken up, and one more.
fn with(taken: &[Change], offer: &Offer) -> Vec<Change> {
    taken.iter().chain([&offer.change]).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Some of what promises is always worth a fit, or a search would not end.
    #[test]
    fn the_best_of_what_promises_is_worth_a_fit() {
        let promising = |gains: &[f64]| -> Vec<Promising> {
            let one = |(index, gain): (usize, &f64)| Promising {
                index,
                start: Twin::default(),
                gain: *gain,
            };
            gains.iter().enumerate().map(one).collect()
        };
        let worth = |gains: &[f64]| worth_a_fit(&promising(gains)).len();
        assert_eq!(worth(&[1.0, 0.6, 0.4]), 2);
        assert_eq!(worth(&[-0.1, -0.3]), 1, "nearer in sum, further by shares");
        assert_eq!(worth(&[1.0; 30]), TRIED);
        assert_eq!(worth(&[]), 0);
    }
}
