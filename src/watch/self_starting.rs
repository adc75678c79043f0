//! Whitening that needs no learning period: standardised recursive residuals.
//!
//! A feature x of block n is predicted from the one before by what all blocks before it say,
//! x_n = a + b x_{n-1} + e. With z_n = (1, x_{n-1}), the recursive residual
//! w_n = (x_n - z_n' beta_{n-1}) / sqrt(1 + z_n' (Z'Z)^-1 z_n) (Brown, Durbin and Evans, "Techniques for
//! testing the constancy of regression relationships over time", J. R. Statist. Soc. B 37, 1975) is
//! independent of those before, and w_n / s_{n-1} has Student's distribution; through it and the normal
//! quantile becomes a standard normal number, however few blocks there were (Hawkins, "Self-starting
//! CUSUM charts for location and scale", The Statistician 36, 1987). So a false-alarm rate holds from
//! the first number on, without taking estimates for the truth.

use crate::statistics::{normal_quantile, student_two_sided};

/// Blocks that only teach.
const FEWEST: f64 = 12.0;
/// A block teaches as if it were at most so many standard deviations off.
const TEACHES: f64 = 3.0;
/// No number is farther out: one wild block is no change.
pub const FARTHEST: f64 = 4.0;

/// One feature's regression on its own past.
#[derive(Debug, Clone, Copy, Default)]
pub struct SelfStarting {
    before: Option<f64>,
    blocks: f64,
    /// Centre and scale that keep sums well conditioned: the first value.
    origin: f64,
    /// Sums over blocks: 1, x_{n-1}, x_{n-1}^2; x_n, x_{n-1} x_n; squared recursive residuals.
    z: [f64; 3],
    zx: [f64; 2],
    squares: f64,
}

impl SelfStarting {
    /// A standard normal number where nothing changed; `None` while too little is known.
    pub fn add(&mut self, x: f64) -> Option<f64> {
        let Some(before) = self.before else {
            self.origin = x;
            self.before = Some(0.0);
            return None;
        };
        let x = x - self.origin;
        let predicted = self.predicted(before);
        let taught =
            predicted.as_ref().map_or(x, |p| p.mean + (x - p.mean).clamp(-p.reach(), p.reach()));
        self.before = Some(taught);
        self.teach(before, taught, predicted.as_ref());
        let p = predicted.filter(|p| self.blocks > FEWEST && p.spread > 0.0)?;
        Some(normal((x - p.mean) / (p.width * p.spread), p.freedom))
    }

    fn teach(&mut self, before: f64, x: f64, predicted: Option<&Predicted>) {
        if let Some(p) = predicted {
            self.squares += ((x - p.mean) / p.width).powi(2);
        }
        self.z[0] += 1.0;
        self.z[1] += before;
        self.z[2] += before * before;
        self.zx[0] += x;
        self.zx[1] += before * x;
        self.blocks += 1.0;
    }

    fn predicted(&self, before: f64) -> Option<Predicted> {
        let [n, s, ss] = self.z;
        let det = n * ss - s * s;
        // Blocks without any spread tell nothing.
        if n < 3.0 || det <= 1e-12 * n * ss {
            return None;
        }
        let [p, q] = self.zx;
        let (a, b) = ((ss * p - s * q) / det, (n * q - s * p) / det);
        let leverage = (ss - 2.0 * s * before + n * before * before) / det;
        let (freedom, width) = (n - 2.0, (1.0 + leverage).sqrt());
        let spread = (self.squares / freedom).sqrt();
        Some(Predicted {
            mean: a + b * before,
            width,
            spread,
            freedom,
            known: self.blocks >= FEWEST,
        })
    }
}

/// What all blocks before say of the next.
struct Predicted {
    mean: f64,
    /// Standard deviation of what is predicted, in units of `spread`.
    width: f64,
    spread: f64,
    freedom: f64,
    known: bool,
}

impl Predicted {
    /// How far from the mean a block teaches at most: a change must not become the usual before it is told.
    fn reach(&self) -> f64 {
        if self.known { TEACHES * self.width * self.spread } else { f64::INFINITY }
    }
}

/// The standard normal number as far out as `t` is in Student's distribution.
fn normal(t: f64, freedom: f64) -> f64 {
    let both_tails = student_two_sided(t, freedom).p;
    let far = if both_tails > 0.0 { normal_quantile(both_tails) } else { FARTHEST };
    far.clamp(0.0, FARTHEST).copysign(t)
}
