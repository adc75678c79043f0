//! What an answer rests on, and what is added to it where that is positions.

use serde::{Deserialize, Serialize};

use crate::statistics::normal_quantile;

/// What the answer rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// Recorded torque.
    #[default]
    Torque,
    /// Position servos: command and position.
    Simulation,
}

impl By {
    /// One line for people.
    pub fn line(self) -> &'static str {
        match self {
            By::Torque => "method: by torque, inverse dynamics of the recorded motion",
            By::Simulation => {
                "method: by simulation, from the recorded command to the position (--by torque takes \
                 recorded torque)"
            }
        }
    }
}

/// Errors of the simulated position on the check recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Position {
    pub before_rad: f64,
    pub after_rad: f64,
    /// 1 - after^2 / before^2.
    pub fraction: f64,
    pub cross_validated: CrossValidated,
    /// How many times wider intervals are than errors of the fits say: as many times as what each recording says by itself differs
    /// from the other more than those do (Birge, Phys. Rev. 40, 1932); 1 where it does not.
    #[serde(default = "as_they_are")]
    pub birge_ratio: f64,
    /// Of the check recording beside the fit recording; none where one joint alone would tell it.
    #[serde(default)]
    pub time_offset: Option<TimeOffset>,
    /// Step of the simulation along the check recording, s; none in answers that do not say it.
    #[serde(default)]
    pub step_s: Option<f64>,
    pub joints: Vec<JointPositionShrink>,
    /// What each cause takes off when it is added to all the others.
    pub causes: Vec<PositionShrink>,
}

fn as_they_are() -> f64 {
    1.0
}

/// By how much later commands of one recording were sent beside positions than those of another: what loggers note in one row is
/// not of one instant. The twin is led along that recording with its commands so much later.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TimeOffset {
    /// s; below zero where they were sent earlier.
    pub late_s: f64,
    /// s; at most about a row, which is what is expected of loggers.
    pub standard_error_s: f64,
}

/// Probability that an interval holds the offset: recordings whose interval holds none surely differ.
const LEVEL: f64 = 0.9;

impl TimeOffset {
    /// What it says to people of a recording beside another, where both surely differ.
    pub fn line(&self, recording: &str, other: &str) -> Option<String> {
        if self.late_s.abs() <= normal_quantile(1.0 - LEVEL) * self.standard_error_s {
            return None;
        }
        let [late, error] = [self.late_s.abs(), self.standard_error_s].map(|s| 1e3 * s);
        let way = if self.late_s > 0.0 { "later" } else { "earlier" };
        Some(format!(
            "Commands of {recording} were sent {late:.2} +- {error:.2} ms {way} beside positions than those of {other}, at \
             all joints: what a logger notes in one row is not of one instant. The twin is led along them as they were sent."
        ))
    }
}

/// Mean size of the position error over all joints of both recordings (cross-validation in two folds): each twin was fitted to every
/// other stretch of both, and its error counts in the stretches between, which tell only what the twin leaves open. Causes are
/// decided by it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CrossValidated {
    pub before_rad: f64,
    pub after_rad: f64,
}

impl CrossValidated {
    /// Share of the size that is taken off.
    pub fn fraction(&self) -> f64 {
        if self.before_rad > 0.0 { 1.0 - self.after_rad / self.before_rad } else { 0.0 }
    }
}

/// Root mean square over joints of the simulated position's error on the check recording, without a cause and
/// with it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PositionShrink {
    pub effect: String,
    pub joints: Vec<usize>,
    /// `None` where the arm runs away without it.
    pub before_rad: Option<f64>,
    pub after_rad: f64,
    /// 1 - after^2 / before^2.
    pub fraction: f64,
}

/// Errors at one joint, with what the encoder's steps alone leave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct JointPositionShrink {
    /// From 1 at the base.
    pub joint: usize,
    pub before_rad: f64,
    pub after_rad: f64,
    pub rounding_rad: f64,
}
