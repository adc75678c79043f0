//! What makes the data most likely beside the causes of a fit: sizes of what the model leaves out, and what refers to
//! values that are fitted.

use super::fit::{Fit, MOST_PASSES};
use super::sizes::Sizes;
use crate::regression::random_effects::{ENTRIES, Profile, STEPS};

/// Relative difference of a reference from its value that calls for another fit.
pub const INCONSISTENT: f64 = 0.02;

impl Fit<'_> {
    /// The most likely sizes of the discrepancy at `joints` and of what the twin states within limits, the
    /// others as they are.
    pub fn likely_sizes(&self, joints: &[usize]) -> Sizes {
        let within = self.within_likely_tolerances();
        let mut sizes = within.sizes.clone();
        for &j in joints {
            sizes.joints[j] = within.profile(j).best(&sizes.joints[j]).0;
        }
        match sizes == within.sizes {
            true => sizes,
            false => within.beside(sizes).within_likely_tolerances().sizes,
        }
    }

    /// This fit with the tolerances as large as makes the data most likely, by a climb over their grid.
    fn within_likely_tolerances(&self) -> Self {
        let mut best = self.clone();
        if self.data.tolerances.count() == 0 {
            return best;
        }
        let mut top = best.ln_evidence();
        let mut climbs = |step: u8, best: &mut Self| {
            let fit = self.clone().beside(Sizes { tolerances: step, ..self.sizes.clone() });
            let nats = fit.ln_evidence();
            let better = nats > top;
            if better {
                (*best, top) = (fit, nats);
            }
            better
        };
        match self.sizes.tolerances {
            0 if !ENTRIES.iter().any(|step| climbs(*step, &mut best)) => return best,
            1.. if climbs(0, &mut best) => return best,
            _ => {}
        }
        for direction in [-1i8, 1] {
            while let Some(step) = best.sizes.tolerances.checked_add_signed(direction) {
                if step > STEPS || !climbs(step, &mut best) {
                    break;
                }
            }
        }
        best
    }

    fn profile(&self, j: usize) -> Profile<'_> {
        let features = &self.data.features[j];
        let count = self.data.count(j);
        self.normal.profile(features, j, &self.system.x, count, self.data.least(j))
    }

    /// This fit with what refers to values of causes at what these are, where that is more likely.
    pub fn settled(mut self) -> Self {
        for _ in 0..MOST_PASSES {
            let mut model = self.model.clone();
            for (i, cause) in model.causes.iter_mut().enumerate() {
                let linear = &self.system.x.as_slice()[self.model.range(i)];
                cause.candidate.settle(linear, &mut cause.nonlinear);
            }
            let pairs = model.causes.iter().zip(&self.model.causes);
            let values = pairs.flat_map(|(a, b)| a.nonlinear.iter().zip(&b.nonlinear));
            if values.into_iter().all(|(now, was)| (now - was).abs() <= INCONSISTENT * now.abs()) {
                break;
            }
            let next = Self::new(self.data, model, self.sizes.clone());
            if next.ln_evidence() <= self.ln_evidence() {
                break;
            }
            self = next;
        }
        self
    }
}
