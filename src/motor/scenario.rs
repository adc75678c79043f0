//! `scenarios/dc_motor_*.toml`: what is true, what is measured, what is searched for.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::input::Excitation;
use super::model::{COUNT, Motor, NAMES, index, position};
use crate::identification::pso;

/// The two that ship with the program: all terms of Eq. 15, and Eq. 16.
pub const SHIPPED: [&str; 2] = [
    include_str!("../../scenarios/dc_motor_1.toml"),
    include_str!("../../scenarios/dc_motor_2.toml"),
];

#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    #[error("{0}")]
    Toml(#[from] toml::de::Error),
    #[error("[{table}] has no {name}: give all of {}", NAMES.join(", "))]
    Missing { table: &'static str, name: &'static str },
    #[error("[{table}] has an unknown parameter {name}: known are {}", NAMES.join(", "))]
    Unknown { table: &'static str, name: String },
    #[error("[{table}] {key} = {value}: {expected}")]
    Value { table: &'static str, key: String, value: String, expected: &'static str },
    #[error("measured = {0:?}: give omega, or omega and current, each once")]
    Measured(Vec<Channel>),
    #[error("all parameters are given: nothing is left to identify")]
    NothingLeft,
}

/// What can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// rad/s
    Omega,
    /// A
    Current,
}

/// Levenberg-Marquardt from several starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NlseSettings {
    /// Drawn at random within the bounds.
    pub starts: usize,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    scenario: usize,
    title: String,
    measured: Vec<Channel>,
    #[serde(default)]
    given: BTreeMap<String, f64>,
    truth: BTreeMap<String, f64>,
    bounds: BTreeMap<String, [f64; 2]>,
    identification: Excitation,
    verification: Excitation,
    nlse: NlseSettings,
    #[serde(default)]
    pso: pso::Settings,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    pub number: usize,
    pub title: String,
    pub measured: Vec<Channel>,
    /// Known beforehand, by parameter.
    pub given: [Option<f64>; COUNT],
    pub truth: Motor,
    pub bounds: [[f64; 2]; COUNT],
    pub identification: Excitation,
    pub verification: Excitation,
    pub nlse: NlseSettings,
    pub pso: pso::Settings,
}

impl Scenario {
    /// # Errors
    /// If the text is not a scenario; the message names table and key.
    pub fn parse(text: &str) -> Result<Self, ScenarioError> {
        let file: File = toml::from_str(text)?;
        let scenario = Self {
            number: file.scenario,
            title: file.title,
            measured: file.measured,
            given: given(&file.given)?,
            truth: Motor::from_array(&complete("truth", &file.truth)?),
            bounds: complete("bounds", &file.bounds)?,
            identification: file.identification,
            verification: file.verification,
            nlse: file.nlse,
            pso: file.pso,
        };
        scenario.check()?;
        Ok(scenario)
    }

    /// Checks what types cannot; call it again after changing a scenario.
    pub fn check(&self) -> Result<(), ScenarioError> {
        let mut channels = self.measured.clone();
        channels.sort_unstable();
        channels.dedup();
        if channels.len() != self.measured.len() || !channels.contains(&Channel::Omega) {
            return Err(ScenarioError::Measured(self.measured.clone()));
        }
        if self.given.iter().all(Option::is_some) {
            return Err(ScenarioError::NothingLeft);
        }
        for (k, value) in self.truth.to_array().into_iter().enumerate() {
            check_parameter("truth", k, value)?;
        }
        for (k, value) in self.given.iter().enumerate() {
            value.map_or(Ok(()), |v| check_parameter("given", k, v))?;
        }
        for (k, bounds) in self.bounds.iter().enumerate() {
            check_bounds(k, *bounds)?;
        }
        check_excitation("identification", &self.identification)?;
        check_excitation("verification", &self.verification)?;
        let value = |table, key: &str, value: usize| ScenarioError::Value {
            table,
            key: key.into(),
            value: value.to_string(),
            expected: "must be at least 1",
        };
        match (self.nlse.starts, self.pso.particles_per_parameter, self.pso.iterations) {
            (0, _, _) => Err(value("nlse", "starts", 0)),
            (_, 0, _) => Err(value("pso", "particles_per_parameter", 0)),
            (_, _, 0) => Err(value("pso", "iterations", 0)),
            _ => Ok(()),
        }
    }

