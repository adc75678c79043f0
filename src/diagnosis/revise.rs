//! Causes that were found one after the other, seen together.
//!
//! What came first was fitted while the others were missing: its nonlinear parameters are searched
//! again, a cause that no longer earns its price is dropped, one that another would fill better
//! gives way, and two at one joint give way to a single one that does as well.

use std::sync::Arc;

use super::candidate::{Candidate, Extent, Place, Term};
use super::model::{Fit, Model};
use super::rank::{Hypothesis, LEAST_NATS, State, effective_shares, price};
use super::search::{self, Trial};
use super::select::{REFINED, Search};

/// Rounds of revising and of polishing.
const REVISIONS: usize = 4;
const SWEEPS: usize = 3;
/// Gains of log-likelihood that are worth another sweep, nats.
const SETTLED: f64 = 0.5;
/// Rivals that are refined.
const RIVALS: usize = 6;

/// A cause among its rivals where it acts, the other causes in place.
pub struct Standing<'a, 'e> {
    /// Best first.
    pub ranked: Arc<Vec<Hypothesis<'a, 'e>>>,
    /// The cause's index in `ranked`.
    pub index: usize,
    /// Differences of score that count as none.
    pub tolerance: f64,
    /// The other causes alone.
    pub without: State<'a, 'e>,
}

impl<'a, 'e> Standing<'a, 'e> {
    pub fn cause(&self) -> &Hypothesis<'a, 'e> {
        &self.ranked[self.index]
    }

    /// Mean square that the cause takes off the check recording, summed over the joints, (N.m)^2.
    pub fn shrinks(&self) -> f64 {
        let (before, after) = (&self.without.residual, &self.cause().residual);
        let each = before.squares().into_iter().zip(after.squares()).enumerate();
        each.map(|(j, (b, a))| (b - a) / before.joint(j).len().max(1) as f64).sum()
    }
}

impl<'a, 'e> Search<'a, 'e> {
    /// The model with every cause right given the others, as far as they meet what is `fresh` in it;
    /// a single cause stands as found.
    pub fn revise(&self, mut model: Model, mut fresh: Vec<Candidate>) -> Model {
        for _ in 0..REVISIONS {
            if model.causes.len() < 2 {
                break;
            }
            let concerns = |t: &Term| fresh.iter().any(|f| f.extent().meets(t.candidate.extent()));
            let indices: Vec<usize> =
                (0..model.causes.len()).filter(|&i| concerns(&model.causes[i])).collect();
            model = self.polish(model, &indices);
            let Some(better) =
                self.merged(&model, &indices).or_else(|| self.swapped(&model, &indices))
            else {
                break;
            };
            // A cause that was dropped leaves room where it was.
            let gone = model.causes.iter().filter(|t| !better.has(t.candidate));
            let come = better.causes.iter().filter(|t| !model.has(t.candidate));
            fresh = gone.chain(come).map(|t| t.candidate).collect();
            model = better;
        }
        model
    }

    /// Nonlinear parameters of these causes searched again, one cause after the other.
    fn polish(&self, mut model: Model, indices: &[usize]) -> Model {
        for _ in 0..SWEEPS {
            let mut gained = 0.0f64;
            for &i in indices {
                let others = Fit::new(self.fit, model.without(&[i]));
                let now = search::tried(&others, &model.causes[i]);
                let better = search::refine(&others, &now);
                if better.gain > now.gain {
                    gained = gained.max(better.ahead_of(&now));
                    model.causes[i] = better.term();
                }
            }
            if gained < SETTLED {
                break;
            }
        }
        model
    }

    /// Two causes of one joint replaced by one that does as well.
    fn merged(&self, model: &Model, indices: &[usize]) -> Option<Model> {
        let after = |i: usize| indices.iter().copied().filter(move |k| *k > i);
        let pairs = indices.iter().flat_map(|&i| after(i).map(move |k| [i, k]));
        let place = |i: usize| model.causes[i].candidate.place;
        pairs.into_iter().filter(|[i, k]| place(*i) == place(*k)).find_map(|[i, k]| {
            let base = self.state(model.without(&[i, k]));
            let here = |c: &Candidate| c.place == place(i) && !base.fit.model.has(*c);
            let ranked = self.best(&base, &self.some(here), RIVALS, Extent::Several);
            let one = ranked.iter().find(|h| h.at_bound.is_none())?;
            let as_good = one.score >= self.together(&base, model, [i, k]) - self.tolerance(one);
            as_good.then(|| one.fit.model.clone())
        })
    }

    /// A cause replaced by a better one, or dropped where it does not earn its price.
    fn swapped(&self, model: &Model, indices: &[usize]) -> Option<Model> {
        indices.iter().find_map(|&i| {
            let cause = &model.causes[i];
            let base = self.state(model.without(&[i]));
            let extent = cause.candidate.extent();
            let near = |c: &Candidate| {
                let place = c.place == cause.candidate.place || c.place == Place::Arm;
                place && !base.fit.model.has(*c) && c.name() != cause.candidate.name()
            };
            let ranked = self.best(&base, &self.some(near), RIVALS, extent);
            let mine = self.hold(&base, &[search::tried(&base.fit, cause)], extent);
            let mine = mine.first()?;
            if mine.score < 0.0 || mine.gain_check < LEAST_NATS {
                return Some(base.fit.model);
            }
            let rival = ranked.iter().find(|h| h.at_bound.is_none())?;
            let better = rival.score > mine.score + self.tolerance(rival);
            better.then(|| rival.fit.model.clone())
        })
    }

    fn some(&self, which: impl Fn(&Candidate) -> bool) -> Vec<Candidate> {
        self.candidates.iter().filter(|c| which(c)).copied().collect()
    }

    fn best(
        &self,
        state: &State<'a, 'e>,
        candidates: &[Candidate],
        most: usize,
        extent: Extent,
    ) -> Vec<Hypothesis<'a, 'e>> {
        let screened = search::screen(&state.fit, candidates, &[]);
        let best: Vec<Trial> = screened.into_iter().take(most).map(|(trial, _)| trial).collect();
        self.rank(state, &best, extent)
    }

    /// Score of two causes at once over the state without them.
    fn together(&self, base: &State<'a, 'e>, model: &Model, two: [usize; 2]) -> f64 {
        let both = self.state(model.clone());
        let share = effective_shares(&both.fit.system.residual);
        let gains = self.gains(base, &both.fit, &both.residual, &share);
        gains.iter().sum::<f64>() - two.iter().map(|&i| price(&both.fit, i)).sum::<f64>()
    }

    /// Every cause of the model among all rivals, in the order of the causes.
    pub fn standings(&self, model: &Model) -> Vec<Standing<'a, 'e>> {
        (0..model.causes.len()).map(|i| self.standing(model, &model.causes[i], i)).collect()
    }

    fn standing(&self, model: &Model, cause: &Term, i: usize) -> Standing<'a, 'e> {
        let without = self.state(model.without(&[i]));
        let extent = cause.candidate.extent();
        let open = self.some(|c| !model.has(*c) && c.extent().meets(extent));
        let mut ranked = self.best(&without, &open, REFINED, extent);
        let trials: Vec<Trial> =
            ranked.drain(..).map(|h| h.trial).chain([search::tried(&without.fit, cause)]).collect();
        let ranked = self.hold(&without, &trials, extent);
        let mine = ranked.iter().position(|h| h.trial.candidate == cause.candidate);
        let index = mine.unwrap_or_default();
        let tolerance = self.tolerance(&ranked[index]);
        Standing { ranked: Arc::new(ranked), index, tolerance, without }
    }
}
