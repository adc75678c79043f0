//! The thresholds of an answer.

use serde::{Deserialize, Serialize};

/// What is decided by number, each with a meaning of its own; echoed in every answer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Criteria {
    /// Logarithm of the odds from which a cause is there: 3 is 20 to 1 beside all rivals, the usual
    /// size of a test.
    pub least_nats: f64,
    /// How far a signature can be trusted: 1 / inexact nats are the most that evidence can say, since
    /// no law is the arm's own.
    pub inexact: f64,
    /// Odds within which two names are told in one breath.
    pub equal_odds: f64,
    /// Least share of the mean square left by the other causes on the check recording that a cause must take
    /// off, at the joint where it takes off most.
    pub least_gain: f64,
    /// `least_gain` at a joint that has a discrepancy beside the causes: there no law is exact to less.
    pub least_gain_inexact: f64,
    /// Mean square over that of the noise from which something is left.
    pub above_noise: f64,
    /// Coverage factor (JCGM 100:2008, GUM, section 6.2): what the twin knows to one standard deviation holds within so
    /// many of them, the usual 95 %.
    pub coverage: f64,
    /// Causes looked for, at most: more of them describe rather than explain.
    pub most_causes: usize,
}

impl Default for Criteria {
    fn default() -> Self {
        Self {
            least_nats: 3.0,
            inexact: 1e-3,
            equal_odds: 20.0,
            least_gain: 0.03,
            least_gain_inexact: 0.1,
            above_noise: 1.5,
            coverage: 2.0,
            most_causes: 10,
        }
    }
}

impl Criteria {
    /// Evidence as far as it can be trusted, nats: as it is where it is small, never above
    /// 1 / inexact.
    pub fn trusted(&self, nats: f64) -> f64 {
        nats / (1.0 + self.inexact * nats.abs())
    }

    /// How far behind `nats` another name may be and still be told in the same breath, nats: the odds that tell
    /// nothing; where no law is exact, also as much as a law may be wrong by.
    pub fn margin(&self, nats: f64, exact: bool) -> f64 {
        let wrong_by = if exact { 0.0 } else { self.least_gain_inexact * nats };
        self.equal_odds.ln().max(wrong_by)
    }

    /// Probabilities in proportion to trusted evidence, nats over one and the same state.
    pub fn probabilities(&self, nats: &[f64]) -> Vec<f64> {
        let trusted: Vec<f64> = nats.iter().map(|n| self.trusted(*n)).collect();
        let top = trusted.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let odds: Vec<f64> = trusted.iter().map(|n| (n - top).exp()).collect();
        let sum: f64 = odds.iter().sum();
        odds.into_iter().map(|o| o / sum).collect()
    }
}
