//! What is done with the samples of a simulation while it runs.

use super::dormand_prince::Dense;

/// Takes samples in the order of time.
pub trait Consumer<const N: usize> {
    /// The next sample.
    fn take(&mut self, y: &[f64; N]);

    /// The next `count` samples, at theta = first, first + spacing, .. of one step.
    #[inline]
    fn take_all(&mut self, step: &Dense<N>, first: f64, spacing: f64, count: usize) {
        for k in 0..count {
            self.take(&step.at(first + k as f64 * spacing));
        }
    }

    /// Whether the rest of the simulation may be left out.
    #[inline]
    fn has_enough(&self) -> bool {
        false
    }
}

impl<const N: usize, F: FnMut(&[f64; N])> Consumer<N> for F {
    #[inline]
    fn take(&mut self, y: &[f64; N]) {
        self(y);
    }
}
