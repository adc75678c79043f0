//! Which of several changes of a twin is taken up: by what each leaves of the simulated position's error.

use super::folds::Twins;
use super::sizes::{Sizes, is_more};
use crate::diagnosis::{Change, Offer, Settings, Stands};

/// Which changes stand, and the twins with them.
#[derive(Clone)]
pub struct Sifted {
    pub stand: Vec<Stands>,
    pub mended: Twins,
    /// What they leave of the halves that they were not fitted to.
    pub left: Sizes,
    /// What was left of these when nothing stood.
    pub before: Sizes,
}

/// Twins with one change more.
#[derive(Clone)]
pub struct Tried {
    pub index: usize,
    pub twins: Twins,
    pub left: Sizes,
    /// Has the change a value at the end of its range?
    pub at_bound: bool,
}

impl Sifted {
    pub fn changes(&self, offers: &[Offer]) -> Vec<Change> {
        self.stand.iter().map(|s| offers[s.index].change.clone()).collect()
    }

    /// Does a change stand, or one that does as well?
    pub fn holds(&self, index: usize) -> bool {
        self.stand.iter().any(|s| s.includes(index))
    }

    /// With one more.
    pub fn add(&mut self, one: Stands) {
        // What looked the same as an earlier one and is there beside it is another.
        self.stand.iter_mut().for_each(|s| s.equals.retain(|i| *i != one.index));
        self.stand.push(one);
    }

    /// What stands there, and others that do as well in its place.
    fn also(&mut self, index: usize, others: Stands) {
        let mut others: Vec<usize> = [others.index].into_iter().chain(others.equals).collect();
        others.retain(|i| !self.holds(*i));
        let own = self.stand.iter_mut().find(|s| s.index == index);
        own.into_iter().for_each(|s| s.equals.extend(&others));
    }
}

/// Chooses among changes that are offered, the most plausible first.
pub struct Choice<'a> {
    pub offers: &'a [Offer],
    pub settings: &'a Settings,
}

