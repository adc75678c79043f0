//! A torque that is recorded late shows the arbitrary torque of a standing joint when it already
//! slides again: rows that near standstill say nothing then.

use super::model::Fit;
use super::select::{Round, SURE_NATS};
use crate::effects::{Effect, find};

const EFFECT: &str = "time_delay";
/// Times the delay that is left out beside standstill: the first one found is too short for what
/// standing joints add to it.
const LONGER: f64 = 1.5;

/// How late the torque is by the causes of a fit, s; 0 where none says so.
pub fn delay(fit: &Fit) -> f64 {
    let late = fit.model.causes.iter().enumerate().filter(|(_, t)| t.candidate.name() == EFFECT);
    let place = find(EFFECT).and_then(|effect: &dyn Effect| {
        effect.about().parameters.iter().position(|p| p.name == EFFECT)
    });
    late.filter_map(|(i, _)| fit.values(i).get(place?).copied()).fold(0.0, f64::max)
}

/// The same, s, of what explains the first recording best and fails on the second, as a delay does where
/// the torque of standing joints is taken for that of sliding ones.
pub fn suspected(rounds: &[Round<'_, '_>]) -> f64 {
    let last = rounds.last().filter(|round| round.accepted.is_none());
    let best = last.and_then(|round| round.ranked.first());
    let late = best.filter(|h| h.trial.candidate.name() == EFFECT && h.gain_fit >= SURE_NATS);
    late.and_then(|h| h.trial.nonlinear.first()).copied().unwrap_or(0.0)
}

/// What is left out beside standstill for this delay, s.
pub fn guard_s(delay_s: f64) -> f64 {
    LONGER * delay_s
}
