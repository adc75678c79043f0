//! What comes again with a motion that comes again: it is no further evidence.
//!
//! Excitation of arms is periodic as a rule (Swevers, Ganseman, Tukel, De Schutter and Van Brussel, "Optimal robot
//! excitation and identification", IEEE Trans. Robotics and Automation 13(5), 1997). Noise is another in every cycle; what a
//! model lacks is the same in all of them.

/// A motion that comes again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// After so many slots.
    pub slots: usize,
    /// So many cycles are recorded, the last one perhaps in part.
    pub count: f64,
}

impl Cycle {
    /// How many times over rows at these slots (rising) count that have these values.
    pub fn design_effect(&self, slots: &[usize], values: &[f64]) -> f64 {
        design_effect(values, &pairs(slots, self.slots, 1), self.count)
    }
}

/// Places in `rows` (sample numbers, rising, `every` of them apart) that are a cycle of `lag` samples apart.
pub fn pairs(rows: &[usize], lag: usize, every: usize) -> Vec<[usize; 2]> {
    let next = |(i, k): (usize, &usize)| {
        let near = rows.partition_point(|row| 2 * row + every < 2 * (k + lag));
        let there = rows.get(near).is_some_and(|row| 2 * row <= 2 * (k + lag) + every);
        there.then_some([i, near])
    };
    rows.iter().enumerate().filter_map(next).collect()
}

/// How many times over rows count whose values come again with the motion: 1 + (m - 1) r, where so many cycles m are
/// correlated by r (the design effect of clusters: Kish, Survey Sampling, 1965, section 5.4).
pub fn design_effect(values: &[f64], pairs: &[[usize; 2]], cycles: f64) -> f64 {
    let sum = |of: &dyn Fn([f64; 2]) -> f64| -> f64 {
        pairs.iter().map(|pair| of(pair.map(|i| values[i]))).sum()
    };
    let scale = (sum(&|[a, _]| a * a) * sum(&|[_, b]| b * b)).sqrt();
    let alike = sum(&|[a, b]| a * b) / scale.max(f64::MIN_POSITIVE);
    1.0 + (cycles - 1.0) * alike.max(0.0)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Five cycles of 300 rows, every third sample: `own` of each row's square is its own, the rest comes again.
    fn cycles(own: f64) -> f64 {
        let rows: Vec<usize> = (0..1500).map(|i| 3 * i).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut noise =
            |n: usize| -> Vec<f64> { (0..n).map(|_| StandardNormal.sample(&mut rng)).collect() };
        let (each, again) = (noise(1500), noise(300));
        let value = |i: usize| own.sqrt() * each[i] + (1.0 - own).sqrt() * again[i % 300];
        let values: Vec<f64> = (0..1500).map(value).collect();
        design_effect(&values, &pairs(&rows, 901, 3), 5.0)
    }

    #[test]
    fn what_comes_again_counts_once() {
        assert!((cycles(0.0) - 5.0).abs() < 1e-9);
        assert!((cycles(0.5) - 3.0).abs() < 0.3);
        assert!((cycles(1.0) - 1.0).abs() < 0.3);
    }

    #[test]
    fn rows_that_have_none_a_cycle_later_have_no_pair() {
        assert_eq!(pairs(&[0, 2, 4, 10, 14], 10, 2), [[0, 3], [2, 4]]);
    }
}
