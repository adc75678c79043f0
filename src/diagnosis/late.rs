//! A torque that is recorded late shows the arbitrary torque of a standing joint when it already
//! slides again: rows that near standstill say nothing then.

use super::model::Fit;
use crate::effects::{Effect, find};
use crate::signals::Samples;

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

/// The recordings without what is too near to standstill for this delay, where they hold such.
pub fn away_from_standstill(recordings: &[Samples; 2], delay_s: f64) -> Option<[Samples; 2]> {
    let guard_s = LONGER * delay_s;
    let rows = |seconds: f64, samples: &Samples| (seconds / samples.dt).round() as usize;
    let near = recordings.iter().any(|r| rows(r.conditioning.guard_s, r) < rows(guard_s, r));
    near.then(|| {
        recordings.clone().map(|mut samples| {
            samples.conditioning.guard_s = samples.conditioning.guard_s.max(guard_s);
            samples
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::testing::samples;

    #[test]
    fn a_late_torque_leaves_out_as_much_beside_standstill_and_a_slight_delay_nothing() {
        let recordings = [(); 2].map(|()| samples(1, 200, |_, t| t));
        let before = recordings[0].conditioning.guard_s;
        let wide = away_from_standstill(&recordings, 0.2).unwrap();
        assert!(wide.iter().all(|r| (r.conditioning.guard_s - 0.3).abs() < 1e-12));
        assert!(away_from_standstill(&recordings, 0.5 * before).is_none());
        assert!(away_from_standstill(&recordings, 0.0).is_none());
    }
}
