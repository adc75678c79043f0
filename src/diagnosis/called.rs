//! Which of what a search finds is called a cause.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::candidate::{Candidate, Place};
use super::fit::Fit;
use super::hypotheses::{Hypotheses, Hypothesis, Standing};
use super::judge::{Gain, Judge};
use super::ranking::{is_equal, is_mine, probability};
use super::search::Found;

/// The model with the causes that are called causes, each among its rivals.
pub struct Called<'a> {
    pub fit: Fit<'a>,
    pub standings: Vec<Standing<'a>>,
    pub gains: Vec<Gain>,
    /// What both recordings show together, and the fit recording alone does not.
    pub unconfirmed: Vec<Candidate>,
    /// Where a proof decided: what it cannot tell from each cause.
    pub equals: Option<Vec<Vec<Candidate>>>,
}

/// What stands of the search of both recordings: causes that are more probable than not, gain on the check
/// recording, and sit at no bound. What does not is left out, the weakest first, and the others are seen again
/// without it. Where the law is not exact, the search of the fit recording alone has to find the cause too.
pub fn called<'a>(
    search: &Hypotheses<'a>,
    judge: &Judge<'_>,
    found: &Found<'a>,
    blind: &Blind<'_, '_>,
) -> Called<'a> {
    let mut fit = found.last.clone();
    let (mut rejected, mut unconfirmed) = (Vec::new(), Vec::new());
    loop {
        // What costs least to see comes first.
        let count = fit.model.causes.len();
        let gains: Vec<Gain> = (0..count).into_par_iter().map(|i| judge.gain(&fit, i)).collect();
        let least = |a: &usize, b: &usize| gains[*a].largest().total_cmp(&gains[*b].largest());
        let agrees = |i: &usize| judge.agrees(&gains[*i], fit.model.causes[*i].candidate);
        if let Some(i) = (0..count).filter(|i| !agrees(i)).min_by(least) {
            fit = search.without(&fit, i);
            continue;
        }
        let standings = search.standings(&fit);
        if let Some(next) = corrected(search, judge, &fit, &standings, &gains, &mut rejected) {
            fit = next;
            continue;
        }
        let chosen = |i: &usize| blind.chooses(&standings[*i], &gains[*i]);
        let law = |i: &usize| {
            gains[*i].needs_replication(fit.model.causes[*i].candidate, &search.criteria)
        };
        let is_open = |i: &usize| law(i) && !chosen(i);
        let Some(i) = (0..count).filter(is_open).min_by(least) else {
            return Called { fit, standings, gains, unconfirmed, equals: None };
        };
        unconfirmed.push(fit.model.causes[i].candidate);
        fit = search.without(&fit, i);
    }
}

/// What a search of the fit recording alone finds.
pub struct Blind<'s, 'b> {
    search: &'s Hypotheses<'b>,
    found: &'s Found<'b>,
    /// Its causes among their rivals, as far as they were asked for.
    standings: Vec<OnceLock<Standing<'b>>>,
}

impl<'s, 'b> Blind<'s, 'b> {
    pub fn new(search: &'s Hypotheses<'b>, found: &'s Found<'b>) -> Self {
        let causes = found.last.model.causes.iter();
        Self { search, found, standings: causes.map(|_| OnceLock::new()).collect() }
    }

    /// Is the cause, or what looks the same as it, among these? Or does it look the same, in the fit recording, as
    /// what is: then the check recording has told which of them it is.
    fn chooses(&self, standing: &Standing<'_>, gain: &Gain) -> bool {
        let criteria = &self.search.criteria;
        let cause = standing.cause().candidate();
        let mine =
            |h: &&Hypothesis<'_>| is_mine(standing, h) || is_equal(standing, gain, h, criteria);
        let own = || self.found.last.model.causes.iter().map(|t| t.candidate);
        let is_own = |h: &Hypothesis<'_>| own().any(|c| is_same(h.candidate(), c));
        let looks_alike = |k: usize| {
            let other = self.standing(k);
            let equal = |h: &&Hypothesis<'_>| is_equal(other, gain, h, criteria);
            other.ranked.iter().filter(equal).any(|h| is_same(h.candidate(), cause))
        };
        let here = |k: &usize| own().nth(*k).is_some_and(|c| c.extent() == cause.extent());
        standing.ranked.iter().filter(mine).any(is_own)
            || (0..self.standings.len()).filter(here).any(looks_alike)
    }

