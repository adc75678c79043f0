//! Which causes are added to the twin, one after the other.
//!
//! One is added if no surrogate gap is explained as well (or the second recording leaves no doubt),
//! the second recording agrees, and no parameter is at a bound; then all that were added are seen
//! together again (`revise`).

use std::sync::Arc;

use super::candidate::{Candidate, Extent};
use super::chance::Chance;
use super::colour::Colours;
use super::evidence::Evidence;
use super::leftover::Remains;
use super::model::Model;
use super::rank::{Hypothesis, LEAST_NATS, State, acts_on, beyond, describe};
use super::search::{self, Trial};
use super::surrogates::surrogates;
use super::{Settings, significance};

/// Rounds of looking for one more cause.
const MOST_ROUNDS: usize = 8;
/// Candidates that are refined and held against the second recording.
pub const REFINED: usize = 24;
/// Of the mean square of the joints it acts on: a smaller gain on the check is no finding.
const LEAST_GAIN: f64 = 0.01;
/// The same at joints where the motion's band holds little more than noise, unless frozen values gain
/// as many nats there: what acts in few samples, as a lost motion does, is sure and small.
const LEAST_QUIET_GAIN: f64 = 0.05;
const SURE_AND_SMALL_NATS: f64 = 100.0;
/// Power in the motion's band over the noise from which something systematic may be left.
const UNQUIET_BAND: f64 = 1.5;
/// Surrogate gaps explained as well as the real one, at most, as a share.
const LEVEL: f64 = 0.05;
/// Frozen values that gain as much on the second recording need no surrogates: nothing was searched
/// there, and short slow motions leave surrogates few frequencies to differ in.
pub const SURE_NATS: f64 = 50.0;

/// One round of the search.
#[derive(Clone)]
pub struct Round<'a, 'e> {
    /// Best first.
    pub ranked: Arc<Vec<Hypothesis<'a, 'e>>>,
    /// Share of surrogate gaps explained as well as the real one.
    pub p: f64,
    /// Screened gains of all candidates, for the ranking.
    pub screened: Vec<Trial>,
    /// Power in the motion's band over the noise before this round, per joint.
    pub in_motion_band: Vec<f64>,
    /// Differences of score that count as none.
    pub tolerance: f64,
    /// Index in `ranked` of the one that was added, if any.
    pub accepted: Option<usize>,
    /// Indices of the same effect at other joints, added along.
    pub along: Vec<usize>,
    /// Why not, where none was.
    pub declined: Option<String>,
}

#[derive(Clone)]
pub struct Search<'a, 'e> {
    pub fit: &'a Evidence<'e>,
    pub check: &'a Evidence<'e>,
    pub settings: &'a Settings,
    pub candidates: Vec<Candidate>,
    pub colours: &'a Colours<'a, 'e>,
}

impl Round<'_, '_> {
    /// With what was added.
    fn model(&self) -> Option<Model> {
        let best = self.accepted.map(|i| self.ranked[i].fit.model.clone())?;
        Some(self.along.iter().fold(best, |model, &i| model.with(self.ranked[i].trial.term())))
    }
}

impl<'a, 'e> Search<'a, 'e> {
    /// Adds causes until one is declined; the rounds and the model with all causes.
    pub fn run(&self, mut model: Model) -> (Vec<Round<'a, 'e>>, Model) {
        let mut rounds: Vec<Round> = Vec::new();
        for _ in 0..MOST_ROUNDS {
            let state = self.state(model.clone());
            if !rounds.is_empty() && self.is_quiet(&state) {
                break;
            }
            let round = self.round(&state);
            let added = round.model();
            rounds.push(round);
            let Some(added) = added else { break };
            let fresh = added.causes.iter().filter(|t| !model.has(t.candidate));
            let fresh = fresh.map(|t| t.candidate).collect();
            let revised = self.revise(added, fresh);
            let same = revised.causes.len() == model.causes.len()
                && revised.causes.iter().all(|t| model.has(t.candidate));
            model = revised;
            if same {
                break;
            }
        }
        (rounds, model)
    }

    /// Is there nothing but noise left, where the arm moves and above?
    fn is_quiet(&self, state: &State<'a, 'e>) -> bool {
        let State { fit, residual } = state;
        let noise = self.colours.of(&fit.system.residual, residual);
        let remains = Remains::new(self.check, [residual; 2], noise, fit.answered());
        let quiet = remains.after.iter().all(|ratio| *ratio < UNQUIET_BAND);
        quiet && remains.loud(&remains.chi2_per_sample).next().is_none()
    }

