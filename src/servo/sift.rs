//! Changes of a twin that bring its simulated position nearer to the recorded one.
//!
//! Both recordings are fitted in halves, and a change with which the simulated position does not surely come nearer to the
//! halves that it was not fitted to is none. With and without it the twin is fitted the same way: what another fit of the same
//! values changes is no merit of a change.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::ServoError;
use super::choice::{Choice, Sifted, Tried};
use super::folds::{Folds, LeftAsIs, Twins};
use super::refit::is_at_bound;
use super::screen::{Other, starts};
use super::sizes::Sizes;
use crate::diagnosis::{Change, Offer, Settings, Stands};

/// Fits of changes to halves of two recordings, and the other halves, which a change has to hold against.
pub struct Sieve<'a> {
    pub folds: &'a Folds<'a>,
    pub settings: &'a Settings,
}

/// Changes that are fitted beside what stands in one round, at most: those that promise most.
const TRIED: usize = 10;
/// What a change takes off where a fit of it begins is about so large a share of what it takes off in the end: one that promises
/// less than this share of the best cannot pass it.
const PROMISING: f64 = 0.5;

/// A change with which the twins come nearer before it is fitted, and where fits of it begin.
struct Promising {
    index: usize,
    starts: Twins,
    /// What each leaves there of the half that it is fitted to.
    left_own: [f64; 2],
    /// What it takes off there.
    gain: f64,
}

/// A round in which a change was taken up.
struct Round {
    /// What stood before, what was open then, what was tried beside it, and what was taken up.
    beside: Sifted,
    open: Vec<usize>,
    tried: Vec<Tried>,
    taken: Stands,
}

