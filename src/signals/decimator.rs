//! The zero-phase low-pass worked out where its output is used, and nowhere else.

use super::LowPass;
use crate::kernels::dot;

/// Share of the largest response: smaller ones are left off.
const NEGLIGIBLE: f64 = 1e-9;
/// Half the samples an impulse is followed for.
const LONGEST: usize = 4000;

/// [`LowPass`] as a convolution with its response to an impulse, which is the same in both
/// directions of time. Rows of a regression are few beside samples, and each costs one dot product.
#[derive(Debug, Clone, PartialEq)]
pub struct Decimator {
    /// Response to an impulse, from `reach` samples before it to `reach` after.
    response: Vec<f64>,
    reach: usize,
}

impl Decimator {
    pub fn new(filter: &LowPass) -> Self {
        let mut response = vec![0.0; 2 * LONGEST + 1];
        response[LONGEST] = 1.0;
        filter.apply(&mut response);
        let least = NEGLIGIBLE * response[LONGEST].abs();
        let first = response.iter().position(|r| r.abs() > least).unwrap_or(LONGEST);
        let reach = LONGEST - first;
        Self { response: response[first..=LONGEST + reach].to_vec(), reach }
    }

    /// The filtered series at `rows` (indices of samples), one value each; its ends are continued by
    /// odd reflection.
    pub fn at(&self, rows: &[usize], series: &[f64]) -> Vec<f64> {
        let Some(last) = series.len().checked_sub(1) else { return Vec::new() };
        let at = |&k: &usize| match k >= self.reach && k + self.reach <= last {
            true => dot(&self.response, &series[k - self.reach..=k + self.reach]),
            false => dot(&self.response, &self.around_end(k, series)),
        };
        rows.iter().map(at).collect()
    }

    /// What the response sees around sample `k`, near an end of the series.
    fn around_end(&self, k: usize, series: &[f64]) -> Vec<f64> {
        let last = series.len() - 1;
        let reflected = |from: usize, to: usize| 2.0 * series[from] - series[to];
        let before = (1..=self.reach - self.reach.min(k)).rev();
        let before = before.map(|i| reflected(0, i.min(last)));
        let inside = &series[k.saturating_sub(self.reach)..=last.min(k + self.reach)];
        let after = 1..=(k + self.reach).saturating_sub(last);
        let after = after.map(|i| reflected(last, last.saturating_sub(i)));
        before.chain(inside.iter().copied()).chain(after).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_recursive_filter() {
        let x: Vec<f64> = (0..3000).map(|k| (0.01 * (k * k % 7919) as f64).sin() + 3.0).collect();
        let rows: Vec<usize> = (0..3000).step_by(7).collect();
        for (cutoff, order) in [(8.0, 4), (3.0, 2), (40.0, 5)] {
            let filter = LowPass::new(cutoff, 125.0, order).unwrap();
            let mut expected = x.clone();
            filter.apply(&mut expected);
            let found = Decimator::new(&filter).at(&rows, &x);
            for (k, y) in rows.iter().zip(found).filter(|(k, _)| (200..2800).contains(*k)) {
                assert!((y - expected[*k]).abs() < 1e-7, "{cutoff} Hz, {k}: {y} {}", expected[*k]);
            }
        }
    }

    #[test]
    fn short_series_are_filtered_too() {
        let filter = Decimator::new(&LowPass::new(5.0, 100.0, 4).unwrap());
        let found = filter.at(&[0, 1, 2], &[2.0, 2.0, 2.0]);
        assert!(found.iter().all(|y| (y - 2.0).abs() < 1e-6), "{found:?}");
        assert!(filter.at(&[], &[]).is_empty());
    }
}
