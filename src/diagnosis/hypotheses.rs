//! Candidates beside a state of the model, weighed by evidence against each other.
//!
//! Every hypothesis is a model of its own: the twin's open terms, causes, the discrepancy at its
//! most likely sizes, noise.

use rayon::prelude::*;

use super::bound::Adopted;
use super::candidate::{Candidate, Extent, Place, Term, acts_on};
use super::criteria::Criteria;
use super::data::Data;
use super::fit::Fit;
use super::limits::odds_beyond;
use super::model::Model;
use super::refine;
use super::screen::{Screened, screen};
use super::sizes::Sizes;
use super::trial::{self, Trial};

/// Candidates that are refined and weighed in full: a screening is right to within a few.
pub const WEIGHED: usize = 10;
/// Behind the best at its start, of its evidence and in nats: from there refining may come first.
const NEAR_SHARE: f64 = 0.4;
const NEAR_NATS: f64 = 10.0;

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
    /// Hypotheses, best first.
    pub ranked: Vec<Hypothesis<'a>>,
    /// The cause's index in `ranked`.
    pub index: usize,
    /// The fit with the other causes alone.
    pub without: Fit<'a>,
    /// Is the evidence that a value lies beyond its limit? Within it, the value takes up most of what the data show.
    pub beyond: bool,
}

impl<'a> Standing<'a> {
    pub fn cause(&self) -> &Hypothesis<'a> {
        &self.ranked[self.index]
    }

    /// What the data alone say of a hypothesis, whatever was expected of its values: its likelihood at
    /// their best, over that without it, less 1/2 ln n for each that they tell (Schwarz, Ann. Stat. 6, 1978), nats.
    /// Values that the data do not call for are none: an effect is not less there for what it could be besides.
    pub fn shown(&self, h: &Hypothesis<'a>) -> f64 {
        let data = self.without.data;
        let rows: f64 = (0..data.joints()).map(|j| data.count(j)).sum();
        let price = 0.5 * rows.max(1.0).ln();
        let fit = |term: &Term| {
            Fit::new(data, self.without.model.with(term.clone()), h.fit.sizes.clone())
        };
        let term = Term { free: true, ..h.trial.term() };
        let whole = fit(&term);
        let few = called_for(&whole, term.clone(), price);
        let few = few.map_or(f64::NEG_INFINITY, |few| self.shown_by(h, &few, fit(&few), price));
        self.shown_by(h, &term, whole, price).max(few)
    }

    /// By a fit with `term`, beside the discrepancy that it leaves or that the cause leaves: a narrow expectation
    /// enlarges it.
    fn shown_by(&self, h: &Hypothesis<'a>, term: &Term, fit: Fit<'a>, price: f64) -> f64 {
        let last = h.fit.model.causes.len() - 1;
        let linear = h.fit.model.range(last).zip(&term.held).filter(|(_, held)| !**held);
        let told: f64 = linear.map(|(i, _)| h.fit.system.determined(i)).sum();
        let values = told + term.shapes().count() as f64;
        let beside = fit.clone().beside(self.cause().fit.sizes.clone());
        fit.ln_likely().max(beside.ln_likely()) - self.without.ln_likely() - price * values
    }
}

/// The last cause of a fit, `term`, with those linear values held at zero that bring no more than `price` nats each;
/// `None` where all bring more, or the effect would not be the same without them.
fn called_for(fit: &Fit<'_>, mut term: Term, price: f64) -> Option<Term> {
    let range = fit.model.range(fit.model.causes.len() - 1);
    let mut linear = fit.system.x.as_slice()[range.clone()].to_vec();
    let brings = |i: usize| 0.5 * fit.system.x[i].powi(2) / fit.system.variance(i);
    let idle: Vec<bool> = range.map(|i| brings(i) <= price).collect();
    for (k, idle) in idle.iter().enumerate().filter(|(_, idle)| **idle) {
        term.held[k] = *idle;
        linear[k] = 0.0;
    }
    (idle.contains(&true) && term.candidate.is_itself(&linear)).then_some(term)
}

