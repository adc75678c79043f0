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
    followed(all, found, after, Way::Only)
}

/// One of the ways of a search.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// It may fork.
    Only,
    /// Of a fork, which is asked once, or ways would double. Whoever follows the search is told of the first.
    First,
    Second,
}

/// Round after round. Where one cause for several joints and one for each of them are at hand, a load and what stands in
/// for it joint by joint, it shows where each way ends which is the better one.
fn followed<'a>(all: &Hypotheses<'a>, mut found: Found<'a>, after: usize, way: Way) -> Found<'a> {
    while found.last.model.causes.len() < all.criteria.most_causes {
        // Every round but the last adds a cause.
        let left = all.criteria.most_causes - found.last.model.causes.len();
        if way != Way::Second {
            tell(all, found.rounds.len(), left + after);
        }
        let open = all.open(&found.last.model);
        let screened = screen(&found.last, &open);
        if found.rounds.is_empty() {
            found.screened = screened.iter().map(|s| (s.trial.candidate, s.gain)).collect();
        }
        let ranked = all.weigh(&found.last, screened, WEIGHED);
        let choices = choices(all, &found.start, &found.last, &ranked);
        found.rounds.push(Round { weighed: weighed(&ranked), added: Vec::new() });
        if let ([one, other], Way::Only) = (&choices[..], way) {
            let end = |added: &[&Hypothesis<'a>], way| {
                let (found, grew) = taken(all, found.clone(), added);
                if grew { followed(all, found, after, way) } else { found }
            };
            let (one, other) = rayon::join(|| end(one, Way::First), || end(other, Way::Second));
            let [gained, others] = [&one, &other].map(|f| all.gained(&f.start, &f.last));
            let better = others - gained > all.criteria.least_nats;
            return if better { other } else { one };
        }
        let Some(added) = choices.first() else { break };
        let grew;
        (found, grew) = taken(all, found, added);
        if !grew {
            break;
        }
    }
    found
}

/// With these causes added in the last round, all seen together again; do other causes stand now?
fn taken<'a>(
    all: &Hypotheses<'a>,
    mut found: Found<'a>,
    added: &[&Hypothesis<'a>],
) -> (Found<'a>, bool) {
    let names: Vec<Candidate> = added.iter().map(|h| h.candidate()).collect();
    let last = revised(all, with(all, &found.last, added), names.clone());
    let grew = !last.model.has_causes_of(&found.last.model);
    found.rounds.last_mut().into_iter().for_each(|round| round.added.clone_from(&names));
    found.last = last;
    (found, grew)
}

/// Tells who follows how many rounds are done, and how many are left at most.
pub fn tell(all: &Hypotheses<'_>, done: usize, left: usize) {
    all.data.watch.bound(SEARCHING, done as u64, (done + left) as u64);
}

fn weighed(ranked: &[Hypothesis<'_>]) -> Vec<Weighed> {
    let one = |h: &Hypothesis<'_>| Weighed {
        candidate: h.candidate(),
        nats: h.nats,
        at_bound: h.at_bound,
        values: h.fit.values(h.fit.model.causes.len() - 1),
    };
    ranked.iter().map(one).collect()
}

/// What may be added next: the best cause that acts on several joints, or the best of every joint, for an arm's drives are
/// alike, and lack the same. First what has more evidence in all; none where nothing has enough.
fn choices<'h, 'a>(
    all: &Hypotheses<'a>,
    start: &Fit<'a>,
    state: &Fit<'a>,
    ranked: &'h [Hypothesis<'a>],
) -> Vec<Vec<&'h Hypothesis<'a>>> {
    let enough = |h: &&Hypothesis<'a>| {
        h.at_bound.is_none() && worth(all, start, state, h) > all.criteria.least_nats
    };
    let good: Vec<&Hypothesis<'a>> = ranked.iter().filter(enough).collect();
    let acts_on_several = |h: &&&Hypothesis<'a>| h.candidate().extent() == Extent::Several;
    let mut singles: Vec<&Hypothesis<'a>> = Vec::new();
    for h in good.iter().filter(|h| !acts_on_several(h)) {
        if !singles.iter().any(|s| s.candidate().extent() == h.candidate().extent()) {
            singles.push(h);
        }
    }
    let together: f64 = singles.iter().map(|h| h.nats).sum();
    let several = good.first().filter(acts_on_several);
    let mut choices: Vec<Vec<_>> = several.map(|h| vec![*h]).into_iter().collect();
    if !singles.is_empty() {
        choices.push(singles);
    }
    if several.is_some_and(|h| h.nats < together) {
        choices.reverse();
    }
    choices
}

