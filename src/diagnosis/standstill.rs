//! Rows right beside standstill, and a second pass without them.
//!
//! They tell most of what friction does before it slides. But not all they show is friction's: a
//! torque that is recorded late is still that of the standing joint, and the kink in the speed of a
//! joint that breaks away is rounded off where motion is smoothed.

use super::answer::Named;
use super::conditioning::GUARD_S;
use super::{Found, late};
use crate::signals::Samples;

impl Found {
    /// How much beside standstill has to be left out before this can be believed, s.
    pub(super) fn guard_s(&self) -> f64 {
        let breakaway = if self.outdone.is_some() { GUARD_S } else { 0.0 };
        late::guard_s(self.delay_s.max(self.suspected_s)).max(breakaway)
    }

    /// A pass with fewer rows, where it says what the first could not.
    pub(super) fn in_place_of(mut self, first: Self) -> Self {
        match &first.outdone {
            Some(_) if self.outdone.is_some() || self.answer.causes.is_empty() => first,
            Some(better) => {
                self.reconcile(better);
                self
            }
            None if self.delay_s > 0.0 => self,
            None => first,
        }
    }

    /// What did better with all rows, though it cannot be named, is no worse an explanation.
    fn reconcile(&mut self, better: &Named) {
        let Self { answer, .. } = self;
        for cause in answer.causes.iter_mut().filter(|c| c.joints == better.joints) {
            if cause.effect != better.effect && !cause.equivalent.contains(better) {
                cause.equivalent.push(better.clone());
            }
        }
        answer.notes.push(format!(
            "what lies within {GUARD_S} s of standstill is left out: {} fits it best, but only with \
             values that cannot be",
            better.effect
        ));
    }
}

/// The recordings without what is nearer than `guard_s` to standstill, where they hold such.
pub fn left_out(recordings: &[Samples; 2], guard_s: f64) -> Option<[Samples; 2]> {
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
        let wide = left_out(&recordings, late::guard_s(0.2)).unwrap();
        assert!(wide.iter().all(|r| (r.conditioning.guard_s - 0.3).abs() < 1e-12));
        assert!(left_out(&recordings, late::guard_s(0.5 * before)).is_none());
        assert!(left_out(&recordings, late::guard_s(0.0)).is_none());
    }
}