impl Choice<'_> {
    /// May a change be taken up beside what stands: is it neither there, nor in the whole arm what stands at some joints?
    pub fn is_open(&self, index: usize, sifted: &Sifted) -> bool {
        let overlaps = |s: &Stands| {
            let [own, other] = [index, s.index].map(|i| &self.offers[i].change);
            s.index == index || own.overlaps(other)
        };
        !sifted.stand.iter().any(overlaps)
    }

    /// The most plausible of those with which the error comes nearest, if it does, and the others.
    pub fn best<'a>(
        &self,
        sifted: &Sifted,
        mut tried: Vec<&'a Tried>,
    ) -> Option<(&'a Tried, Stands)> {
        tried.retain(|t| self.stands(sifted, t));
        let mut nearest = self.nearest(&sifted.left, tried);
        nearest.sort_by_key(|t| t.index);
        let (best, others) = nearest.split_first()?;
        let own = &self.offers[best.index].change;
        let others = others.iter().map(|t| t.index).filter(|i| self.offers[*i].change.meets(own));
        Some((best, Stands { index: best.index, equals: others.collect() }))
    }

    /// What would have been taken up beside the first, where a change acts, if neither that nor its equals were there, and its
    /// equals. What stands in the second, where the change does, is called for beside it: they are two causes.
    pub fn rival<'a>(
        &self,
        [beside, in_the_end]: [&Sifted; 2],
        tried: &'a [Tried],
        taken: &Stands,
    ) -> Option<(&'a Tried, Stands)> {
        let own = &self.offers[taken.index].change;
        let meets = |t: &&Tried| self.offers[t.index].change.meets(own);
        let is_rival = |t: &&Tried| !taken.includes(t.index) && !in_the_end.holds(t.index);
        self.best(beside, tried.iter().filter(meets).filter(is_rival).collect())
    }

    /// Which of two sets of changes stands, in the second of which one change was taken up in place of one of the first: the set
    /// that comes nearer. Where they come as near, and what is replaced is called for in the first alone, that of fewer changes,
    /// or else of the more plausible of the two, and the other is an equal of this one.
    pub fn nearer(&self, [own, rival]: [(Sifted, Stands); 2]) -> Sifted {
        let is_nearer = |without: &Sifted, with: &Sifted| {
            self.takes_off(&own.0, [&without.left, &with.left], 1)
        };
        if is_nearer(&own.0, &rival.0) {
            return rival.0;
        }
        let [is_in_own, is_in_rival] = [&own.0, &rival.0].map(|sifted| sifted.holds(own.1.index));
        if is_nearer(&rival.0, &own.0) || !is_in_own || is_in_rival {
            return own.0;
        }
        let costs = |(sifted, one): &(Sifted, Stands)| (sifted.stand.len(), one.index);
        let [simple, other] = if costs(&rival) < costs(&own) { [rival, own] } else { [own, rival] };
        let (mut sifted, Stands { index, .. }) = simple;
        sifted.also(index, other.1);
        sifted
    }

    /// Those that take off as much as any of them, or surely no less: a twin that is wrong otherwise tells no more.
    fn nearest<'a>(&self, before: &Sizes, mut tried: Vec<&'a Tried>) -> Vec<&'a Tried> {
        let all = tried.iter().map(|t| &t.left);
        let Some(nearest) = all.min_by(|a, b| a.ln().total_cmp(&b.ln())) else { return tried };
        let is_near = |sizes: &Sizes| {
            let gains = [sizes, before].map(|sizes| sizes.ln() - nearest.ln());
            !self.is_more_than_inexact(gains, 1.0) || !nearest.are_nearer(sizes, 1, self.settings)
        };
        tried.retain(|t| is_near(&t.left));
        tried
    }

    /// Does a change come nearer than without it? What fits only at the end of its range is no cause.
    pub fn stands(&self, sifted: &Sifted, with: &Tried) -> bool {
        let among = self.offers[with.index].among;
        !with.at_bound && self.takes_off(sifted, [&sifted.left, &with.left], among)
    }

    /// Is something surely taken off between two twins, by more than the laws are exact to that take off all the rest?
    pub fn takes_off(&self, sifted: &Sifted, [without, with]: [&Sizes; 2], among: usize) -> bool {
        let gains = [without, &sifted.before].map(|sizes| sizes.ln() - with.ln());
        with.are_nearer(without, among, self.settings) && self.is_more_than_inexact(gains, 1.0)
    }

    /// Is the first of two gains, of a change and of all that is taken off with it, more than the share of the second, or `part` of it,
    /// to which no law is exact?
    pub fn is_more_than_inexact(&self, gains: [f64; 2], part: f64) -> bool {
        is_more(part * self.settings.criteria.least_gain_inexact, gains)
    }
}

#[cfg(test)]
mod tests {
    use super::super::sizes::tests::about;
    use super::*;

    fn alone(index: usize) -> Stands {
        Stands { index, equals: vec![] }
    }

