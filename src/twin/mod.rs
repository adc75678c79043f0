//! A twin: an arm, its drive, and the effects its owner already models.

use std::collections::BTreeMap;

use crate::robot::{Drive, Robot};

/// What is known about the arm before a recording is seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Twin {
    pub robot: Robot,
    pub drive: Drive,
    /// Names from the catalogue.
    pub effects: Vec<String>,
    /// Values that are known, by parameter name, one per joint (one in all for the whole arm);
    /// what is absent is fitted.
    pub values: BTreeMap<String, Vec<f64>>,
}
