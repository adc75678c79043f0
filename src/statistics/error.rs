//! What can be wrong with the numbers a test is asked for.

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StatisticsError {
    #[error(
        "{rows} samples cannot determine {parameters} parameters with intervals: record longer, \
         widen the mask or fit fewer parameters"
    )]
    TooFewRows { rows: usize, parameters: usize },
    #[error("{what} at row {row} is not finite")]
    NotFinite { what: &'static str, row: usize },
    #[error("{what} has {found} entries where {expected} belong")]
    Length { what: &'static str, found: usize, expected: usize },
    #[error("row times must increase: row {row} does not lie after its predecessor")]
    Order { row: usize },
    #[error("a confidence level of {level} is not between 0 and 1")]
    Level { level: f64 },
}
