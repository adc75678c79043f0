//! Candidates added to a model, and how they compare.
//!
//! They are ranked by the log-likelihood they gain on both recordings, fitted on the first and
//! frozen on the second; the noise of each joint is what is left of it, so that
//! L = sum_j n_j/2 ln(chi2_j before / chi2_j after), n_j the effective samples of what the best
//! candidate leaves.

use rayon::prelude::*;

use super::bound::Adopted;
use super::candidate::{Candidate, Extent, Place};
use super::columns::Blocks;
use super::evidence::Evidence;
use super::leftover::in_motion_band;
use super::model::{Fit, Model};
use super::search::{self, Trial};
use super::select::Search;
use crate::effects::Role;
use crate::statistics::effective_samples;

/// Of the best start's gain: what gains less at its own best start is not refined.
const WORTH_REFINING: f64 = 0.2;
/// Power in the motion's band over the noise up to which nothing is left.
const QUIET_BAND: f64 = 1.2;
/// Of the best score: how much an inexact signature may cost.
const INEXACT: f64 = 0.01;
/// Standard deviations below zero that are no accident.
const SURELY: f64 = 3.0;
/// Of its size before: how far below zero friction is not friction any more.
const UNPHYSICAL: f64 = 0.25;
/// Log-likelihood below which nothing is claimed, nats.
pub const LEAST_NATS: f64 = 6.0;

/// A model fitted to the first recording, and what it leaves of the second.
pub struct State<'a, 'e> {
    pub fit: Fit<'a, 'e>,
    pub residual: Blocks,
}

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

impl<'a, 'e> Search<'a, 'e> {
    pub fn state(&self, model: Model) -> State<'a, 'e> {
        let fit = Fit::new(self.fit, model);
        let residual = fit.held_against(self.check);
        State { fit, residual }
    }

    /// The trials (best first) refined and held against the second recording, best first by what
    /// they gain in `extent`.
    pub fn rank(
        &self,
        state: &State<'a, 'e>,
        trials: &[Trial],
        extent: Extent,
    ) -> Vec<Hypothesis<'a, 'e>> {
        let best = trials.first().map_or(0.0, |t| t.gain);
        let refine = |trial: &Trial| match trial.gain >= WORTH_REFINING * best {
            true => search::refine(&state.fit, trial),
            false => trial.clone(),
        };
        let refined: Vec<Trial> = trials.par_iter().map(refine).collect();
        self.hold(state, &refined, extent)
    }

    /// The trials as they are held against the second recording, best first.
    pub fn hold(
        &self,
        state: &State<'a, 'e>,
        trials: &[Trial],
        extent: Extent,
    ) -> Vec<Hypothesis<'a, 'e>> {
        let mut ranked: Vec<Hypothesis> =
            trials.par_iter().map(|trial| self.hypothesis(state, trial)).collect();
        self.score(state, &mut ranked, extent);
        ranked
    }

