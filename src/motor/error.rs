//! What a study of the motor can fail at, and how far an estimate is off.

use super::simulate::Failure;
use crate::statistics::StatisticsError;

#[derive(Debug, thiserror::Error)]
pub enum MotorError {
    #[error("the true motor cannot be simulated: {0}")]
    Truth(Failure),
    #[error("no motor within the bounds can be simulated: narrow the bounds of the viscous terms")]
    NothingFits,
    #[error("the estimate cannot be analysed: {0}")]
    Statistics(#[from] StatisticsError),
}

/// Error relative to the truth, %; none where that is zero.
pub(super) fn error_percent(value: f64, truth: f64) -> Option<f64> {
    (truth != 0.0).then(|| 100.0 * (value / truth - 1.0))
}