    /// Names of what is best with its equals, and of its rival with that one's, among changes that leave so much of two
    /// joints, mrad, where those stand in the end that are told by their place.
    fn chosen<'a>(
        tried: &[(&'a str, &[usize], f64)],
        in_the_end: &[usize],
    ) -> (Vec<&'a str>, Vec<&'a str>) {
        let offer = |(effect, joints, _): &(&str, &[usize], f64)| {
            let (effect, joints) = ((*effect).to_string(), joints.to_vec());
            Offer {
                change: Change { effect, joints, parameters: vec![], replaces: false },
                among: 1,
            }
        };
        let offers: Vec<Offer> = tried.iter().map(offer).collect();
        let choice = Choice { offers: &offers, settings: &Settings::default() };
        let sizes = |mrad: f64| about([1e-3 * mrad; 2]);
        let none = Sifted {
            stand: vec![],
            mended: Twins::default(),
            left: sizes(8.0),
            before: sizes(8.0),
        };
        let fitted = |(index, (_, _, mrad)): (usize, &(&str, &[usize], f64))| Tried {
            index,
            twins: Twins::default(),
            left: sizes(*mrad),
            at_bound: false,
        };
        let all: Vec<Tried> = tried.iter().enumerate().map(fitted).collect();
        let names = |one: Stands| -> Vec<&'a str> {
            [one.index].into_iter().chain(one.equals).map(|i| tried[i].0).collect()
        };
        let (_, best) = choice.best(&none, all.iter().collect()).unwrap();
        let mut last = none.clone();
        in_the_end.iter().for_each(|i| last.add(alone(*i)));
        let rival = choice.rival([&none, &last], &all, &best);
        (names(best), rival.map(|(_, rival)| names(rival)).unwrap_or_default())
    }

    #[test]
    fn a_rival_is_what_would_be_taken_up_in_place_of_a_change_and_its_equals() {
        let tried: [(&str, &[usize], f64); 5] = [
            ("payload", &[], 3.0),
            ("link_inertia", &[5], 3.1),
            ("servo_friction", &[], 2.0),
            ("servo_gain", &[], 2.05),
            ("servo_delay", &[], 6.0),
        ];
        let (best, rival) = chosen(&tried, &[2]);
        assert_eq!(best, ["servo_friction", "servo_gain"]);
        assert_eq!(rival, ["payload", "link_inertia"]);
        let (_, rival) = chosen(&tried, &[2, 0]);
        assert_eq!(rival, ["link_inertia"], "what stands beside it is another cause");
    }

    /// Sets of so many changes from that index on, that leave so much.
    fn nearer_of(both: [(std::ops::Range<usize>, f64); 2]) -> Vec<Stands> {
        let change = || Change {
            effect: String::new(),
            joints: vec![],
            parameters: vec![],
            replaces: false,
        };
        let offers: Vec<Offer> = (0..6).map(|_| Offer { change: change(), among: 1 }).collect();
        let choice = Choice { offers: &offers, settings: &Settings::default() };
        let sizes = |mrad: f64| about([1e-3 * mrad; 2]);
        let set = |(indices, mrad): (std::ops::Range<usize>, f64)| {
            let first = alone(indices.start);
            let stand = indices.map(alone).collect();
            let (left, before) = (sizes(mrad), sizes(8.0));
            (Sifted { stand, mended: Twins::default(), left, before }, first)
        };
        choice.nearer(both.map(set)).stand
    }

    #[test]
    fn of_sets_that_come_as_near_that_of_fewer_changes_stands_and_the_other_is_its_equal() {
        let named = |index: usize, other: usize| Stands { index, equals: vec![other] };
        assert_eq!(nearer_of([(3..4, 4.0), (0..2, 2.0)]), [alone(0), alone(1)], "the nearer one");
        assert_eq!(nearer_of([(3..4, 2.0), (0..2, 4.0)]), [alone(3)]);
        assert_eq!(nearer_of([(3..4, 2.0), (0..2, 2.01)]), [named(3, 0)], "the simpler one");
        assert_eq!(nearer_of([(3..5, 2.0), (0..2, 2.01)]), [named(0, 3), alone(1)], "as simple");
        assert_eq!(nearer_of([(1..2, 2.0), (0..2, 2.01)]), [alone(1)], "called for in both");
        assert_eq!(nearer_of([(0..2, 2.0), (4..6, 4.0)]), [alone(0), alone(1)]);
    }

    #[test]
    fn what_acts_elsewhere_is_no_rival() {
        let (best, rival) = chosen(&[("servo_offset", &[1], 2.0), ("servo_gain", &[2], 4.0)], &[0]);
        assert_eq!((best, rival), (vec!["servo_offset"], vec![]));
    }
}
