//! What a search that has not seen the check recording chooses.

use std::cell::OnceCell;

use super::candidate::{Candidate, Place, Term};
use super::data::Data;
use super::fit::Fit;
use super::hypotheses::{Hypotheses, Hypothesis, Standing};
use super::independent::{are_near, counted};
use super::judge::Gain;
use super::limits::odds_beyond;
use super::model::Model;
use super::ranking::is_equal;
use super::revise::{pruned, revised};
use super::search::Found;

/// What a search of the fit recording alone finds, and cannot tell from it.
pub struct Blind<'s, 'b> {
    search: &'s Hypotheses<'b>,
    found: &'s Found<'b>,
    /// Its causes among their rivals, as far as they were asked for.
    standings: Vec<OnceCell<Standing<'b>>>,
}

impl<'s, 'b> Blind<'s, 'b> {
    pub fn new(search: &'s Hypotheses<'b>, found: &'s Found<'b>) -> Self {
        let causes = found.last.model.causes.iter();
        Self { search, found, standings: causes.map(|_| OnceCell::new()).collect() }
    }

    /// Those of `causes` that are not chosen. How much a row counts depends on what is left of it: where these rows
    /// counted otherwise beside what both recordings show, `model`, it is seen whether that stands in them.
    pub fn misses<'k>(
        &self,
        model: &Model,
        causes: impl Iterator<Item = (&'k Standing<'k>, &'k Gain)>,
    ) -> Vec<Candidate> {
        let missed = |blind: &Blind<'_, '_>, (standing, gain): &(&Standing<'_>, &Gain)| {
            !blind.chooses(standing, gain)
        };
        let mut causes: Vec<_> = causes.filter(|c| missed(self, c)).collect();
        let again = (!causes.is_empty()).then(|| self.counted_beside(model)).flatten();
        if let Some(data) = again {
            let (candidates, criteria) = (self.search.candidates.clone(), self.search.criteria);
            let search = Hypotheses { data: &data, candidates, criteria };
            let found = upheld(&search, model.clone());
            let blind = Blind::new(&search, &found);
            causes.retain(|c| missed(&blind, c));
        }
        causes.iter().map(|(standing, _)| standing.cause().candidate()).collect()
    }

    /// These recordings, their rows counted beside `model`, where that is otherwise than they count.
    fn counted_beside(&self, model: &Model) -> Option<Data<'b>> {
        let data = counted(self.search.data, model);
        (!are_near(&data.shares, &self.search.data.shares)).then_some(data)
    }

    /// Is a cause among these, or what looks the same as it? Or does it look the same, in the fit recording, as one of
    /// these: then the check recording has told which of them it is. Each search also weighs what the other found, at
    /// its values: where a search comes to is by chance.
    pub fn chooses(&self, standing: &Standing<'_>, gain: &Gain) -> bool {
        let cause = standing.cause();
        let own = &self.found.last.model.causes;
        if standing.beyond && self.places_beyond(cause.candidate()) {
            return true;
        }
        let meets = |k: &usize| own[*k].candidate.extent().meets(cause.candidate().extent());
        (0..own.len()).filter(meets).any(|k| {
            is_same(own[k].candidate, cause.candidate())
                || self.looks_like(standing, &own[k], gain)
                || self.looks_like(self.standing(k), &cause.trial.term(), gain)
        })
    }

    /// Does it place a value rather beyond what it is known to than within? It had no choice of what to ask.
    fn places_beyond(&self, cause: Candidate) -> bool {
        odds_beyond(&self.found.last, cause, self.search.criteria.coverage)
            .is_some_and(|odds| odds > 0.0)
    }

    /// Does `term` look the same as the cause of `standing`, as that search has found it or at these values?
    fn looks_like(&self, standing: &Standing<'_>, term: &Term, gain: &Gain) -> bool {
        let criteria = &self.search.criteria;
        let equal = |h: &Hypothesis<'_>| is_equal(standing, gain, h, criteria);
        let found = |h: &&Hypothesis<'_>| is_same(h.candidate(), term.candidate);
        standing.ranked.iter().filter(found).any(equal)
            || equal(&self.search.tried(&standing.without, &standing.cause().fit.sizes, term))
    }

    fn standing(&self, k: usize) -> &Standing<'b> {
        self.standings[k].get_or_init(|| self.search.standing(&self.found.last, k))
    }
}

/// What these recordings uphold of a model.
fn upheld<'a>(search: &Hypotheses<'a>, mut model: Model) -> Found<'a> {
    let joints: Vec<usize> = (0..search.data.joints()).collect();
    model.causes.retain(|t| search.data.parts.iter().any(|p| t.candidate.is_in(p.index)));
    let fit = Fit::new(search.data, model, search.data.nothing()).settled();
    let fit = pruned(search, search.tuned(fit, &joints), |_| true);
    let causes = fit.model.causes.iter().map(|t| t.candidate).collect();
    Found { last: revised(search, fit, causes), ..Found::none(search) }
}

