//! What a trial is drawn by.

use serde::Serialize;

use super::nuisance::{CENTRE_ERROR_M, MASS_ERROR};
use crate::diagnosis::Settings;

/// What to draw.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Draw {
    pub cases: usize,
    pub seed: u64,
    /// Kinds or effects, by name; empty is all.
    pub only: Vec<String>,
    /// Link masses and centres off, coloured noise, skewed channels.
    pub nuisance: bool,
    /// Length of the fit and of the check recording, s.
    pub duration_s: f64,
    /// What the answerer is told.
    pub settings: Settings,
}

impl Draw {
    /// `cases` of one family; the answerer is told how well link masses are known.
    pub fn new(cases: usize, seed: u64, nuisance: bool) -> Self {
        let known = |error| if nuisance { error } else { 0.0 };
        Self {
            cases,
            seed,
            only: Vec::new(),
            nuisance,
            duration_s: 48.0,
            settings: Settings {
                mass_error: known(MASS_ERROR),
                centre_error_m: known(CENTRE_ERROR_M),
                ..Settings::default()
            },
        }
    }
}
