//! A Kalman filter whose states decay on their own and are measured one number at a time.
//!
//! x(k+1) = diag(a) x(k) + w, w ~ N(0, diag(g)); r = h^T x + v (Bar-Shalom, Li, Kirubarajan,
//! *Estimation with Applications to Tracking and Navigation*, 2001, section 5.2). What is new in r is
//! taken for Student's t, with the variance that a normal v gives it: friction jumps more often than a
//! normal distribution knows, and a jump must neither count as proof nor move the states as far
//! (Roth, Ozkan, Gustafsson, ICASSP 2013).

use nalgebra::{DMatrix, DVector};

/// Degrees of freedom of what is new: beyond four standard deviations once in some hundred steps.
const FREEDOM: f64 = 8.0;
/// ln Gamma((nu + 1) / 2) - ln Gamma(nu / 2) - ln(nu pi) / 2 for these.
const LN_NORMALISED: f64 = -0.950_108_612_150_230_7;

/// Mean and covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    pub x: DVector<f64>,
    pub p: DMatrix<f64>,
}

impl Belief {
    /// x ~ N(0, diag(variance)).
    pub fn new(variance: &[f64]) -> Self {
        let variance = DVector::from_column_slice(variance);
        Self { x: DVector::zeros(variance.len()), p: DMatrix::from_diagonal(&variance) }
    }

    /// One step on: every state keeps `decay` of itself and gains `grow` in variance.
    pub fn predict(&mut self, decay: &[f64], grow: &[f64]) {
        for (j, mut column) in self.p.column_iter_mut().enumerate() {
            let both = column.iter_mut().zip(decay);
            both.for_each(|(p, a)| *p *= a * decay[j]);
            column[j] += grow[j];
        }
        self.x.iter_mut().zip(decay).for_each(|(x, a)| *x *= a);
    }

    /// Learns from r = h^T x + v; the log-likelihood of r before it was known.
    pub fn update(&mut self, h: &DVector<f64>, r: f64, variance: f64) -> f64 {
        let ph = &self.p * h;
        let s = h.dot(&ph) + variance;
        let e = r - h.dot(&self.x);
        let (off, nu) = (e * e / s, FREEDOM);
        let log_likelihood = LN_NORMALISED - 0.5 * (s.ln() + (nu + 1.0) * (off / nu).ln_1p());
        let s = s * ((nu + off) / (nu + 1.0)).max(1.0);
        self.x.axpy(e / s, &ph, 1.0);
        self.p.ger(-1.0 / s, &ph, &ph, 1.0);
        log_likelihood
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DENSITY_AT_1: f64 = 0.227_607_580_145_303_1;

    /// x ~ N(0, 4), r = x + v, var v = 1: x | r ~ N(0.8 r, 0.8); r / sqrt(5) = 1 has the density
    /// 0.2276 of Student's t with 8 degrees of freedom (scipy.stats.t.pdf(1, 8)).
    #[test]
    fn one_measurement_weighs_prior_and_noise() {
        let mut belief = Belief::new(&[4.0]);
        let root: f64 = 5f64.sqrt();
        let gained = belief.update(&DVector::from_element(1, 1.0), root, 1.0);
        assert!((belief.x[0] - 0.8 * root).abs() < 1e-12, "{belief:?}");
        assert!((belief.p[(0, 0)] - 0.8).abs() < 1e-12, "{belief:?}");
        let expected = DENSITY_AT_1 / root;
        assert!((gained.exp() / expected - 1.0).abs() < 1e-6, "{} {expected}", gained.exp());
    }

    #[test]
    fn a_jump_moves_the_state_by_less_than_its_share() {
        let mut belief = Belief::new(&[4.0]);
        belief.update(&DVector::from_element(1, 1.0), 50.0, 1.0);
        assert!(belief.x[0] < 0.1 * 50.0 && belief.p[(0, 0)] > 0.8, "{belief:?}");
    }

    /// A state with decay a and growth 1 - a^2 keeps the variance 1.
    #[test]
    fn what_decays_and_grows_alike_stays_as_uncertain() {
        let mut belief = Belief::new(&[1.0, 1.0]);
        for _ in 0..100 {
            belief.predict(&[0.9, 0.0], &[1.0 - 0.81, 1.0]);
        }
        assert!((&belief.p - DMatrix::identity(2, 2)).norm() < 1e-12);
    }
}
