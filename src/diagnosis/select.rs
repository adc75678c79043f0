//! Which causes are added to the twin, one after the other.
//!
//! One is added if no surrogate gap is explained as well, the second recording agrees, and no
//! parameter is at a bound; then all that were added are seen together again (`revise`).

use std::sync::Arc;

use super::candidate::Candidate;
use super::evidence::Evidence;
use super::leftover::in_motion_band;
use super::model::Model;
use super::rank::{Hypothesis, LEAST_NATS, State, acts_on, describe};
use super::search::{self, Trial};
use super::surrogates::surrogates;
use super::{Settings, significance};

/// Causes that are looked for one after the other.
const MOST_CAUSES: usize = 5;
/// Candidates that are refined and held against the second recording.
pub const REFINED: usize = 24;
/// Of the mean square of the joints it acts on: a smaller gain on the check is no finding.
const LEAST_GAIN: f64 = 0.01;
/// The same at joints where the motion's band holds little more than noise.
const LEAST_QUIET_GAIN: f64 = 0.05;
/// Power in the motion's band over the noise from which something systematic may be left.
const UNQUIET_BAND: f64 = 1.5;
/// Surrogate gaps explained as well as the real one, at most, as a share.
const LEVEL: f64 = 0.05;

/// One round of the search.
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
    /// Why not, where none was.
    pub declined: Option<String>,
}

pub struct Search<'a, 'e> {
    pub fit: &'a Evidence<'e>,
    pub check: &'a Evidence<'e>,
    pub settings: &'a Settings,
    pub candidates: Vec<Candidate>,
}

impl<'a, 'e> Search<'a, 'e> {
    /// Adds causes until one is declined; the rounds and the model with all causes.
    pub fn run(&self, start: &State<'a, 'e>) -> (Vec<Round<'a, 'e>>, Model) {
        let mut rounds: Vec<Round> = Vec::new();
        let mut model = start.fit.model.clone();
        for _ in 0..MOST_CAUSES {
            let state = self.state(model.clone());
            if !rounds.is_empty() && self.is_quiet(&state) {
                break;
            }
            let round = self.round(&state);
            let added = round.accepted.map(|i| round.ranked[i].fit.model.clone());
            rounds.push(round);
            let Some(added) = added else { break };
            let revised = self.revise(added);
            let same = revised.causes.len() == model.causes.len()
                && revised.causes.iter().all(|t| model.has(t.candidate));
            model = revised;
            if same {
                break;
            }
        }
        (rounds, model)
    }

    /// Is there nothing but noise left where the arm moves?
    fn is_quiet(&self, state: &State<'a, 'e>) -> bool {
        in_motion_band(self.check, &state.residual).iter().all(|ratio| *ratio < UNQUIET_BAND)
    }

    fn round(&self, state: &State<'a, 'e>) -> Round<'a, 'e> {
        let mut around =
            surrogates(&state.fit.system.residual, self.settings.surrogates, self.settings.seed);
        around.iter_mut().for_each(|s| state.fit.system.take_out(s));
        let open = self.candidates.iter().filter(|c| !state.fit.model.has(**c));
        let open: Vec<Candidate> = open.copied().collect();
        let (screened, by_chance) = search::screen(&state.fit, &open, &around);
        let ranked = self.rank(state, &screened[..screened.len().min(REFINED)]);
        let grid = |h: &Hypothesis| {
            let same = |t: &&Trial| t.candidate == h.trial.candidate;
            screened.iter().find(same).map_or(0.0, |t| t.gain)
        };
        let p = |h: &Hypothesis| {
            let as_good = by_chance.iter().filter(|g| **g >= grid(h)).count();
            (1 + as_good) as f64 / (1 + by_chance.len()) as f64
        };
        let in_motion_band = in_motion_band(self.check, &state.residual);
        let best = ranked.iter().find(|h| h.at_bound.is_none());
        let tolerance = best.map_or(LEAST_NATS, |best| self.tolerance(best));
        let (accepted, declined) = match best {
            None => (None, Some("nothing gains anything".to_string())),
            Some(best) => {
                let from = best.score - tolerance;
                self.decide(state, &ranked, from, &in_motion_band, &p)
            }
        };
        let p = best.map_or(1.0, p);
        let ranked = Arc::new(ranked);
        Round { ranked, p, screened, in_motion_band, tolerance, accepted, declined }
    }

    /// The first of the ranking that can be accepted, down to the score `from`; what is at a bound
    /// is no explanation.
    fn decide(
        &self,
        state: &State,
        ranked: &[Hypothesis],
        from: f64,
        in_motion_band: &[f64],
        p: &dyn Fn(&Hypothesis) -> f64,
    ) -> (Option<usize>, Option<String>) {
        let near = ranked.iter().take_while(|h| h.score >= from);
        let mut why = None;
        for (i, h) in near.enumerate().filter(|(_, h)| h.at_bound.is_none()) {
            match self.objection(state, h, in_motion_band, p(h)) {
                None => return (Some(i), None),
                Some(objection) => why = why.or(Some(objection)),
            }
        }
        (None, why)
    }

    fn objection(
        &self,
        state: &State,
        h: &Hypothesis,
        in_motion_band: &[f64],
        p: f64,
    ) -> Option<String> {
        let name = describe(h.trial.candidate);
        if p >= LEVEL {
            return Some(format!(
                "{name} explains no more than chance: a search of surrogate gaps finds as much in \
                 {:.0} % of them",
                100.0 * p
            ));
        }
        if h.gain_check < LEAST_NATS {
            return Some(format!("{name} does not help on the second recording"));
        }
        let touched = |j: &usize| acts_on(h.trial.candidate, *j);
        let joints: Vec<usize> = (0..self.fit.joints()).filter(touched).collect();
        let [low, middle] =
            significance::shrink(&state.residual, &h.residual, &joints, self.settings.seed);
        let systematic = joints.iter().any(|&j| in_motion_band[j] > UNQUIET_BAND);
        let least = if systematic { LEAST_GAIN } else { LEAST_QUIET_GAIN };
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
