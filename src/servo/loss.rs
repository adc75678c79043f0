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

/// u and the square root of rho''/2 there, so that least squares of the first over columns times the second have the covariance
/// of an M-estimate, A^-1 B A^-1: A sums rho''/2 and B is of rho'/2 (Huber, *Robust estimation of a location parameter*, Ann. Math.
/// Stat. 35, 1964). Errors that are all of one size, as those of rounding are, tell its values less well than their squares would.
pub fn linearised(u: f64) -> (f64, f64) {
    let root = u.hypot(1.0).sqrt();
    (u * root, root.powi(-3))
}

/// Square root of the weight of u in iteratively reweighted least squares, (rho'(u) / 2u)^(1/2).
pub fn root_weight(u: f64) -> f64 {
    u.hypot(1.0).sqrt().recip()
}

#[cfg(test)]
mod tests {
    use super::*;

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

    /// Normal equations of the loss: its second derivative over columns, and its first.
    #[test]
    fn linearised_has_the_slope_and_the_curvature_of_the_loss() {
        let pull = |u: f64| residual(u) * slope(residual(u));
        for u in [-3.0, -0.5, 0.0, 0.2, 2.0] {
            let (error, column) = linearised(u);
            assert!((error * column - pull(u)).abs() < 1e-12, "{u}");
            let curvature = (pull(u + 1e-5) - pull(u - 1e-5)) / 2e-5;
            assert!((column.powi(2) - curvature).abs() < 1e-8, "{u}");
        }
    }

    #[test]
    fn the_slope_is_that_of_differences() {
        for u in [-30.0, -1.0, 0.0, 0.2, 5.0] {
            let by_difference = (residual(u + 1e-6) - residual(u - 1e-6)) / 2e-6;
            assert!((slope(residual(u)) - by_difference).abs() < 1e-8, "{u}");
        }
    }
}
