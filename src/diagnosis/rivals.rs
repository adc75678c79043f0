//! Rivals: what else may be at work, how probable each is, and what looks the same.

use super::rank::{Hypothesis, LEAST_NATS};
use super::revise::Standing;
use super::verdict::Findings;
use super::{Cause, Named, Ranked, probability};

impl Findings<'_, '_> {
    /// The strongest cause's rivals, "none" and "unknown": what is at work first of all. If nothing is
    /// `claimed`, what was found counts as declined.
    pub(super) fn ranking(&self, unknown: f64, claimed: bool) -> Vec<Ranked> {
        let Some(first) = self.account.rounds.first() else { return Vec::new() };
        let (ranked, tolerance, claim) = match self.account.standings.first() {
            Some(strongest) if claimed => (&strongest.ranked, strongest.tolerance, 1.0),
            _ => {
                let claim = probability::of_declined(first.p, best_score(&first.ranked));
                (&first.ranked, first.tolerance, claim)
            }
        };
        let scores: Vec<f64> = ranked.iter().map(|h| h.score).collect();
        let shares = probability::shares(&scores, tolerance);
        let known = 1.0 - unknown;
        let mut rows: Vec<Ranked> = ranked
            .iter()
            .zip(&shares)
            .map(|(h, share)| Ranked {
                effect: h.trial.candidate.name().into(),
                joints: h.trial.candidate.place.joints(),
                probability: known * claim * share,
                gain_fit: h.gain_fit,
                gain_check: h.gain_check,
            })
            .collect();
        let refined = |name: &str, joints: &[usize]| {
            ranked.iter().any(|h| {
                h.trial.candidate.name() == name && h.trial.candidate.place.joints() == joints
            })
        };
        rows.extend(first.screened.iter().filter_map(|t| {
            let (name, joints) = (t.candidate.name(), t.candidate.place.joints());
            (!refined(name, &joints)).then(|| Ranked {
                effect: name.into(),
                joints,
                probability: 0.0,
                gain_fit: t.gain,
                gain_check: 0.0,
            })
        }));
        let rest = |effect: &str, probability| Ranked {
            effect: effect.into(),
            joints: Vec::new(),
            probability,
            gain_fit: 0.0,
            gain_check: 0.0,
        };
        let sum: f64 = rows.iter().map(|r| r.probability).sum();
        rows.push(rest("none", (known - sum).max(0.0)));
        rows.push(rest("unknown", unknown));
        rows.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        rows
    }
}

/// Of those that are no rejections.
fn best_score(ranked: &[Hypothesis]) -> f64 {
    let usable = ranked.iter().filter(|h| h.at_bound.is_none());
    usable.map(|h| h.score).fold(0.0, f64::max)
}

/// A cause that torque does not show goes first: what the others share is left by it.
pub fn ranked_with(sensor: &[Cause], mut ranking: Vec<Ranked>) -> Vec<Ranked> {
    for cause in sensor {
        ranking.retain(|r| r.effect != cause.effect || r.joints != cause.joints);
        ranking.iter_mut().for_each(|r| r.probability *= 1.0 - cause.probability);
        let (effect, joints) = (cause.effect.clone(), cause.joints.clone());
        let [gain_fit, gain_check] = [0.0; 2];
        let probability = 1.0 - ranking.iter().map(|r| r.probability).sum::<f64>();
        ranking.insert(0, Ranked { effect, joints, probability, gain_fit, gain_check });
    }
    ranking
}

/// What does as well within the tolerance, and is not rejected: by its score, or by what it explains
/// where only the price of a further parameter sets it behind.
pub fn equivalents(standing: &Standing) -> Vec<Named> {
    let cause = standing.cause();
    let explained = |h: &Hypothesis| h.gain_fit + h.gain_check;
    let near = |o: &&Hypothesis| {
        o.trial.candidate != cause.trial.candidate
            && o.at_bound.is_none()
            && (o.score >= cause.score - standing.tolerance
                || explained(o) >= explained(cause) - LEAST_NATS)
    };
    standing.ranked.iter().filter(near).map(named).collect()
}

pub fn named(h: &Hypothesis) -> Named {
    Named { effect: h.trial.candidate.name().into(), joints: h.trial.candidate.place.joints() }
}

/// Probability of a cause among its rivals.
pub fn share_of(standing: &Standing) -> f64 {
    let usable = standing.ranked.iter().filter(|o| o.at_bound.is_none());
    let usable: Vec<&Hypothesis> = usable.collect();
    let scores: Vec<f64> = usable.iter().map(|o| o.score).collect();
    let shares = probability::shares(&scores, standing.tolerance);
    let mine = standing.cause().trial.candidate;
    let found = usable.iter().position(|o| o.trial.candidate == mine);
    found.map_or(0.0, |i| shares[i])
}
