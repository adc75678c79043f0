//! What a trial is drawn by.

use serde::Serialize;

use super::nuisance::{CENTRE_ERROR_M, MASS_ERROR};
use crate::diagnosis::Settings;

/// Arms that cases are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// A UR5 whose currents are recorded; its link masses are known, its noise is white.
    #[default]
    Standard,
    /// The standard arm with link masses and centres off, coloured noise, skewed channels.
    Nuisance,
    /// Six small position servos: command and position are recorded, no torque.
    Servos,
}

impl Family {
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Nuisance => "nuisance",
            Self::Servos => "servos",
        }
    }
}

/// What to draw.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Draw {
    pub cases: usize,
    pub seed: u64,
    /// Kinds or effects, by name; empty is all.
    pub only: Vec<String>,
    pub family: Family,
    /// Length of the fit and of the check recording, s.
    pub duration_s: f64,
    /// What the answerer is told.
    pub settings: Settings,
}

impl Draw {
    /// `cases` of one family; the answerer is told how well link masses are known.
    pub fn new(cases: usize, seed: u64, family: Family) -> Self {
        let known = |error| if family == Family::Nuisance { error } else { 0.0 };
        Self {
            cases,
            seed,
            only: Vec::new(),
            family,
            duration_s: 48.0,
            settings: Settings {
                mass_error: known(MASS_ERROR),
                centre_error_m: known(CENTRE_ERROR_M),
                ..Settings::default()
            },
        }
    }
}