/// Everything that may be a cause, in these recordings.
pub struct Hypotheses<'a> {
    pub data: &'a Data<'a>,
    pub candidates: Vec<Candidate>,
    pub criteria: Criteria,
}

/// What acts in the whole arm leaves nothing of its kind to single joints.
pub fn covers(whole: &Candidate, part: &Candidate) -> bool {
    let all = matches!(whole.place, Place::Arm | Place::Links(_));
    let everywhere = all && whole.recording.is_none();
    whole.name() == part.name() && everywhere && part.place != whole.place
}

/// May refining bring it before the best?
fn is_near(nats: f64, best: f64) -> bool {
    nats >= best - (NEAR_SHARE * best).max(NEAR_NATS)
}

impl<'a> Hypotheses<'a> {
    pub fn open(&self, model: &Model) -> Vec<Candidate> {
        let there = |c: &&Candidate| {
            model.causes.iter().any(|t| t.candidate == **c || covers(&t.candidate, c))
        };
        self.candidates.iter().filter(|c| !there(c)).copied().collect()
    }

    /// The fit with the discrepancy at its most likely sizes at `joints`.
    pub fn tuned(&self, fit: Fit<'a>, joints: &[usize]) -> Fit<'a> {
        let (before, sizes) = (fit.sizes.tolerances, fit.likely_sizes(joints));
        let fit = fit.beside(sizes);
        // Links take up another part of a load.
        if fit.sizes.tolerances == before { fit } else { fit.settled() }
    }

    pub fn touched(&self, candidate: Candidate) -> Vec<usize> {
        (0..self.data.joints()).filter(|j| acts_on(candidate, *j)).collect()
    }

    /// Evidence of a model, each of its causes one among so many, nats.
    pub fn worth(&self, fit: &Fit<'_>) -> f64 {
        fit.ln_evidence() - fit.model.causes.len() as f64 * self.ln_rivals()
    }

    /// What the causes of a fit are worth beside the twin alone, nats, as far as evidence can be trusted: by this, ends of searches
    /// are compared.
    pub fn gained(&self, alone: &Fit<'a>, fit: &Fit<'a>) -> f64 {
        self.criteria.trusted(self.worth(fit) - self.worth(alone))
    }

    /// What a candidate starts with against it: one among so many.
    pub fn ln_rivals(&self) -> f64 {
        (self.candidates.len().max(1) as f64).ln()
    }

    /// The best of those screened, weighed beside the discrepancy that each leaves, best first; what comes
    /// close to the best is refined.
    pub fn weigh(
        &self,
        state: &Fit<'a>,
        screened: Vec<Screened>,
        most: usize,
    ) -> Vec<Hypothesis<'a>> {
        self.weigh_against(state, screened, most, f64::INFINITY)
    }