    fn round(&self, state: &State<'a, 'e>) -> Round<'a, 'e> {
        let mut around =
            surrogates(&state.fit.system.residual, self.settings.surrogates, self.settings.seed);
        around.iter_mut().for_each(|s| state.fit.system.take_out(s));
        let open = self.candidates.iter().filter(|c| !state.fit.model.has(**c));
        let open: Vec<Candidate> = open.copied().collect();
        let (screened, gains): (Vec<Trial>, Vec<Vec<f64>>) =
            search::screen(&state.fit, &open, &around).into_iter().unzip();
        let ranked = self.rank(state, &screened[..screened.len().min(REFINED)], Extent::Several);
        let chance = Chance::new(&screened, &gains, around.len());
        let p = |h: &Hypothesis| {
            let same = |t: &Trial| t.candidate == h.trial.candidate;
            screened.iter().position(same).map_or(1.0, |i| chance.p(i))
        };
        let in_motion_band = self.in_motion_band(&state.fit, &state.residual);
        let best = ranked.iter().find(|h| h.at_bound.is_none());
        let tolerance = best.map_or(LEAST_NATS, |best| self.tolerance(best));
        let (accepted, declined) = self.decide(state, &ranked, tolerance, &in_motion_band, &p);
        let along = match accepted {
            Some(best) => self.along(state, &ranked, best, &in_motion_band, &p),
            None => Vec::new(),
        };
        let p = best.map_or(1.0, p);
        let ranked = Arc::new(ranked);
        Round { ranked, p, screened, in_motion_band, tolerance, accepted, along, declined }
    }

    /// An arm's drives are alike: what is found at one is accepted at others as well, where it
    /// stands by itself. Only effects that stay at their joint, or they would share the same gap.
    fn along(
        &self,
        state: &State,
        ranked: &[Hypothesis],
        best: usize,
        in_motion_band: &[f64],
        p: &dyn Fn(&Hypothesis) -> f64,
    ) -> Vec<usize> {
        let found = ranked[best].trial.candidate;
        if found.extent() == Extent::Several {
            return Vec::new();
        }
        let alike = |h: &Hypothesis| {
            let candidate = h.trial.candidate;
            candidate.name() == found.name() && candidate.extent() != Extent::Several
        };
        let stands = |h: &Hypothesis| {
            let enough = h.score > LEAST_NATS && h.at_bound.is_none();
            enough && self.objection(state, h, in_motion_band, p(h)).is_none()
        };
        let others = ranked.iter().enumerate().filter(|(i, h)| *i != best && alike(h));
        others.filter(|(_, h)| stands(h)).map(|(i, _)| i).collect()
    }

    /// The first of the ranking that can be accepted; what is at a bound is no explanation. Where
    /// the best of a joint is declined, so is what fits that joint worse.
    fn decide(
        &self,
        state: &State,
        ranked: &[Hypothesis],
        tolerance: f64,
        in_motion_band: &[f64],
        p: &dyn Fn(&Hypothesis) -> f64,
    ) -> (Option<usize>, Option<String>) {
        let mut declined: Vec<(Extent, f64)> = Vec::new();
        let mut why = None;
        for (i, h) in ranked.iter().enumerate().filter(|(_, h)| h.at_bound.is_none()) {
            let extent = h.trial.candidate.extent();
            let worse = |(other, score): &(Extent, f64)| {
                extent.meets(*other) && h.score < score - tolerance
            };
            if declined.iter().any(worse) {
                continue;
            }
            match self.objection(state, h, in_motion_band, p(h)) {
                None => return (Some(i), None),
                Some(objection) => why = why.or(Some(objection)),
            }
            declined.push((extent, h.score));
        }
        (None, why.or_else(|| Some("nothing gains anything".to_string())))
    }

    fn objection(
        &self,
        state: &State,
        h: &Hypothesis,
        in_motion_band: &[f64],
        p: f64,
    ) -> Option<String> {
        let name = describe(h.trial.candidate);
        if p >= LEVEL && h.gain_check < SURE_NATS {
            return Some(format!(
                "{name} explains no more than chance: a search of surrogate gaps finds as much in \
                 {:.0} % of them",
                100.0 * p
            ));
        }
        if h.gain_check < LEAST_NATS {
            return Some(format!("{name} does not help on the second recording"));
        }
        if let Some(parameter) = beyond(&state.fit, &h.fit, h.trial.candidate.extent()) {
            return Some(format!("{name} needs a negative {parameter} beside it"));
        }
        let touched = |j: &usize| acts_on(h.trial.candidate, *j);
        let joints: Vec<usize> = (0..self.fit.joints()).filter(touched).collect();
        let [low, middle] =
            significance::shrink(&state.residual, &h.residual, &joints, self.settings.seed);
        let systematic = joints.iter().any(|&j| in_motion_band[j] > UNQUIET_BAND);
        let least = match systematic {
            true => LEAST_GAIN,
            false if h.gain_check >= SURE_AND_SMALL_NATS => 0.0,
            false => LEAST_QUIET_GAIN,
        };
        if low <= 0.0 || middle < least {
            return Some(format!(
                "{name} takes {:.1} % (90 %: from {:.1} %) off the second recording's gap, too \
                 little to tell",
                100.0 * middle,
                100.0 * low
            ));
        }
        None
    }
}
