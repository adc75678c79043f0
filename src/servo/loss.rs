//! What an error counts in a fit: its square where it is small against what is usual of its joint, its size beyond
//! (pseudo-Huber loss). What stops an arm for a moment, which nothing here simulates, would decide a sum of squares.
//!
//! rho(u) = 2 (sqrt(1 + u^2) - 1), written as the square of a residual (Triggs, McLauchlan, Hartley and Fitzgibbon, *Bundle
//! adjustment - a modern synthesis*, 2000, section 4.3), so that a minimiser of sums of squares minimises it.

/// sign(u) sqrt(rho(u)), for an error u in units of what is usual.
pub fn residual(u: f64) -> f64 {
    match u.is_finite() {
        true => u * (2.0 / (1.0 + u.hypot(1.0))).sqrt(),
        false => u,
    }
}

/// d residual / du, where the residual is `r`.
pub fn slope(r: f64) -> f64 {
    let s = 1.0 + 0.5 * r * r;
    if s.is_finite() { (0.5 * (1.0 + s)).sqrt() / s } else { 0.0 }
}

/// Errors that least squares have at values fitted by this loss: rho'/2 over the mean of rho''/2, so that their covariance is that of
/// an M-estimate (Huber, *Robust regression: asymptotics, conjectures and Monte Carlo*, Ann. Stat. 1, 1973). Errors that are all
/// of one size, as those of rounding are, tell values less well by their sizes than by their squares.
pub fn as_squares(u: &[f64]) -> Vec<f64> {
    let bend = |u: &f64| u.hypot(1.0).powi(-3);
    let mean = u.iter().map(bend).sum::<f64>() / u.len().max(1) as f64;
    u.iter().map(|u| u / u.hypot(1.0) / mean).collect()
}

/// Square root of the weight of u in iteratively reweighted least squares, (rho'(u) / 2u)^(1/2).
pub fn root_weight(u: f64) -> f64 {
    u.hypot(1.0).sqrt().recip()
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::statistics::infer;

    #[test]
    fn small_errors_count_by_their_square_large_ones_by_their_size() {
        assert!((residual(1e-3) / 1e-3 - 1.0).abs() < 1e-6);
        assert!((residual(-1e6).powi(2) / 2e6 - 1.0).abs() < 1e-5);
        assert!((residual(3.0).powi(2) - 2.0 * (10f64.sqrt() - 1.0)).abs() < 1e-12);
        assert_eq!(residual(f64::INFINITY), f64::INFINITY);
    }

    /// Its square pulls at a small change of u as the loss does.
    #[test]
    fn the_weight_is_that_of_the_slope() {
        for u in [-30.0, -1.0, 0.2, 5.0] {
            let pull = residual(u) * slope(residual(u));
            assert!((root_weight(u).powi(2) * u - pull).abs() < 1e-12, "{u}");
        }
    }

    /// Small errors are what they are; of large ones the side counts.
    #[test]
    fn errors_as_squares_have_them() {
        let small = as_squares(&[1e-3, -2e-3]);
        assert!((small[0] / 1e-3 - 1.0).abs() < 1e-4 && (small[1] / -2e-3 - 1.0).abs() < 1e-4);
        let large = as_squares(&[3.0, 300.0, -300.0]);
        assert!((large[1] / large[0] - 1.054).abs() < 1e-3, "{large:?}");
        assert_eq!(large[1], -large[2]);
    }

    /// A value fitted by this loss to errors of rounding: its intervals hold it as often as they should, those of a sum of
    /// squares do not.
    #[test]
    fn intervals_are_those_of_the_loss_that_was_fitted() {
        const DRAWS: usize = 400;
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (x, slots): (Vec<f64>, Vec<usize>) =
            (0..400).map(|k| ((0.3 * f64::from(k)).sin(), k as usize)).unzip();
        let [mut by_loss, mut by_squares] = [0, 0];
        for _ in 0..DRAWS {
            let noise: Vec<f64> = x.iter().map(|_| rng.random_range(-2.0..2.0)).collect();
            let off = |value: f64| x.iter().zip(&noise).map(move |(x, n)| n - value * x);
            let value = (0..100).fold(0.0, |value: f64, _| {
                let each = || off(value).map(|u| (u, root_weight(u).powi(2))).zip(&x);
                let pull: f64 = each().map(|((u, w), x)| w * u * x).sum();
                value + pull / each().map(|((_, w), x)| w * x * x).sum::<f64>()
            });
            let holds = |error: &[f64]| {
                let column = DMatrix::from_column_slice(x.len(), 1, &x);
                let found = infer(&[value], &[0.0], &column, error, &slots, None, 0.9).unwrap();
                usize::from(found.robust[0].low < 0.0 && 0.0 < found.robust[0].high)
            };
            let errors: Vec<f64> = off(value).collect();
            by_loss += holds(&as_squares(&errors));
            by_squares += holds(&errors);
        }
        let share = |holds: usize| holds as f64 / DRAWS as f64;
        assert!((0.87..0.95).contains(&share(by_loss)), "{}", share(by_loss));
        assert!(share(by_squares) < 0.85, "{}", share(by_squares));
    }

    #[test]
    fn the_slope_is_that_of_differences() {
        for u in [-30.0, -1.0, 0.0, 0.2, 5.0] {
            let by_difference = (residual(u + 1e-6) - residual(u - 1e-6)) / 2e-6;
            assert!((slope(residual(u)) - by_difference).abs() < 1e-8, "{u}");
        }
    }
}