/// The state with these causes.
fn with<'a>(all: &Hypotheses<'a>, state: &Fit<'a>, added: &[&Hypothesis<'a>]) -> Fit<'a> {
    if let [only] = added {
        return only.fit.clone();
    }
    let model = added.iter().fold(state.model.clone(), |m, h| m.with(h.trial.term()));
    let mut sizes = state.sizes.clone();
    for h in added {
        for j in all.touched(h.candidate()) {
            sizes.joints[j].clone_from(&h.fit.sizes.joints[j]);
        }
    }
    all.tuned(Fit::new(all.data, model, sizes), &[])
}

/// Evidence that a hypothesis adds, as far as it can be trusted beside what was found where it acts.
fn worth<'a>(all: &Hypotheses<'a>, start: &Fit<'a>, state: &Fit<'a>, h: &Hypothesis<'a>) -> f64 {
    let gained = |j: usize| (state.ln_likelihood(j) - start.ln_likelihood(j)).max(0.0);
    let before: f64 = all.touched(h.candidate()).into_iter().map(gained).sum();
    all.criteria.trusted(before + h.nats) - all.criteria.trusted(before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Settings;
    use crate::diagnosis::candidate::Place;
    use crate::diagnosis::criteria::Criteria;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::observed::Observed;
    use crate::effects::find;
    use crate::signals::Samples;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const OFFSET_NM: f64 = 0.3;

    /// An arm with a load, and offsets at its ends, where a load hardly shows.
    fn laden(twin: &Twin) -> Samples {
        let mut arm = twin.clone();
        arm.effects.push("payload".into());
        for (name, value) in
            [("mass", 1.0), ("moment_x", 0.0), ("moment_y", 0.0), ("moment_z", 0.1)]
        {
            arm.values.insert(format!("payload_{name}"), vec![value]);
        }
        let mut made = samples(6, 4000, |j, t| {
            0.7 * ((0.9 + 0.2 * j as f64) * t).sin() + 0.4 * (0.6 * t + j as f64).cos()
        });
        made.torque = arm.torque(&arm.motion(&made));
        for j in [0, 5] {
            made.torque.joint_mut(j).iter_mut().for_each(|t| *t += OFFSET_NM);
        }
        noisy(&mut made, 0.3);
        made
    }

    /// Offsets and what stands in for the load joint by joint have more evidence together than the load.
    #[test]
    fn where_two_ways_lead_tells_which_is_the_better_one() {
        let twin = Twin::default();
        let made = laden(&twin);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let settings = Settings { mass_error: 0.0, ..Settings::default() };
        let data = Data::new(vec![&observed], &settings);
        let at = |name: &str, place| Candidate::new(find(name).unwrap(), place);
        let payload = at("payload", Place::Arm);
        let names = ["current_offset", "torque_constant", "coulomb_asymmetry"];
        let singles = (0..6).flat_map(|j| names.map(|name| at(name, Place::Joint(j))));
        let candidates = singles.chain([payload]).collect();
        let all = Hypotheses { data: &data, candidates, criteria: Criteria::default() };
        let start = Found::none(&all);
        let ranked = all.weigh(&start.last, screen(&start.last, &all.candidates), WEIGHED);
        let choices = choices(&all, &start.start, &start.last, &ranked);
        let nats: Vec<_> = ranked.iter().map(|h| (h.candidate().name(), h.nats)).collect();
        assert!(choices.len() == 2, "{nats:?}");
        let found = grown(&all, start.clone(), 0);
        assert!(found.last.model.has(payload));
        let last = found.rounds.last().unwrap();
        assert!(last.added.is_empty() && found.rounds.len() >= 2);
        let gained = |found: &Found<'_>| all.gained(&start.start, &found.last);
        for added in &choices {
            let forked = Round { weighed: weighed(&ranked), added: Vec::new() };
            let from = Found { rounds: vec![forked], ..start.clone() };
            let end = followed(&all, taken(&all, from, added).0, 0, Way::First);
            assert!(gained(&found) >= gained(&end) - all.criteria.least_nats);
        }
    }
}
