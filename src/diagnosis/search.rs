//! Which causes are added to a twin, by evidence: one after the other, each given the others.
//!
//! Every hypothesis is a model of its own: the twin's open terms, causes, the discrepancy at its
//! most likely sizes, noise. Causes are added, dropped and exchanged as long as the evidence grows
//! (Tipping and Faul, "Fast marginal likelihood maximisation for sparse Bayesian models", 2003).

use rayon::prelude::*;

use super::bound::Adopted;
use super::candidate::{Candidate, Extent, Place, Term, acts_on};
use super::criteria::Criteria;
use super::data::Data;
use super::fit::Fit;
use super::model::Model;
use super::refine::{self, Trial};
use super::screen::{Screened, screen};

/// Candidates that are refined and weighed in full: a screening is right to within a few.
const WEIGHED: usize = 10;
/// Behind the best at its start, of its evidence and in nats: from there refining may come first.
const NEAR_SHARE: f64 = 0.4;
const NEAR_NATS: f64 = 10.0;
/// Rounds of exchanging causes.
const REVISIONS: usize = 4;

/// A candidate added to a state.
pub struct Hypothesis<'a> {
    pub trial: Trial,
    pub fit: Fit<'a>,
    /// Evidence over the state without it, its prior odds included, nats.
    pub nats: f64,
    /// A parameter at a bound that is not its null value.
    pub at_bound: Option<&'static str>,
}

impl Hypothesis<'_> {
    pub fn candidate(&self) -> Candidate {
        self.trial.candidate
    }
}

/// A cause among its rivals, the other causes in place.
pub struct Standing<'a> {
    /// Best first.
    pub ranked: Vec<Hypothesis<'a>>,
    /// The cause's index in `ranked`.
    pub index: usize,
    /// The other causes alone.
    pub without: Fit<'a>,
}

impl<'a> Standing<'a> {
    pub fn cause(&self) -> &Hypothesis<'a> {
        &self.ranked[self.index]
    }

    /// What the data alone say of a hypothesis, whatever was expected of its values: its likelihood at
    /// their best, over that without it, less 1/2 ln n for each (Schwarz, Ann. Stat. 6, 1978), nats.
    /// Beside the discrepancy that it leaves or that the cause leaves: a narrow expectation enlarges it.
    pub fn shown(&self, h: &Hypothesis<'a>) -> f64 {
        let term = Term { free: true, ..h.trial.term() };
        let values = term.held.iter().filter(|held| !**held).count() + term.searched.len();
        let data = self.without.data;
        let all = |fit: &Fit<'a>| (0..data.joints()).map(|j| fit.ln_likelihood(j)).sum::<f64>();
        let own = Fit::new(data, self.without.model.with(term), h.fit.sizes.clone());
        let best = all(&own).max(all(&own.beside(self.cause().fit.sizes.clone())));
        let rows: f64 = (0..data.joints()).map(|j| data.count(j)).sum();
        best - all(&self.without) - 0.5 * values as f64 * rows.max(1.0).ln()
    }
}

/// One round: what was weighed, and what was added of it.
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
    /// Linear, then nonlinear.
    pub values: Vec<f64>,
}

/// What a search finds.
pub struct Found<'a> {
    /// The twin alone, beside its discrepancy.
    pub start: Fit<'a>,
    /// With all causes.
    pub last: Fit<'a>,
    pub rounds: Vec<Round>,
    /// Every candidate that was screened in the first round, with the evidence it gains there, about.
    pub screened: Vec<(Candidate, f64)>,
}

pub struct Search<'a> {
    pub data: &'a Data<'a>,
    pub candidates: Vec<Candidate>,
    pub criteria: Criteria,
}

/// What acts in the whole arm leaves nothing of its kind to single joints.
fn covers(whole: &Candidate, part: &Candidate) -> bool {
    let everywhere = whole.place == Place::Arm && whole.recording.is_none();
    whole.name() == part.name() && everywhere && part.place != whole.place
}

/// May refining bring it before the best?
fn is_near(nats: f64, best: f64) -> bool {
    nats >= best - (NEAR_SHARE * best).max(NEAR_NATS)
}