    fn standing(&self, k: usize) -> &Standing<'b> {
        self.standings[k].get_or_init(|| self.search.standing(&self.found.last, k))
    }
}

/// What acts in the whole arm is also there where it was found at a joint, and the other way round.
fn is_same(a: Candidate, b: Candidate) -> bool {
    let either = a.place == Place::Arm || b.place == Place::Arm;
    a.name() == b.name() && (a.place == b.place || either)
}

/// The fit without the weakest cause that fails, or with the better one of two names; `None` where all stand.
/// What is `rejected` does not come back.
fn corrected<'a>(
    search: &Hypotheses<'a>,
    judge: &Judge<'_>,
    fit: &Fit<'a>,
    standings: &[Standing<'a>],
    gains: &[Gain],
    rejected: &mut Vec<Candidate>,
) -> Option<Fit<'a>> {
    let criteria = &search.criteria;
    let fails = |i: &usize| {
        let bound = standings[*i].cause().at_bound.is_some() || is_impossible(fit, *i);
        bound || probability(&standings[*i], &gains[*i], criteria) <= 0.5
    };
    let nats = |i: &usize| standings[*i].cause().nats;
    let weakest = (0..standings.len()).filter(fails).min_by(|a, b| nats(a).total_cmp(&nats(b)));
    let next = |standing: &Standing<'a>, rejected: &[Candidate], least: f64| {
        let fresh = |h: &&Hypothesis<'a>| {
            let inside = h.at_bound.is_none() && !rejected.contains(&h.candidate());
            inside && h.nats > least
        };
        standing.ranked.iter().find(fresh).map(|h| h.fit.clone())
    };
    if let Some(i) = weakest {
        // What fails may have stood in for what does not, and looks the same.
        rejected.push(standings[i].cause().candidate());
        let least = (nats(&i) - criteria.equal_odds.ln()).max(criteria.least_nats);
        let instead = next(&standings[i], rejected, least);
        return Some(instead.unwrap_or_else(|| search.without(fit, i)));
    }
    // A better name beside which all others stand.
    standings.iter().find_map(|standing| {
        let better = next(standing, rejected, standing.cause().nats)?;
        let gain = |i: usize| judge.gain(&better, i);
        let stand = |i: usize| judge.agrees(&gain(i), better.model.causes[i].candidate);
        let stand = (0..better.model.causes.len()).all(stand);
        rejected.extend(stand.then_some(standing.cause().candidate()));
        stand.then_some(better)
    })
}

/// Is a linear value of cause `i` beyond what it can be?
fn is_impossible(fit: &Fit<'_>, i: usize) -> bool {
    let candidate = fit.model.causes[i].candidate;
    let values = fit.values(i);
    let linear = &values[..candidate.linear()];
    let beyond = |(k, v): (usize, &f64)| {
        let [min, max] = candidate.range(k, fit.data.twin);
        let slack = 1e-6 * (max - min);
        *v < min - slack || *v > max + slack
    };
    // The first one makes the effect what it is.
    linear.iter().enumerate().any(beyond)
        || linear.first().is_some_and(|v| {
            let [min, _] = candidate.range(0, fit.data.twin);
            min == 0.0 && *v <= 0.0
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Checked;
    use crate::diagnosis::candidate::Term;
    use crate::diagnosis::criteria::Criteria;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::diagnosis::trial;
    use crate::effects::find;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const JOINT: usize = 1;
    const OFFSET_NM: f64 = 1.5;

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

    /// Does a search that found `blind` choose an offset at `JOINT`?
    fn chooses(blind: Candidate) -> bool {
        let twin = Twin::default();
        let mut made = samples(6, 3000, |j, t| 0.7 * ((1.1 + 0.2 * j as f64) * t).sin());
        made.torque = twin.torque(&twin.motion(&made));
        made.torque.joint_mut(JOINT).iter_mut().for_each(|t| *t += OFFSET_NM);
        noisy(&mut made, 0.3);
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

    #[test]
    fn a_search_chooses_what_it_found_and_what_it_cannot_tell_from_that() {
        assert!(chooses(at(JOINT, "current_offset")));
        assert!(chooses(at(JOINT, "coulomb_asymmetry")));
        assert!(!chooses(at(0, "coulomb_asymmetry")));
    }
}
