//! The filter that makes autoregressive noise white.

use std::ops::Range;

use super::{Autoregression, contiguous};

/// One-step prediction errors sum_i a_i e_{t-i}, scaled to equal variance. The first rows of a
/// contiguous stretch are predicted from as many as there are (Durbin and Levinson's predictors of
/// every order), so the sum of squares is the exponent of the exact Gaussian likelihood and
/// nothing is joined across a gap. Brockwell and Davis, Time Series: Theory and Methods, sections
/// 5.2 and 8.7.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitening {
    /// Scaled a_0 .. a_m of order m = 0 .. p.
    predictors: Vec<Vec<f64>>,
    stretches: Vec<Range<usize>>,
}

impl Whitening {
    /// For rows taken at `slots` (see [`contiguous`]).
    pub fn new(model: &Autoregression, slots: &[usize]) -> Self {
        let gamma = model.autocovariance(model.order());
        let predictor = |order: usize| {
            let of_order = Autoregression::from_autocovariance(&gamma[..=order]);
            let scale = (model.innovation() / of_order.innovation()).sqrt();
            of_order.coefficients.iter().map(|a| scale * a).collect()
        };
        Self { predictors: (0..gamma.len()).map(predictor).collect(), stretches: contiguous(slots) }
    }

    /// Linear, one value per row.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut white = Vec::with_capacity(x.len());
        for stretch in &self.stretches {
            let x = &x[stretch.clone()];
            for t in 0..x.len() {
                let a = &self.predictors[t.min(self.predictors.len() - 1)];
                let past = x[t + 1 - a.len()..=t].iter().rev();
                white.push(a.iter().zip(past).map(|(a, e)| a * e).sum());
            }
        }
        white
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// e' Gamma^-1 e by brute force, Gamma the covariance of the rows within each stretch.
    #[test]
    fn the_sum_of_squares_is_the_exact_gaussian_exponent() {
        let gamma = [2.0, 1.1, 0.3];
        let model = Autoregression::from_autocovariance(&gamma);
        let slots = [3, 4, 5, 6, 20, 30, 31, 32];
        let e = [0.3, -1.0, 0.7, 0.2, 1.4, -0.5, -0.1, 0.9];
        let all = model.autocovariance(10);
        let stretch = |i: usize| contiguous(&slots).iter().position(|r| r.contains(&i));
        let covariance = DMatrix::from_fn(8, 8, |i, j| match stretch(i) == stretch(j) {
            true => all[slots[i].abs_diff(slots[j])],
            false => 0.0,
        });
        let vector = DVector::from_column_slice(&e);
        let inverse = covariance.try_inverse().unwrap();
        let exponent = (vector.transpose() * inverse * &vector)[0];
        let white = Whitening::new(&model, &slots).apply(&e);
        let sum: f64 = white.iter().map(|w| w * w).sum::<f64>() / model.innovation();
        assert!((sum / exponent - 1.0).abs() < 1e-12, "{sum} {exponent}");
    }
}
