//! Which causes are added to the twin, one after the other.
//!
//! Candidates are ranked by the log-likelihood they gain on both recordings, fitted on the first
//! and frozen on the second; the noise of each joint is what is left of it, so that
//! L = sum_j n_j/2 ln(chi2_j before / chi2_j after), n_j the effective samples of what the best
//! candidate leaves. One is added if no surrogate gap is explained as well, the second recording
//! agrees, and no parameter is at a bound.

use rayon::prelude::*;

use super::candidate::{Candidate, Place};
use super::columns::Blocks;
use super::evidence::Evidence;
use super::leftover::in_motion_band;
use super::model::{Fit, Model};
use super::search::{self, Trial};
use super::surrogates::surrogates;
use super::{Settings, significance};
use crate::effects::Role;
use crate::statistics::effective_samples;

/// Causes that are looked for one after the other.
const MOST_CAUSES: usize = 5;
/// Candidates that are refined and held against the second recording.
const REFINED: usize = 24;
/// Of the best start's gain: what gains less at its own best start is not refined.
const WORTH_REFINING: f64 = 0.2;
/// Of the mean square of the joints it acts on: a smaller gain on the check is no finding.
const LEAST_GAIN: f64 = 0.01;
/// The same at joints where the motion's band holds little more than noise.
const LEAST_QUIET_GAIN: f64 = 0.05;
/// Power in the motion's band over the noise: up to the first nothing is left, from the second
/// on something systematic may be.
const QUIET_BAND: f64 = 1.2;
const UNQUIET_BAND: f64 = 1.5;
/// Of the best score: how much an inexact signature may cost.
const INEXACT: f64 = 0.01;
/// Surrogate gaps explained as well as the real one, at most, as a share.
const LEVEL: f64 = 0.05;
/// Log-likelihood on the check recording below which nothing is claimed, nats.
const LEAST_NATS: f64 = 6.0;

/// A candidate added to a model, fitted on the first recording and held against the second.
pub struct Hypothesis<'a, 'e> {
    pub trial: Trial,
    pub fit: Fit<'a, 'e>,
    /// On the check recording, N.m.
    pub residual: Blocks,
    /// Log-likelihood gained, nats.
    pub gain_fit: f64,
    pub gain_check: f64,
    /// `gain_fit` + `gain_check` less the price of its parameters.
    pub score: f64,
    /// A parameter at a bound that is not its null value.
    pub at_bound: Option<&'static str>,
}

/// One round of the search.
pub struct Round<'a, 'e> {
    /// Best first.
    pub ranked: Vec<Hypothesis<'a, 'e>>,
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

/// A fit and what it leaves of the check recording.
pub struct State<'a, 'e> {
    pub fit: Fit<'a, 'e>,
    pub residual: Blocks,
}

impl<'a, 'e> Search<'a, 'e> {
    pub fn state(&self, model: Model) -> State<'a, 'e> {
        let fit = Fit::new(self.fit, model);
        let residual = fit.held_against(self.check);
        State { fit, residual }
    }

    /// Adds causes until one is declined.
    pub fn run(&self, start: &State<'a, 'e>) -> Vec<Round<'a, 'e>> {
        let mut rounds: Vec<Round> = Vec::new();
        let mut model = start.fit.model.clone();
        for _ in 0..MOST_CAUSES {
            let state = self.state(model.clone());
            if !rounds.is_empty() && self.is_quiet(&state) {
                break;
            }
            let round = self.round(&state);
            let accepted = round.accepted;
            rounds.push(round);
            let Some(i) = accepted else { break };
            let Some(last) = rounds.last() else { break };
            model = last.ranked[i].fit.model.clone();
        }
        rounds
    }

    /// Is there nothing but noise left where the arm moves?
    fn is_quiet(&self, state: &State<'a, 'e>) -> bool {
        in_motion_band(self.check, &state.residual).iter().all(|ratio| *ratio < UNQUIET_BAND)
    }

    fn round(&self, state: &State<'a, 'e>) -> Round<'a, 'e> {
        let mut around =
            surrogates(&state.fit.system.residual, self.settings.surrogates, self.settings.seed);
        around.iter_mut().for_each(|s| state.fit.system.take_out(s));
        let open: Vec<Candidate> = self
            .candidates
            .iter()
            .filter(|c| !state.fit.model.causes.iter().any(|t| t.candidate == **c))
            .copied()
            .collect();
        let (mut screened, by_chance) = search::screen(&state.fit, &open, &around);
        screened.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let top = &screened[..screened.len().min(REFINED)];
        let mut ranked: Vec<Hypothesis> =
            top.par_iter().map(|trial| self.hypothesis(state, trial, top[0].gain)).collect();
        self.score(state, &mut ranked);
        let grid = |h: &Hypothesis| {
            let same = |t: &&Trial| t.candidate == h.trial.candidate;
            screened.iter().find(same).map_or(0.0, |t| t.gain)
        };
        let p = |h: &Hypothesis| {
            let as_good = by_chance.iter().filter(|g| **g >= grid(h)).count();
            (1 + as_good) as f64 / (1 + by_chance.len()) as f64
        };
        let in_motion_band = in_motion_band(self.check, &state.residual);
        let physical = ranked.iter().position(|h| h.at_bound.is_none());
        let best = physical.map(|i| &ranked[i]);
        let tolerance = best.map_or(LEAST_NATS, |best| self.tolerance(best));
        let (accepted, declined) = match best {
            None => (None, Some("nothing gains anything".to_string())),
            Some(best) => {
                let from = best.score - tolerance;
                self.decide(state, &ranked, from, &in_motion_band, &p)
            }
        };
        let p = best.map_or(1.0, p);
        Round { ranked, p, screened, in_motion_band, tolerance, accepted, declined }
    }

