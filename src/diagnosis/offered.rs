//! Which changes of a twin are worth a proof by other means than torque.

use super::candidate::{Candidate, Extent, Place, Term};
use super::fit::Fit;
use super::hypotheses::{Hypotheses, Hypothesis, Standing};
use super::observed::Observed;
use super::screen::screen;
use super::search::Found;
use super::traces::acts;
use super::{Change, intervals};
use crate::effects::Scope;

/// What acts at so large a share of all samples acts always: the ends of a window are known to no better.
const THROUGHOUT: f64 = 0.99;

/// A change that may be a cause.
#[derive(Debug, Clone, PartialEq)]
pub struct Offer {
    pub change: Change,
    /// How many are offered that no search says are there, where it is one of them; 1 where a search says that it is.
    pub among: usize,
}

/// What a change is in a model, and the change.
type Proposed = (Term, Change);

/// Causes that a search finds, and what may be one although no search says so, as terms of the model and as changes of the
/// twin, in the same order. The most plausible comes first: what has most evidence alone.
pub fn offered<'a>(
    search: &Hypotheses<'a>,
    [found, blind]: [&Found<'a>; 2],
) -> (Vec<Term>, Vec<Offer>) {
    let (mut said, mut may_be) = (Vec::new(), Vec::new());
    [found, blind].into_iter().flat_map(|f| changes(&f.last)).for_each(|one| add(&mut said, one));
    let standings = search.standings(&found.last);
    standings.iter().flat_map(|s| near(search, s)).for_each(|one| add(&mut may_be, one));
    let taken_up = taken_up(search, [found, blind]);
    let alone = alone(search, &found.start, |c| {
        let listed = is_in(&said, c) || is_in(&may_be, c) || taken_up.contains(&c);
        listed || c.extent() == Extent::Several
    });
    let usable = alone.iter().filter(|h| is_told(search, h) || is_free(h.candidate(), &taken_up));
    usable.flat_map(|h| changes(&h.fit)).for_each(|one| add(&mut may_be, one));
    for all in [&mut said, &mut may_be] {
        all.retain(|(term, _)| !is_a_load(search, term));
    }
    may_be.retain(|(term, _)| !is_in(&said, term.candidate));
    let among = may_be.len();
    let mut all: Vec<(Term, Offer)> = offers(said, 1).chain(offers(may_be, among)).collect();
    let rank = |term: &Term| alone.iter().position(|h| h.candidate() == term.candidate);
    all.sort_by_key(|(term, _)| rank(term).unwrap_or(alone.len()));
    all.into_iter().unzip()
}

fn offers(proposed: Vec<Proposed>, among: usize) -> impl Iterator<Item = (Term, Offer)> {
    proposed.into_iter().map(move |(term, change)| (term, Offer { change, among }))
}

fn add(all: &mut Vec<Proposed>, one: Proposed) {
    if !is_in(all, one.0.candidate) {
        all.push(one);
    }
}

fn is_in(all: &[Proposed], candidate: Candidate) -> bool {
    all.iter().any(|(term, _)| term.candidate == candidate)
}

/// Rivals with about the evidence of a cause, for what they are weighed by is linear.
fn near(search: &Hypotheses<'_>, standing: &Standing<'_>) -> Vec<Proposed> {
    let criteria = &search.criteria;
    let cause = standing.cause().nats;
    let least = cause - criteria.margin(cause, false);
    let usable = standing.ranked.iter().filter(|h| h.at_bound.is_none() && h.nats > least.max(0.0));
    usable.filter_map(|h| changes(&h.fit).pop()).collect()
}

/// What was the best at some time, or would have been inside its range: what it is weighed by is linear, and its values
/// are fitted anew.
fn taken_up(search: &Hypotheses<'_>, found: [&Found<'_>; 2]) -> Vec<Candidate> {
    let least = search.criteria.least_nats;
    let rounds = || found.into_iter().flat_map(|f| &f.rounds);
    let added = rounds().flat_map(|r| r.added.iter().copied());
    let weighed = rounds().flat_map(|r| &r.weighed);
    let at_bound = weighed.filter(|w| w.at_bound.is_some() && w.nats > least);
    added.chain(at_bound.map(|w| w.candidate)).collect()
}

/// Candidates, each alone beside the twin, best first.
fn alone<'a>(
    search: &Hypotheses<'a>,
    start: &Fit<'a>,
    is_weighed: impl Fn(Candidate) -> bool,
) -> Vec<Hypothesis<'a>> {
    let candidates: Vec<Candidate> =
        search.candidates.iter().copied().filter(|c| is_weighed(*c)).collect();
    let screened = screen(start, &candidates).into_iter();
    let mut all: Vec<Hypothesis> = screened.flat_map(|s| search.weigh(start, vec![s], 1)).collect();
    all.sort_by(|a, b| b.nats.total_cmp(&a.nats));
    all
}

fn is_told(search: &Hypotheses<'_>, h: &Hypothesis<'_>) -> bool {
    h.at_bound.is_none() && h.nats > search.criteria.least_nats
}

/// May a fit by simulation find all its values, whatever the search has of them?
fn is_free(c: Candidate, taken_up: &[Candidate]) -> bool {
    c.effect.kept().is_empty() && (taken_up.contains(&c) || is_of_the_arm(c))
}

/// A body, or what is the same at all joints: where a search has a cause at each of some joints, it may do what they do.
/// What a sensor or a spring of one joint does to others that search has at the joint itself.
fn is_of_the_arm(c: Candidate) -> bool {
    let of_a_joint = c.effect.about().scope == Scope::Joint || c.senses() || c.effect.gives_way();
    c.place == Place::Arm || !of_a_joint
}

/// Does it act all the time, in all recordings, although it is one that lasts a while? A force that never ends is a weight.
fn is_a_load(search: &Hypotheses<'_>, term: &Term) -> bool {
    let lasts = |part: &&Observed<'_>| {
        let acts = acts(part, term);
        acts.iter().filter(|acts| **acts).count() as f64 >= THROUGHOUT * acts.len() as f64
    };
    term.candidate.effect.lasts_a_while() && search.data.parts.iter().all(lasts)
}

/// The causes of a fit, as changes of the twin.
fn changes(fit: &Fit<'_>) -> Vec<Proposed> {
    let values = intervals::of_fit(fit);
    let terms = fit.model.causes.iter().zip(values);
    terms.map(|(t, v)| (t.clone(), Change::of(t.candidate, &v, fit.data.twin))).collect()
}