impl Sieve<'_> {
    /// Which of the changes that are offered, the most plausible first, take something sure off the simulated position's
    /// error, taken up one after the other: those that promise something are fitted, and each time that stands with which it comes
    /// nearest beside what there is already, of what takes off as much the most plausible; the others are its equals. What comes
    /// nearest alone may be in the way of several that come nearer together: so the strongest rival of each is taken up in its
    /// place, too, with all that follows, and is its equal where that comes as near. In the end each has to take something off
    /// beside all others.
    ///
    /// # Errors
    /// If the twin cannot be fitted or simulated.
    pub fn sift(&self, offers: &[Offer]) -> Result<Sifted, ServoError> {
        let choice = &Choice { offers, settings: self.settings };
        let mended = self.folds.before();
        let left = self.folds.left(&mended)?;
        let before = left.clone();
        let none = Sifted { stand: Vec::new(), mended, left, before };
        let open = (0..offers.len()).collect();
        // What has no tangent, as it was fitted once.
        let mut fitted = BTreeMap::new();
        let (first, rounds) = self.grown(none, open, choice, &mut fitted)?;
        let mut sifted = first.clone();
        for Round { beside, open, tried, taken } in rounds {
            let rival = choice.rival([&beside, &first], &tried, &taken);
            let Some((tried, rival)) = rival else { continue };
            let with = self.taken_up(&beside, (tried, rival.clone()), choice)?;
            let Some(instead) = with else { continue };
            let (instead, _) = self.grown(instead, open, choice, &mut fitted)?;
            sifted = choice.nearer([(sifted, taken), (instead, rival)]);
        }
        self.needed(sifted, choice)
    }

    /// What stands with those of the open changes that are taken up beside it, and the rounds in which they were.
    fn grown(
        &self,
        mut sifted: Sifted,
        mut open: Vec<usize>,
        choice: &Choice<'_>,
        fitted: &mut BTreeMap<usize, Twins>,
    ) -> Result<(Sifted, Vec<Round>), ServoError> {
        let mut rounds = Vec::new();
        for round in 0.. {
            open.retain(|i| choice.is_open(*i, &sifted));
            // Every round takes one up, or puts several aside.
            let at_most = round + open.len() as u64;
            self.folds.watch.bound("fitting causes together by simulation", round, at_most);
            let promising = self.promising(&sifted, choice, &open, fitted)?;
            if promising.is_empty() {
                break;
            }
            let worth = worth_a_fit(&promising);
            let mut used: Vec<usize> = worth.iter().map(|p| p.index).collect();
            let beside = |one: &Promising| self.beside(&sifted, choice, one);
            let tried: Vec<Tried> = worth.par_iter().map(beside).collect::<Result<_, _>>()?;
            if let Some((best, taken)) = choice.best(&sifted, tried.iter().collect()) {
                used = vec![taken.index];
                if let Some(with) = self.taken_up(&sifted, (best, taken.clone()), choice)? {
                    let beside = std::mem::replace(&mut sifted, with);
                    rounds.push(Round { beside, open: open.clone(), tried, taken });
                }
            }
            open.retain(|i| !used.contains(i));
        }
        Ok((sifted, rounds))
    }

    /// What stands with one more; `None` where that comes to nothing beside the others, all values fitted.
    fn taken_up(
        &self,
        sifted: &Sifted,
        (tried, one): (&Tried, Stands),
        choice: &Choice<'_>,
    ) -> Result<Option<Sifted>, ServoError> {
        let mut with = sifted.clone();
        with.add(one);
        self.fit_all(&mut with, (&tried.twins, &tried.left), choice)?;
        let (twins, left) = (with.mended.clone(), with.left.clone());
        let in_full = tried_in(twins, left, (tried.index, choice))?;
        Ok(choice.stands(sifted, &in_full).then_some(with))
    }

    /// Without what the others, taken up later, have made needless: what takes nothing sure off beside them, or has gone to the end
    /// of its range, the least first.
    fn needed(&self, mut sifted: Sifted, choice: &Choice<'_>) -> Result<Sifted, ServoError> {
        while !sifted.stand.is_empty() {
            let changes = sifted.changes(choice.offers);
            let without = |i: usize| -> Result<(usize, Twins, Sizes), ServoError> {
                let twins = self.folds.each(sifted.mended.each_ref(), |fold, mended| {
                    fold.refits.without(mended, &changes, i)
                })?;
                let left = self.folds.left(&twins)?;
                Ok((i, twins, left))
            };
            let all = 0..changes.len();
            let mut idle: Vec<_> =
                all.into_par_iter().map(without).collect::<Result<_, ServoError>>()?;
            let among = |i: usize| choice.offers[sifted.stand[i].index].among;
            let takes_off = |i: usize, without: &Sizes| {
                choice.takes_off(&sifted, [without, &sifted.left], among(i))
            };
            let bound = changes.iter().map(|c| are_at_bound(&sifted.mended, c));
            let bound: Vec<bool> = bound.collect::<Result<_, _>>()?;
            idle.retain(|(i, _, without)| bound[*i] || !takes_off(*i, without));
            let least = idle.into_iter().min_by(|a, b| a.2.ln().total_cmp(&b.2.ln()));
            let Some((i, twins, left)) = least else { break };
            sifted.stand.remove(i);
            self.fit_all(&mut sifted, (&twins, &left), choice)?;
        }
        Ok(sifted)
    }

    /// All values of what stands, which are near those of twins that leave so much, fitted together, as long as that brings them
    /// no further from the recorded position.
    fn fit_all(
        &self,
        sifted: &mut Sifted,
        (near, as_near): (&Twins, &Sizes),
        choice: &Choice<'_>,
    ) -> Result<(), ServoError> {
        let changes = sifted.changes(choice.offers);
        let full =
            self.folds.each(near.each_ref(), |fold, near| fold.refits.close(near, &changes))?;
        let left = self.folds.left(&full)?;
        let is_nearer = as_near.are_nearer(&left, 1, self.settings);
        (sifted.mended, sifted.left) = match is_nearer {
            true => (near.clone(), as_near.clone()),
            false => (full, left),
        };
        Ok(())
    }

    /// Those of the open changes that promise something beside what stands, most first: with which the twins come nearer before
    /// they are fitted.
    fn promising(
        &self,
        sifted: &Sifted,
        choice: &Choice<'_>,
        open: &[usize],
        fitted: &mut BTreeMap<usize, Twins>,
    ) -> Result<Vec<Promising>, ServoError> {
        let changes = sifted.changes(choice.offers);
        let both = self.folds.each([0, 1], |fold, k| {
            let other = |i: &usize| {
                let fitted = fitted.get(i).map(|twins| &twins[k]);
                Other { change: &choice.offers[*i].change, fitted }
            };
            let others: Vec<Other> = open.iter().map(other).collect();
            starts(&fold.refits, (&sifted.mended[k], &changes), &others)
        })?;
        let [first, second] = both;
        let mut told = Vec::new();
        for (&index, (first, second)) in open.iter().zip(first.into_iter().zip(second)) {
            let has_tangent = first.has_tangent && second.has_tangent;
            let starts = [first.twin, second.twin];
            if !has_tangent {
                fitted.entry(index).or_insert_with(|| starts.clone());
            }
            told.push((index, starts));
        }
        // Starts have open values by the same first order; what the other half says of them is asked of what is fitted.
        let as_is = self.folds.left_as_is(&sifted.mended)?.other;
        let gain = |(index, starts): (usize, Twins)| -> Result<_, ServoError> {
            let LeftAsIs { own: left_own, other: left } = self.folds.left_as_is(&starts)?;
            let is_nearer = left.are_nearer(&as_is, choice.offers[index].among, self.settings);
            let gain = as_is.ln() - left.ln();
            let all = sifted.before.ln() - sifted.left.ln() + gain;
            let is_promising = is_nearer && choice.is_more_than_inexact([gain, all], PROMISING);
            Ok(is_promising.then_some(Promising { index, starts, left_own, gain }))
        };
        let told: Vec<Option<Promising>> =
            told.into_par_iter().map(gain).collect::<Result<_, _>>()?;
        let mut told: Vec<Promising> = told.into_iter().flatten().collect();
        told.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Ok(told)
    }

    /// What stands with one more.
    fn beside(
        &self,
        sifted: &Sifted,
        choice: &Choice<'_>,
        Promising { index, starts, left_own, .. }: &Promising,
    ) -> Result<Tried, ServoError> {
        let changes = with(&sifted.changes(choice.offers), &choice.offers[*index]);
        let twins = self.folds.each([0, 1], |fold, k| {
            let fitted = fold.refits.beside(&sifted.mended[k], &changes, &starts[k])?;
            fold.nearer((&starts[k], left_own[k]), fitted)
        })?;
        let left = self.folds.left(&twins)?;
        tried_in(twins, left, (*index, choice))
    }
}

/// Twins that a change was fitted in, and what they leave.
fn tried_in(
    twins: Twins,
    left: Sizes,
    (index, choice): (usize, &Choice<'_>),
) -> Result<Tried, ServoError> {
    let at_bound = are_at_bound(&twins, &choice.offers[index].change)?;
    Ok(Tried { index, twins, left, at_bound })
}

/// Those that promise most, of changes that promise something, most first.
fn worth_a_fit(promising: &[Promising]) -> &[Promising] {
    // Nearer in sum may be further by shares: then none promises more than another.
    let least = promising.first().map_or(0.0, |most| most.gain.min(PROMISING * most.gain));
    let few = promising.iter().take(TRIED).take_while(|p| p.gain >= least).count();
    &promising[..few]
}

/// Has a change a value at the end of its range in one of the twins?
fn are_at_bound(twins: &Twins, change: &Change) -> Result<bool, ServoError> {
    let [a, b] = twins.each_ref().map(|twin| is_at_bound(twin, change));
    Ok(a? || b?)
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
                starts: Default::default(),
                left_own: [0.0; 2],
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