    /// The same with all that comes close to a hypothesis of so many `nats`, whatever is better; infinite where only the best
    /// counts.
    fn weigh_against(
        &self,
        state: &Fit<'a>,
        screened: Vec<Screened>,
        most: usize,
        nats: f64,
    ) -> Vec<Hypothesis<'a>> {
        let best = |e: Extent| screened.iter().find(|s| s.trial.candidate.extent() == e);
        let promising = |s: &Screened| {
            let best = best(s.trial.candidate.extent()).map_or(0.0, |b| b.gain);
            s.gain.is_finite() && is_near(s.gain, best.min(nats + self.ln_rivals()))
        };
        let promising: Vec<bool> = screened.iter().map(promising).collect();
        let worth = screened.into_iter().zip(promising).filter(|(_, p)| *p).map(|(s, _)| s);
        let worth: Vec<Screened> = worth.take(most).collect();
        let as_screened = |s: &Screened| {
            let beside = state.clone().beside(s.sizes.clone());
            let trial = trial::evaluate(&beside, &s.trial, s.trial.nonlinear.clone());
            self.adopted(state, &beside, trial)
        };
        let mut ranked: Vec<Hypothesis> = worth.par_iter().map(as_screened).collect();
        let top = ranked.iter().map(|h| h.nats).fold(f64::NEG_INFINITY, f64::max);
        let refined = |(h, s): (&mut Hypothesis<'a>, &Screened)| {
            let promising = h.nats > 0.0 && is_near(h.nats, top.min(nats));
            // References follow at little cost, and columns are right where they have followed alone.
            let follows = h.trial.searched().is_empty();
            if h.trial.starts[0].is_empty() || !(promising || follows) {
                return;
            }
            // A load needs no tolerance of links, which would take a part of it.
            let tolerances = h.fit.sizes.tolerances;
            let beside = state.clone().beside(Sizes { tolerances, ..s.sizes.clone() });
            let better = self.adopted(state, &beside, refine::refine(&beside, &h.trial));
            if follows || better.nats > h.nats {
                *h = better;
            }
        };
        ranked.par_iter_mut().zip(&worth).for_each(refined);
        ranked.sort_by(|a, b| b.nats.total_cmp(&a.nats));
        ranked
    }

    fn adopted(&self, state: &Fit<'a>, beside: &Fit<'a>, trial: Trial) -> Hypothesis<'a> {
        let touched = self.touched(trial.candidate);
        let adopted = Adopted::new(beside, trial);
        // What costs no more than tells nothing is not pressed against.
        let exact = touched.iter().all(|j| adopted.fit.is_exact(*j));
        let nats = adopted.fit.ln_evidence() - state.ln_evidence();
        let adopted = adopted.inside(self.criteria.margin(nats, exact));
        let Adopted { trial, fit, at_bound, .. } = adopted;
        // From either side: sizes may stay at what is best nearby.
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

    /// A term at its values, added to a state; a discrepancy of these sizes may be beside it.
    pub fn tried(&self, state: &Fit<'a>, sizes: &Sizes, term: &Term) -> Hypothesis<'a> {
        let beside = state.clone().beside(sizes.clone());
        self.adopted(state, &beside, trial::tried(state, term))
    }

    /// The fit without cause `i`, beside the discrepancy that this leaves.
    pub fn without(&self, fit: &Fit<'a>, i: usize) -> Fit<'a> {
        let cause = fit.model.causes[i].candidate;
        let without = Fit::new(fit.data, fit.model.without(i), fit.sizes.clone());
        self.tuned(without, &self.touched(cause))
    }

    /// What might be there in place of a cause of so many nats (as in [`Self::weigh_against`]), where it acts: what acts on
    /// more joints takes what other causes are for, and competes in a round.
    pub fn rivals(
        &self,
        fit: &Fit<'a>,
        without: &Fit<'a>,
        (cause, nats): (Candidate, f64),
        most: usize,
    ) -> Vec<Hypothesis<'a>> {
        let mut open = self.open(&fit.model);
        open.retain(|c| c.extent() == cause.extent());
        self.weigh_against(without, screen(without, &open), most, nats)
    }

    /// May another hypothesis be there in place of `cause`, one of those of `fit`? Where each is called for beside the
    /// other they are two causes, and none speaks against the other.
    fn is_instead(&self, fit: &Fit<'a>, cause: &Hypothesis<'a>, other: &Hypothesis<'a>) -> bool {
        let least = self.criteria.least_nats;
        if other.nats <= least || other.at_bound.is_some() {
            return true;
        }
        let beside = self.tried(fit, &other.fit.sizes, &other.trial.term()).nats;
        beside <= least || cause.nats + beside - other.nats <= least
    }

    /// Every cause among its rivals.
    pub fn standings(&self, last: &Fit<'a>) -> Vec<Standing<'a>> {
        (0..last.model.causes.len()).into_par_iter().map(|i| self.standing(last, i)).collect()
    }

    /// Cause `i` among its rivals.
    pub fn standing(&self, last: &Fit<'a>, i: usize) -> Standing<'a> {
        let cause = &last.model.causes[i];
        let without = self.without(last, i);
        let mut mine = self.tried(&without, &last.sizes, cause);
        // What the twin states does not hold: that is enough of a cause where nothing better is at hand.
        let enough = self.criteria.least_nats;
        let beyond = mine.nats < enough
            && odds_beyond(&without, cause.candidate, self.criteria.coverage)
                .is_some_and(|odds| odds > enough);
        if beyond {
            mine.nats = enough;
        }
        let mut ranked = self.rivals(last, &without, (cause.candidate, mine.nats), WEIGHED);
        ranked.retain(|other| self.is_instead(last, &mine, other));
        ranked.push(mine);
        ranked.sort_by(|a, b| b.nats.total_cmp(&a.nats));
        let mine = |h: &Hypothesis| h.candidate() == cause.candidate;
        let index = ranked.iter().position(mine).unwrap_or_default();
        Standing { ranked, index, without, beyond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::observed::Observed;
    use crate::effects::find;
    use crate::signals::Samples;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const JOINT: usize = 1;

    /// What is told of a recording of `arm` by a twin that knows none of its effects, of which a joint has `more`, N.m.
    fn of_arm<T>(
        arm: &Twin,
        more: impl Fn(&Samples) -> Vec<f64>,
        noise_nm: f64,
        candidates: &[Candidate],
        told: impl Fn(&Hypotheses<'_>) -> T,
    ) -> T {
        let twin = Twin::default();
        let mut made = samples(6, 3000, |j, t| {
            0.7 * ((0.9 + 0.2 * j as f64) * t).sin() + 0.4 * (0.6 * t + j as f64).cos()
        });
        made.torque = arm.torque(&arm.motion(&made));
        let more = more(&made);
        made.torque.joint_mut(JOINT).iter_mut().zip(more).for_each(|(t, more)| *t += more);
        noisy(&mut made, noise_nm);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&observed]);
        let (candidates, criteria) = (candidates.to_vec(), Criteria::default());
        told(&Hypotheses { data: &data, candidates, criteria })
    }

    /// An offset and a friction that bends, of which one was found: the other has more evidence and is no rival. What looks
    /// like the offset is one.
    #[test]
    fn what_is_called_for_beside_a_cause_is_no_rival() {
        let at = |name: &str| Candidate::new(find(name).unwrap(), Place::Joint(JOINT));
        let [offset, same, other] =
            ["current_offset", "coulomb_asymmetry", "viscous_quadratic"].map(at);
        let more = |made: &Samples| {
            let bent = other.effect.columns(&Twin::default().motion(made), JOINT, &[]).remove(0);
            bent.into_iter().map(|v| 0.2 + 8.0 * v).collect()
        };
        let names: Vec<Candidate> =
            of_arm(&Twin::default(), more, 0.3, &[offset, same, other], |all| {
                let start = Fit::plain(all.data, Model::of(all.data.twin));
                let last = Fit::plain(all.data, start.model.with(Term::new(offset, Vec::new())));
                let other = all.tried(&last, &last.sizes, &Term::new(other, Vec::new()));
                let standing = all.standing(&last, 0);
                assert!(other.nats > standing.cause().nats && standing.cause().nats > 3.0);
                standing.ranked.iter().map(|h| h.candidate()).collect()
            });
        assert!(names.contains(&offset) && names.contains(&same), "{names:?}");
        assert!(!names.contains(&other), "{names:?}");
    }

    /// How large moments and inertia of a load can be follows from its mass, which no start says.
    #[test]
    fn a_light_load_is_screened_as_it_is_weighed() {
        let mut arm = Twin::default();
        arm.effects.push("payload".into());
        let values = [("mass", 0.3), ("moment_x", 0.0), ("moment_y", 0.0), ("moment_z", 0.03)];
        for (name, value) in values {
            arm.values.insert(format!("payload_{name}"), vec![value]);
        }
        let payload = Candidate::new(find("payload").unwrap(), Place::Arm);
        let none = |made: &Samples| vec![0.0; made.len()];
        let [screened, weighed] = of_arm(&arm, none, 3.0, &[payload], |all| {
            let start = Fit::plain(all.data, Model::of(all.data.twin));
            let about = screen(&start, &[payload]).remove(0);
            let about_nats = about.gain - all.ln_rivals();
            [about_nats, all.weigh(&start, vec![about], 1).remove(0).nats]
        });
        assert!(weighed > 3.0 && is_near(screened, weighed), "{screened} {weighed}");
    }
}