    fn hypothesis(&self, state: &State<'a, 'e>, trial: &Trial) -> Hypothesis<'a, 'e> {
        let adopted = Adopted::new(&state.fit, trial.clone()).inside();
        let Adopted { trial, fit, at_bound, .. } = adopted.without_pushing();
        let residual = fit.held_against(self.check);
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
    fn score(&self, state: &State, ranked: &mut [Hypothesis<'a, 'e>], extent: Extent) {
        let within = |j: usize| f64::from(u8::from(extent.covers(j)));
        let joints: Vec<f64> = (0..self.fit.joints()).map(within).collect();
        self.score_with(state, ranked, &joints);
        if let Some(best) = ranked.first() {
            let effective = effective_shares(&best.fit.system.residual);
            let counted: Vec<f64> = effective.iter().zip(&joints).map(|(e, w)| e * w).collect();
            self.score_with(state, ranked, &counted);
        }
    }

    fn score_with(&self, state: &State, ranked: &mut [Hypothesis<'a, 'e>], share: &[f64]) {
        for h in ranked.iter_mut() {
            [h.gain_fit, h.gain_check] = self.gains(state, &h.fit, &h.residual, share);
            h.score = h.gain_fit + h.gain_check - price(&h.fit, h.fit.model.causes.len() - 1);
        }
        ranked.sort_by(|a, b| b.score.total_cmp(&a.score));
    }

    /// Log-likelihood that a fit gains over a state on both recordings, nats; `share` of the
    /// samples count, joint by joint.
    pub fn gains(&self, from: &State, fit: &Fit, residual: &Blocks, share: &[f64]) -> [f64; 2] {
        let on_fit = gain(self.fit, &from.fit.squares, &fit.squares, share);
        [on_fit, gain(self.check, &from.residual.squares(), &residual.squares(), share)]
    }

    /// Power in the motion's band over the noise, joint by joint, of what a fit leaves of both
    /// recordings; on the second.
    pub fn in_motion_band(&self, fit: &Fit, residual: &Blocks) -> Vec<f64> {
        let noise = self.colours.of(&fit.system.residual, residual).in_motion_band;
        in_motion_band(self.check, residual).into_iter().map(|level| level / noise).collect()
    }

    /// Differences of score that count as none: a few nats where the best leaves nothing but noise,
    /// up to 1 % where it leaves more (its signature is not exact then).
    pub fn tolerance(&self, best: &Hypothesis) -> f64 {
        let left = self.in_motion_band(&best.fit, &best.residual);
        let touched = (0..left.len()).filter(|j| acts_on(best.trial.candidate, *j));
        let worst = touched.map(|j| left[j]).fold(1.0, f64::max);
        LEAST_NATS + INEXACT * best.score.max(0.0) * (worst - QUIET_BAND).clamp(0.0, 1.0)
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
pub fn gain(evidence: &Evidence, before: &[f64], after: &[f64], share: &[f64]) -> f64 {
    let joint = |j: usize| {
        let n = evidence.rows[j].len() as f64;
        let (b, a) = (before[j], after[j].max(f64::MIN_POSITIVE));
        if n > 0.0 && b > 0.0 { 0.5 * n * share[j] * (b / a).ln() } else { 0.0 }
    };
    (0..before.len()).map(joint).sum()
}

/// What the parameters of cause `i` cost, nats: Schwarz's price, and how unlikely the values are
/// by what is known of them beforehand.
pub fn price(fit: &Fit, i: usize) -> f64 {
    let term = &fit.model.causes[i];
    let touched = |j: &usize| acts_on(term.candidate, *j);
    let rows: usize =
        (0..fit.evidence.joints()).filter(touched).map(|j| fit.evidence.rows[j].len()).sum();
    let parameters = term.candidate.linear() + term.searched.len();
    let joint = if let Place::Joint(j) = term.candidate.place { j } else { 0 };
    let expected = term.candidate.effect.expected(&fit.evidence.twin.robot, joint);
    let values = fit.values(i);
    let surprise: f64 = expected.iter().zip(values).map(|(sd, v)| 0.5 * (v / sd).powi(2)).sum();
    0.5 * parameters as f64 * (rows.max(2) as f64).ln() + surprise
}

/// Effective over actual samples of what is left, joint by joint.
pub fn effective_shares(residual: &Blocks) -> Vec<f64> {
    let share = |rows: &Vec<f64>| match rows.len() {
        0 => 1.0,
        n => effective_samples(rows) / n as f64,
    };
    residual.0.iter().map(share).collect()
}

/// A parameter of the twin's own that a cause drives well below zero where it may not be: friction
/// that pushes. Where it was so before, the cause is not to blame.
pub fn beyond(before: &Fit, after: &Fit, extent: Extent) -> Option<&'static str> {
    let mut index = 0;
    for term in &after.model.open {
        let parameters = term.candidate.effect.about().parameters.iter();
        for p in parameters.filter(|p| p.role == Role::Linear) {
            let [was, is] = [before, after].map(|fit| fit.system.x[index]);
            let sure = is < -SURELY * after.system.variance(index).sqrt();
            let here = term.prior.is_empty() && term.candidate.extent().meets(extent);
            if here && p.min >= 0.0 && was > 0.0 && sure && is < -UNPHYSICAL * was {
                return Some(p.name);
            }
            index += 1;
        }
    }
    None
}