/// What acts in the whole arm is also there where it was found at a joint, and the other way round.
fn is_same(a: Candidate, b: Candidate) -> bool {
    let either = a.place == Place::Arm || b.place == Place::Arm;
    a.name() == b.name() && (a.place == b.place || either)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::criteria::Criteria;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::observed::Observed;
    use crate::diagnosis::trial;
    use crate::diagnosis::{Checked, Settings};
    use crate::effects::find;
    use crate::signals::Samples;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const JOINT: usize = 1;
    const OFFSET_NM: f64 = 1.5;
    /// Share of rows that count where the rest is slow.
    const FEW: f64 = 0.001;
    /// Slower than anything of the motion.
    const SLOW_RAD_S: f64 = 0.15;

    /// A law that is not exact, and takes half of what is left off the check recording.
    fn inexact() -> Gain {
        let shrink = Checked {
            check_before_nm: 1.0,
            check_after_nm: 0.7,
            fraction: 0.5,
            low: 0.4,
            high: 0.6,
        };
        Gain { shrink, where_exact: 0.0, where_inexact: 0.5, acts: true }
    }

    /// An arm with an offset at `JOINT`, and so much slow noise there, N.m.
    fn recorded(twin: &Twin, slow_nm: f64) -> Samples {
        let mut made = samples(6, 3000, |j, t| 0.7 * ((1.1 + 0.2 * j as f64) * t).sin());
        made.torque = twin.torque(&twin.motion(&made));
        let slow = (0..made.len()).map(|k| slow_nm * (SLOW_RAD_S * made.dt * k as f64).sin());
        let torque = made.torque.joint_mut(JOINT).iter_mut();
        torque.zip(slow).for_each(|(t, slow)| *t += OFFSET_NM + slow);
        noisy(&mut made, 0.3);
        made
    }

    /// Does a search that found `blind` choose an offset at `JOINT`?
    fn chooses(blind: Candidate) -> bool {
        let twin = Twin::default();
        let made = recorded(&twin, 0.0);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&observed]);
        let offset = at(JOINT, "current_offset");
        let candidates = vec![offset, at(JOINT, "coulomb_asymmetry"), at(0, "coulomb_asymmetry")];
        let all = Hypotheses { data: &data, candidates, criteria: Criteria::default() };
        let start = Fit::plain(&data, Model::of(&twin));
        let with = |c: Candidate| {
            let starts = c.starts(&start.motion(), &twin);
            let term = trial::tried(&start, &Term::new(c, starts[0].clone())).term();
            Fit::plain(&data, start.model.with(term))
        };
        let found = Found {
            start: start.clone(),
            last: with(blind),
            rounds: Vec::new(),
            screened: Vec::new(),
        };
        let mut standing = all.standing(&with(offset), 0);
        // Of the two recordings together the offset is surely the better name.
        standing.ranked.retain(|h| h.candidate() == offset);
        standing.index = 0;
        Blind::new(&all, &found).chooses(&standing, &inexact())
    }

    fn at(joint: usize, name: &str) -> Candidate {
        Candidate::new(find(name).unwrap(), Place::Joint(joint))
    }

    /// How many causes are missed by a search that found nothing, because few of its rows counted.
    fn missed(slow_nm: f64) -> usize {
        let twin = Twin::default();
        let made = recorded(&twin, slow_nm);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let [every, few] = [1.0, FEW].map(|share| {
            let data =
                Data::new(vec![&observed], &Settings { mass_error: 0.0, ..Settings::default() });
            data.counted(vec![vec![share; 6]])
        });
        let offset = at(JOINT, "current_offset");
        let search =
            |data| Hypotheses { data, candidates: vec![offset], criteria: Criteria::default() };
        let model = Model::of(&twin).with(Term::new(offset, vec![]));
        let standing = search(&every).standing(&Fit::plain(&every, model.clone()), 0);
        let alone = search(&few);
        let found = Found::none(&alone);
        let gain = inexact();
        let causes = std::iter::once((&standing, &gain));
        Blind::new(&alone, &found).misses(&model, causes).len()
    }

    #[test]
    fn a_cause_beside_which_more_rows_count_is_not_missed() {
        assert_eq!([0.0, 3.0].map(missed), [0, 1]);
    }

    #[test]
    fn a_search_chooses_what_it_found_and_what_it_cannot_tell_from_that() {
        assert!(chooses(at(JOINT, "current_offset")));
        assert!(chooses(at(JOINT, "coulomb_asymmetry")));
        assert!(!chooses(at(0, "coulomb_asymmetry")));
    }
}
