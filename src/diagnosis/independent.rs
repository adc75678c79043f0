//! How much of the rows is independent, and the level at which intervals hold.

use super::fit::Fit;
use crate::statistics::effective_samples;

/// Confidence level of the intervals.
pub const LEVEL: f64 = 0.9;

/// Share of each joint's rows that is independent in what model and discrepancy leave, over that by which
/// they count already.
pub fn independent(fit: &Fit<'_>) -> Vec<f64> {
    let shares = shares(fit).into_iter().zip(&fit.data.shares);
    shares.map(|(now, counted)| now / counted).collect()
}

/// Share of each joint's rows that is independent in what model and discrepancy leave.
pub fn shares(fit: &Fit<'_>) -> Vec<f64> {
    let share = |rows: Vec<f64>| match rows.len() {
        0 => 1.0,
        n => effective_samples(&rows) / n as f64,
    };
    (0..fit.data.joints()).map(|j| share(fit.innovations(j))).collect()
}