    fn hypothesis(&self, state: &State<'a, 'e>, start: &Trial, best: f64) -> Hypothesis<'a, 'e> {
        let trial = match start.gain >= WORTH_REFINING * best {
            true => search::refine(&state.fit, start),
            false => start.clone(),
        };
        let fit = search::adopt(&state.fit, &state.fit.model, &trial);
        let residual = fit.held_against(self.check);
        let at_bound = at_bound(&fit, &trial);
        let nothing = 0.0;
        Hypothesis {
            trial,
            fit,
            residual,
            gain_fit: nothing,
            gain_check: nothing,
            score: nothing,
            at_bound,
        }
    }

    /// Gains and order; effective samples from what the best leaves.
    fn score(&self, state: &State, ranked: &mut [Hypothesis<'a, 'e>]) {
        let ones = vec![1.0; self.fit.joints()];
        self.score_with(state, ranked, &ones);
        if let Some(best) = ranked.first() {
            let effective = effective_shares(&best.fit.system.residual);
            self.score_with(state, ranked, &effective);
        }
    }

    fn score_with(&self, state: &State, ranked: &mut [Hypothesis<'a, 'e>], share: &[f64]) {
        let check_before = state.residual.squares();
        for h in ranked.iter_mut() {
            h.gain_fit = gain(self.fit, &state.fit.squares, &h.fit.squares, share);
            h.gain_check = gain(self.check, &check_before, &h.residual.squares(), share);
            h.score =
                h.gain_fit + h.gain_check - price(&h.trial, &h.fit) - surprise(&h.trial, &h.fit);
        }
        ranked.sort_by(|a, b| b.score.total_cmp(&a.score));
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

    /// Differences of score that count as none: a few nats where the best leaves nothing but noise,
    /// up to 1 % where it leaves more (its signature is not exact then).
    fn tolerance(&self, best: &Hypothesis) -> f64 {
        let left = in_motion_band(self.check, &best.residual);
        let touched = (0..left.len()).filter(|j| acts_on(best.trial.candidate, *j));
        let worst = touched.map(|j| left[j]).fold(1.0, f64::max);
        LEAST_NATS + INEXACT * best.score.max(0.0) * (worst - QUIET_BAND).clamp(0.0, 1.0)
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

pub fn acts_on(candidate: Candidate, joint: usize) -> bool {
    match candidate.place {
        Place::Arm => true,
        Place::Joint(j) => {
            j == joint || candidate.effect.about().scope == crate::effects::Scope::Link
        }
    }
}

/// `stribeck at joint 2`, `payload`.
pub fn describe(candidate: Candidate) -> String {
    match candidate.place {
        Place::Joint(j) => format!("{} at joint {}", candidate.name(), j + 1),
        Place::Arm => candidate.name().to_string(),
    }
}

/// sum_j n_j/2 ln(before_j / after_j)
fn gain(evidence: &Evidence, before: &[f64], after: &[f64], share: &[f64]) -> f64 {
    let joint = |j: usize| {
        let n = evidence.rows[j].len() as f64;
        let (b, a) = (before[j], after[j].max(f64::MIN_POSITIVE));
        if n > 0.0 && b > 0.0 { 0.5 * n * share[j] * (b / a).ln() } else { 0.0 }
    };
    (0..before.len()).map(joint).sum()
}

/// Schwarz's price of the parameters, nats.
fn price(trial: &Trial, fit: &Fit) -> f64 {
    let searched = trial.searched().len();
    let touched = |j: &usize| acts_on(trial.candidate, *j);
    let rows: usize =
        (0..fit.evidence.joints()).filter(touched).map(|j| fit.evidence.rows[j].len()).sum();
    0.5 * (trial.linear.len() + searched) as f64 * (rows.max(2) as f64).ln()
}

/// How unlikely the values are by what is known of them beforehand, nats.
fn surprise(trial: &Trial, fit: &Fit) -> f64 {
    let joint = if let Place::Joint(j) = trial.candidate.place { j } else { 0 };
    let expected = trial.candidate.effect.expected(&fit.evidence.twin.robot, joint);
    let values = fit.values(fit.model.causes.len() - 1);
    expected.iter().zip(values).map(|(sd, value)| 0.5 * (value / sd).powi(2)).sum()
}

/// Effective over actual samples of what is left, joint by joint.
pub fn effective_shares(residual: &Blocks) -> Vec<f64> {
    let share = |rows: &Vec<f64>| match rows.len() {
        0 => 1.0,
        n => effective_samples(rows) / n as f64,
    };
    residual.0.iter().map(share).collect()
}

/// The first parameter of the last cause that sits at a bound: a linear one at the end of its
/// range or held at zero by its sign beside others that are not, a nonlinear one at the end of its
/// range unless a search starts there.
fn at_bound(fit: &Fit, trial: &Trial) -> Option<&'static str> {
    let last = fit.model.causes.len() - 1;
    let candidate = fit.model.causes[last].candidate;
    let values = fit.values(last);
    let held = &fit.model.causes[last].held;
    let several = held.iter().any(|h| !h);
    let reached = |(i, (p, v)): (usize, (&crate::effects::Parameter, &f64))| {
        let near = 1e-3 * (p.max - p.min);
        let at_end = *v <= p.min + 1e-3 * p.min.abs() || *v >= p.max - near;
        let at = match p.role {
            Role::Linear if held[i] => several && p.min == 0.0,
            Role::Linear => at_end && *v != p.null,
            Role::Nonlinear => {
                let k = i - candidate.linear();
                trial.searched().contains(&k) && at_end && trial.starts.iter().all(|s| s[k] != *v)
            }
        };
        at.then_some(p.name)
    };
    candidate.effect.about().parameters.iter().zip(&values).enumerate().find_map(reached)
}
