//! Boxes that a search stays in.

use thiserror::Error;

/// lower <= x <= upper, parameter by parameter; checked when made.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Bounds {
    lower: Vec<f64>,
    upper: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Error)]
pub enum BoundsError {
    #[error("{lower} lower bounds but {upper} upper bounds")]
    Lengths { lower: usize, upper: usize },
    #[error("bounds of {name} are the wrong way round: {lower} .. {upper}; give MIN:MAX")]
    WrongWayRound { name: String, lower: f64, upper: f64 },
}

impl Bounds {
    /// # Errors
    /// If the lengths differ, or a lower bound is not below its upper bound (NaN included).
    pub fn new(lower: Vec<f64>, upper: Vec<f64>) -> Result<Self, BoundsError> {
        if lower.len() != upper.len() {
            return Err(BoundsError::Lengths { lower: lower.len(), upper: upper.len() });
        }
        for (i, (&l, &u)) in lower.iter().zip(&upper).enumerate() {
            check(&format!("parameter {}", i + 1), l, u)?;
        }
        Ok(Self { lower, upper })
    }

    /// No bounds at all.
    pub fn unbounded(n: usize) -> Self {
        Self { lower: vec![f64::NEG_INFINITY; n], upper: vec![f64::INFINITY; n] }
    }

    pub fn len(&self) -> usize {
        self.lower.len()
    }

    pub fn is_empty(&self) -> bool {
        self.lower.is_empty()
    }

    pub fn lower(&self, i: usize) -> f64 {
        self.lower[i]
    }

    pub fn upper(&self, i: usize) -> f64 {
        self.upper[i]
    }

    pub fn span(&self, i: usize) -> f64 {
        self.upper[i] - self.lower[i]
    }

    pub fn clamp(&self, i: usize, x: f64) -> f64 {
        x.clamp(self.lower[i], self.upper[i])
    }

    pub fn contain(&self, x: &[f64]) -> bool {
        let inside = |(i, &x): (usize, &f64)| self.lower[i] <= x && x <= self.upper[i];
        x.iter().enumerate().all(inside)
    }

    /// Within a millionth of the span of either end.
    pub fn reached(&self, i: usize, x: f64) -> bool {
        let near = if self.span(i).is_finite() { 1e-6 * self.span(i) } else { 0.0 };
        x <= self.lower[i] + near || x >= self.upper[i] - near
    }
}

/// # Errors
/// If `lower` is not below `upper`.
pub fn check(name: &str, lower: f64, upper: f64) -> Result<(), BoundsError> {
    if lower < upper {
        return Ok(());
    }
    Err(BoundsError::WrongWayRound { name: name.into(), lower, upper })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_the_wrong_way_round_are_refused_by_name() {
        let error = Bounds::new(vec![0.0, 2.0], vec![1.0, 1.0]).unwrap_err();
        assert!(error.to_string().contains("parameter 2"), "{error}");
        assert!(Bounds::new(vec![f64::NAN], vec![1.0]).is_err());
        assert!(Bounds::new(vec![0.0], vec![]).is_err());
    }

    #[test]
    fn a_bound_is_reached_at_either_end_only() {
        let b = Bounds::new(vec![0.0], vec![10.0]).unwrap();
        assert!(b.reached(0, 0.0) && b.reached(0, 10.0 - 1e-9));
        assert!(!b.reached(0, 1e-4));
        assert!(!Bounds::unbounded(1).reached(0, 1e300));
    }
}
