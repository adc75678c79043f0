//! Which causes are added to a twin, by evidence: one after the other, each given the others.
//!
//! Causes are added, dropped and exchanged as long as the evidence grows
//! (Tipping and Faul, "Fast marginal likelihood maximisation for sparse Bayesian models", 2003).

use super::candidate::{Candidate, Extent};
use super::fit::Fit;
use super::hypotheses::{Hypotheses, Hypothesis, WEIGHED};
use super::model::Model;
use super::revise::revised;
use super::rounds::SEARCHING;
use super::screen::screen;

/// One round: what was weighed, and what was added of it.
#[derive(Clone)]
pub struct Round {
    pub weighed: Vec<Weighed>,
    pub added: Vec<Candidate>,
}

/// What a round found of a candidate.
#[derive(Debug, Clone)]
pub struct Weighed {
    pub candidate: Candidate,
    pub nats: f64,
    pub at_bound: Option<&'static str>,
    /// Values of the linear parameters, then of the nonlinear ones.
    pub values: Vec<f64>,
}

/// What a search finds.
#[derive(Clone)]
pub struct Found<'a> {
    /// The twin alone, beside its discrepancy.
    pub start: Fit<'a>,
    /// The fit with all causes.
    pub last: Fit<'a>,
    pub rounds: Vec<Round>,
    /// Every candidate that was screened in the first round, with the evidence it gains there, about.
    pub screened: Vec<(Candidate, f64)>,
}

impl<'a> Found<'a> {
    /// The twin alone.
    pub fn none(all: &Hypotheses<'a>) -> Self {
        let joints: Vec<usize> = (0..all.data.joints()).collect();
        let start = all.tuned(Fit::plain(all.data, Model::of(all.data.twin)), &joints);
        Self { last: start.clone(), start, rounds: Vec::new(), screened: Vec::new() }
    }
}

/// Search from what is found to all further causes the evidence supports; so many rounds are told to come after it.
pub fn grown<'a>(all: &Hypotheses<'a>, found: Found<'a>, after: usize) -> Found<'a> {
    let Found { start, mut last, mut rounds, screened: mut first } = found;
    while last.model.causes.len() < all.criteria.most_causes {
        // Every round but the last adds a cause.
        let left = all.criteria.most_causes - last.model.causes.len();
        tell(all, rounds.len(), left + after);
        let open = all.open(&last.model);
        let screened = screen(&last, &open);
        if rounds.is_empty() {
            first = screened.iter().map(|s| (s.trial.candidate, s.gain)).collect();
        }
        let ranked = all.weigh(&last, screened, WEIGHED);
        let (round, next) = added(all, &start, &last, &ranked);
        rounds.push(round);
        let Some(next) = next else { break };
        let fresh = next.model.causes[last.model.causes.len()..].iter();
        let fresh = fresh.map(|t| t.candidate).collect();
        let revised = revised(all, next, fresh);
        let same = revised.model.has_causes_of(&last.model);
        last = revised;
        if same {
            break;
        }
    }
    Found { start, last, rounds, screened: first }
}

/// Tells who follows how many rounds are done, and how many are left at most.
pub fn tell(all: &Hypotheses<'_>, done: usize, left: usize) {
    all.data.watch.bound(SEARCHING, done as u64, (done + left) as u64);
}

/// The best cause that acts on several joints, or the best of every joint where those have more
/// evidence together: an arm's drives are alike, and lack the same.
fn added<'a>(
    all: &Hypotheses<'a>,
    start: &Fit<'a>,
    state: &Fit<'a>,
    ranked: &[Hypothesis<'a>],
) -> (Round, Option<Fit<'a>>) {
    let weighed = ranked
        .iter()
        .map(|h| Weighed {
            candidate: h.candidate(),
            nats: h.nats,
            at_bound: h.at_bound,
            values: h.fit.values(h.fit.model.causes.len() - 1),
        })
        .collect();
    let enough = |h: &&Hypothesis<'a>| {
        h.at_bound.is_none() && worth(all, start, state, h) > all.criteria.least_nats
    };
    let good: Vec<&Hypothesis<'a>> = ranked.iter().filter(enough).collect();
    let Some(best) = good.first() else {
        return (Round { weighed, added: vec![] }, None);
    };
    let mut singles: Vec<&Hypothesis<'a>> = Vec::new();
    for h in good.iter().filter(|h| h.candidate().extent() != Extent::Several) {
        if !singles.iter().any(|s| s.candidate().extent() == h.candidate().extent()) {
            singles.push(h);
        }
    }
    // One cause for several joints against one for each: what has more evidence in all.
    let together: f64 = singles.iter().map(|h| h.nats).sum();
    let several = best.candidate().extent() == Extent::Several && best.nats >= together;
    let added = if several { vec![*best] } else { singles };
    let names = added.iter().map(|h| h.candidate()).collect();
    let next = match added[..] {
        [only] => only.fit.clone(),
        _ => {
            let model = added.iter().fold(state.model.clone(), |m, h| m.with(h.trial.term()));
            let mut sizes = state.sizes.clone();
            for h in &added {
                for j in all.touched(h.candidate()) {
                    sizes.joints[j].clone_from(&h.fit.sizes.joints[j]);
                }
            }
            all.tuned(Fit::new(all.data, model, sizes), &[])
        }
    };
    (Round { weighed, added: names }, Some(next))
}

/// Evidence that a hypothesis adds, as far as it can be trusted beside what was found where it acts.
fn worth<'a>(all: &Hypotheses<'a>, start: &Fit<'a>, state: &Fit<'a>, h: &Hypothesis<'a>) -> f64 {
    let gained = |j: usize| (state.ln_likelihood(j) - start.ln_likelihood(j)).max(0.0);
    let before: f64 = all.touched(h.candidate()).into_iter().map(gained).sum();
    all.criteria.trusted(before + h.nats) - all.criteria.trusted(before)
}