    /// What a reader should know before believing the numbers.
    pub fn warnings(&self) -> Vec<String> {
        let Motor { t_s, t_c, .. } = self.truth;
        let mut warnings = Vec::new();
        if t_s < t_c {
            warnings.push(format!(
                "T_s = {t_s} < T_c = {t_c}, as printed in the paper: friction rises with speed at \
                 first, the opposite of Stribeck's effect"
            ));
        }
        warnings
    }
}

fn given(table: &BTreeMap<String, f64>) -> Result<[Option<f64>; COUNT], ScenarioError> {
    let mut values = [None; COUNT];
    for (name, value) in table {
        let k = position(name)
            .ok_or_else(|| ScenarioError::Unknown { table: "given", name: name.clone() })?;
        values[k] = Some(*value);
    }
    Ok(values)
}

/// One value per parameter, in order.
fn complete<T: Copy + Default>(
    table: &'static str,
    entries: &BTreeMap<String, T>,
) -> Result<[T; COUNT], ScenarioError> {
    if let Some(name) = entries.keys().find(|n| position(n).is_none()) {
        return Err(ScenarioError::Unknown { table, name: name.clone() });
    }
    let mut values = [T::default(); COUNT];
    for (k, name) in NAMES.into_iter().enumerate() {
        values[k] = *entries.get(name).ok_or(ScenarioError::Missing { table, name })?;
    }
    Ok(values)
}

/// Divisors must be positive and dry friction must not be negative; T_v1 to T_v3 may be anything.
fn check_parameter(table: &'static str, k: usize, value: f64) -> Result<(), ScenarioError> {
    let (fine, expected) = match k {
        index::J | index::K | index::L | index::R | index::OMEGA_S => {
            (value > 0.0 && value.is_finite(), "must be positive")
        }
        index::T_S | index::T_C => (value >= 0.0 && value.is_finite(), "must not be negative"),
        _ => (value.is_finite(), "must be a number"),
    };
    if fine {
        return Ok(());
    }
    let key = NAMES[k].to_string();
    Err(ScenarioError::Value { table, key, value: value.to_string(), expected })
}

fn check_bounds(k: usize, [low, high]: [f64; 2]) -> Result<(), ScenarioError> {
    check_parameter("bounds", k, low)?;
    check_parameter("bounds", k, high)?;
    if low < high {
        return Ok(());
    }
    let (key, value) = (NAMES[k].to_string(), format!("[{low}, {high}]"));
    let expected = "must be [lower, upper] with lower < upper";
    Err(ScenarioError::Value { table: "bounds", key, value, expected })
}

/// Longest simulation a scenario may ask for, samples.
const MOST_SAMPLES: f64 = 1e7;

fn check_excitation(table: &'static str, e: &Excitation) -> Result<(), ScenarioError> {
    let positive = |v: f64| v > 0.0 && v.is_finite();
    let samples = e.duration / e.sample_time;
    let rules = [
        ("peak", e.peak, positive(e.peak), "must be positive, V"),
        ("sample_time", e.sample_time, positive(e.sample_time), "must be positive, s"),
        ("hold", e.hold[0], e.hold[0] >= e.sample_time, "must be at least the sample time, s"),
        ("hold", e.hold[1], positive(e.hold[1]) && e.hold[1] >= e.hold[0], "must not fall"),
        ("duration", e.duration, samples >= 100.0, "must hold at least 100 samples, s"),
        ("duration", e.duration, samples <= MOST_SAMPLES, "must hold at most 1e7 samples, s"),
        ("snr_db", e.snr_db, e.snr_db.is_finite(), "must be a number, dB"),
    ];
    match rules.into_iter().find(|(_, _, fine, _)| !fine) {
        None => Ok(()),
        Some((key, value, _, expected)) => {
            let (key, value) = (key.to_string(), value.to_string());
            Err(ScenarioError::Value { table, key, value, expected })
        }
    }
}