impl<'a> Search<'a> {
    /// From the twin alone to all causes the evidence supports.
    pub fn run(&self) -> Found<'a> {
        let all: Vec<usize> = (0..self.data.joints()).collect();
        let start = self.tuned(Fit::plain(self.data, Model::of(self.data.twin)), &all);
        let mut last = start.clone();
        let (mut rounds, mut first) = (Vec::new(), Vec::new());
        while last.model.causes.len() < self.criteria.most_causes {
            let open = self.open(&last.model);
            let screened = screen(&last, &open);
            if rounds.is_empty() {
                first = screened.iter().map(|s| (s.trial.candidate, s.gain)).collect();
            }
            let ranked = self.weigh(&last, screened, WEIGHED);
            let (round, next) = self.added(&start, &last, &ranked);
            rounds.push(round);
            let Some(next) = next else { break };
            let fresh = next.model.causes[last.model.causes.len()..].iter();
            let fresh = fresh.map(|t| t.candidate).collect();
            let revised = self.revised(next, fresh);
            let same = revised.model.causes.len() == last.model.causes.len()
                && revised.model.causes.iter().all(|t| last.model.has(t.candidate));
            last = revised;
            if same {
                break;
            }
        }
        Found { start, last, rounds, screened: first }
    }

    fn open(&self, model: &Model) -> Vec<Candidate> {
        let there = |c: &&Candidate| {
            model.causes.iter().any(|t| t.candidate == **c || covers(&t.candidate, c))
        };
        self.candidates.iter().filter(|c| !there(c)).copied().collect()
    }

    /// The best cause that acts on several joints, or the best of every joint where those have more
    /// evidence together: an arm's drives are alike, and lack the same.
    fn added(
        &self,
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
            h.at_bound.is_none() && self.worth(start, state, h) > self.criteria.least_nats
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
                    for j in self.touched(h.candidate()) {
                        sizes[j].clone_from(&h.fit.sizes[j]);
                    }
                }
                Fit::new(self.data, model, sizes)
            }
        };
        (Round { weighed, added: names }, Some(next))
    }

    /// Evidence that a hypothesis adds, as far as it can be trusted beside what was found where it acts.
    fn worth(&self, start: &Fit<'a>, state: &Fit<'a>, h: &Hypothesis<'a>) -> f64 {
        let gained = |j: usize| (state.ln_likelihood(j) - start.ln_likelihood(j)).max(0.0);
        let before: f64 = self.touched(h.candidate()).into_iter().map(gained).sum();
        self.criteria.trusted(before + h.nats) - self.criteria.trusted(before)
    }

    /// With the discrepancy at its most likely sizes at some joints.
    pub fn tuned(&self, fit: Fit<'a>, joints: &[usize]) -> Fit<'a> {
        let sizes = fit.likely_sizes(joints);
        fit.beside(sizes)
    }

    pub fn touched(&self, candidate: Candidate) -> Vec<usize> {
        (0..self.data.joints()).filter(|j| acts_on(candidate, *j)).collect()
    }

    /// What a candidate starts with against it: one among so many.
    fn ln_rivals(&self) -> f64 {
        (self.candidates.len().max(1) as f64).ln()
    }

    /// The best of those screened, weighed beside the discrepancy that each leaves, best first; what comes
    /// close to the best is refined.
    fn weigh(&self, state: &Fit<'a>, screened: Vec<Screened>, most: usize) -> Vec<Hypothesis<'a>> {
        let best = |e: Extent| screened.iter().find(|s| s.trial.candidate.extent() == e);
        let promising = |s: &Screened| {
            let best = best(s.trial.candidate.extent()).map_or(0.0, |b| b.gain);
            s.gain.is_finite() && is_near(s.gain, best)
        };
        let promising: Vec<bool> = screened.iter().map(promising).collect();
        let worth = screened.into_iter().zip(promising).filter(|(_, p)| *p).map(|(s, _)| s);
        let worth: Vec<Screened> = worth.take(most).collect();
        let as_screened = |s: &Screened| {
            let beside = state.clone().beside(s.sizes.clone());
            let trial = refine::evaluate(&beside, &s.trial, s.trial.nonlinear.clone());
            self.adopted(state, &beside, trial)
        };
        let mut ranked: Vec<Hypothesis> = worth.par_iter().map(as_screened).collect();
        let top = ranked.iter().map(|h| h.nats).fold(f64::NEG_INFINITY, f64::max);
        let refined = |(h, s): (&mut Hypothesis<'a>, &Screened)| {
            let promising = h.nats > 0.0 && is_near(h.nats, top);
            // References follow at little cost.
            let follows = h.trial.searched().is_empty();
            if h.trial.starts[0].is_empty() || !(promising || follows) {
                return;
            }
            let beside = state.clone().beside(s.sizes.clone());
            let better = self.adopted(state, &beside, refine::refine(&beside, &h.trial));
            if better.nats > h.nats {
                *h = better;
            }
        };
        ranked.par_iter_mut().zip(&worth).for_each(refined);
        ranked.sort_by(|a, b| b.nats.total_cmp(&a.nats));
        ranked
    }

    fn adopted(&self, state: &Fit<'a>, beside: &Fit<'a>, trial: Trial) -> Hypothesis<'a> {
        let adopted = Adopted::new(beside, trial);
        let adopted = if adopted.at_bound.is_some() {
            adopted.inside(self.criteria.least_nats)
        } else {
            adopted
        };
        let Adopted { trial, fit, at_bound, .. } = adopted;
        // From either side: sizes may stay at what is best nearby.
        let touched = self.touched(trial.candidate);
        let sides = [
            self.tuned(fit.clone().beside(state.sizes.clone()), &touched),
            self.tuned(fit, &touched),
        ];
        let [from_large, from_small] = sides;
        let large = from_large.ln_evidence() > from_small.ln_evidence();
        let fit = if large { from_large } else { from_small };
        let nats = fit.ln_evidence() - state.ln_evidence() - self.ln_rivals();
        Hypothesis { trial, fit, nats, at_bound }
    }

    /// The causes seen together again, as far as they meet what is `fresh` among them: one that no longer
    /// earns its place is dropped, one that another fills better gives way.
    fn revised(&self, mut fit: Fit<'a>, mut fresh: Vec<Candidate>) -> Fit<'a> {
        for _ in 0..REVISIONS {
            if fit.model.causes.len() < 2 {
                break;
            }
            let Some(better) = self.exchanged(&fit, &fresh) else { break };
            let come = better.model.causes.iter().filter(|t| !fit.model.has(t.candidate));
            let gone = fit.model.causes.iter().filter(|t| !better.model.has(t.candidate));
            fresh = come.chain(gone).map(|t| t.candidate).collect();
            fit = better;
        }
        fit
    }

    fn exchanged(&self, fit: &Fit<'a>, fresh: &[Candidate]) -> Option<Fit<'a>> {
        let meets = |c: Candidate| fresh.iter().any(|f| f.extent().meets(c.extent()));
        let indices = (0..fit.model.causes.len()).filter(|i| meets(fit.model.causes[*i].candidate));
        let indices: Vec<usize> = indices.collect();
        indices.into_iter().find_map(|i| {
            let cause = fit.model.causes[i].candidate;
            let without = self.without(fit, i);
            let mine = fit.ln_evidence() - without.ln_evidence() - self.ln_rivals();
            if mine < self.criteria.least_nats {
                return Some(without);
            }
            let ranked = self.rivals(fit, &without, cause, WEIGHED / 2);
            let best = ranked.into_iter().find(|h| h.at_bound.is_none())?;
            (best.nats > mine + self.criteria.least_nats).then_some(best.fit)
        })
    }

    /// Without cause `i`, beside the discrepancy that this leaves.
    pub fn without(&self, fit: &Fit<'a>, i: usize) -> Fit<'a> {
        let cause = fit.model.causes[i].candidate;
        let without = Fit::new(self.data, fit.model.without(i), fit.sizes.clone());
        self.tuned(without, &self.touched(cause))
    }

    /// What might be there in place of a cause, where it acts: what acts on more joints takes what other
    /// causes are for, and competes in a round.
    fn rivals(
        &self,
        fit: &Fit<'a>,
        without: &Fit<'a>,
        cause: Candidate,
        most: usize,
    ) -> Vec<Hypothesis<'a>> {
        let mut open = self.open(&fit.model);
        open.retain(|c| c.extent() == cause.extent());
        self.weigh(without, screen(without, &open), most)
    }

    /// Every cause among its rivals.
    pub fn standings(&self, last: &Fit<'a>) -> Vec<Standing<'a>> {
        let standing = |i: usize| {
            let cause = &last.model.causes[i];
            let without = self.without(last, i);
            let mut ranked = self.rivals(last, &without, cause.candidate, WEIGHED);
            let trial = refine::tried(&without, cause);
            let beside = without.clone().beside(last.sizes.clone());
            ranked.push(self.adopted(&without, &beside, trial));
            ranked.sort_by(|a, b| b.nats.total_cmp(&a.nats));
            let mine = |h: &Hypothesis| h.candidate() == cause.candidate;
            let index = ranked.iter().position(mine).unwrap_or_default();
            Standing { ranked, index, without }
        };
        (0..last.model.causes.len()).map(standing).collect()
    }
}
