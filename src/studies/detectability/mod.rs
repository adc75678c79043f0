//! How weak an effect may be and still be told from noise, what its parameters then are worth, and
//! what it costs to simulate.
//!
//! Per effect: its own scenario, all its linear values times one strength. The motions are
//! simulated once per strength and seen through the sensors many times. What the twin does not
//! know (friction) is fitted with and without the effect on the first recording; the effect beats
//! its null where its fit predicts the second recording better than what stays of it however weak it
//! is (nothing; of backlash the teeth's elasticity). Its nonlinear parameters are taken as
//! known, and effects on recorded channels as small: the figures are what data can give at best.

mod experiment;
mod regression;

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::StudyError;
use super::strength::scaled;
use crate::effects::{Effect, Role, Seen};
use crate::signals::Conditioning;
use crate::simulation::Scenario;
use experiment::Bench;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Sensor noise drawn per strength.
    pub seeds: u64,
    /// Length of each of the two recordings, s.
    pub duration_s: f64,
    /// Signal-to-noise ratio of the current, dB.
    pub snr_db: f64,
    /// Share of the seeds in which a detectable effect beats its null.
    pub share: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { seeds: 50, duration_s: 30.0, snr_db: 30.0, share: 0.9 }
    }
}

/// Strengths are powers of the square root of two of the scenario's, from about a thousandth to
/// eight times.
const WEAKEST: i32 = -20;
const STRONGEST: i32 = 6;

/// Share of the noise from which an effect tends to be told.
const LIKELY: f64 = 0.1;

fn strength(level: i32) -> f64 {
    2f64.powf(0.5 * f64::from(level))
}

/// What was found about one effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Detectability {
    pub effect: String,
    pub seen: String,
    pub of: Made,
    /// Smallest strength that is told from nothing; `None` where none up to the strongest is.
    pub detectable: Option<Strength>,
    /// Quality at the scenario's own values.
    pub typical: Option<Quality>,
    /// Wall clock per simulated second, ms: the fastest of the runs.
    pub cost_ms: f64,
}

/// What a measurement was made of: equal ones need not be repeated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Made {
    pub version: String,
    pub settings: Settings,
    pub scenario: Scenario,
    pub conditioning: Conditioning,
}

impl Made {
    pub fn new(effect: &dyn Effect, scenario: &Scenario, settings: &Settings) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            settings: settings.clone(),
            scenario: scenario.clone(),
            conditioning: experiment::conditioning(effect),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Strength {
    /// Multiple of the scenario's values.
    pub factor: f64,
    /// Largest value of the first linear parameter over the joints, in `unit`.
    pub value: f64,
    pub parameter: String,
    pub unit: String,
    /// Root mean square of the effect's torque over that of the noise, at the joint where it is largest.
    pub rms_over_noise: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Median over seeds and parameters that are not zero, of |estimate - truth| / |truth|.
    pub parameter_error: f64,
    /// Chi-square per sample that is left on the second recording; 1 is noise.
    pub left: f64,
    /// Chi-square per sample without the effect.
    pub left_without: f64,
}

/// Measures `effect` in its `scenario`; `file` names that in messages.
///
/// # Errors
/// If the scenario lacks the effect or does not work out, or a simulation diverges.
pub fn detectability(
    effect: &'static dyn Effect,
    scenario: &Scenario,
    file: &str,
    settings: &Settings,
) -> Result<Detectability, StudyError> {
    let mut study = Study { effect, scenario, file, settings, cost_ms: f64::INFINITY };
    let seen = effect.seen();
    let by_torque = seen != Seen::Simulation;
    let typical = study.at(0)?;
    let detectable = if by_torque { study.weakest(&typical)? } else { None };
    let known = by_torque && typical.rms_over_noise > 0.0;
    Ok(Detectability {
        effect: effect.about().name.into(),
        seen: format!("{seen:?}").to_lowercase(),
        of: Made::new(effect, scenario, settings),
        detectable,
        typical: known.then_some(typical.quality),
        cost_ms: study.cost_ms,
    })
}

struct Study<'a> {
    effect: &'static dyn Effect,
    scenario: &'a Scenario,
    file: &'a str,
    settings: &'a Settings,
    cost_ms: f64,
}

/// What all seeds came to at one strength.
struct Outcome {
    level: i32,
    told: bool,
    quality: Quality,
    rms_over_noise: f64,
}

impl Study<'_> {
    /// The weakest level that is told, looked for from where the effect is a tenth of the noise;
    /// stronger than the scenario's where that is not told.
    fn weakest(&mut self, typical: &Outcome) -> Result<Option<Strength>, StudyError> {
        if typical.rms_over_noise <= 0.0 {
            return Ok(None);
        }
        let guess = 2.0 * (LIKELY / typical.rms_over_noise).log2();
        let weakest = if typical.told { WEAKEST } else { 1 };
        let mut level = (guess.round() as i32).clamp(weakest, STRONGEST);
        let mut now = self.at(level)?;
        let first = now.told;
        let mut best = None;
        loop {
            if now.told {
                best = Some(now);
            }
            level += if first { -1 } else { 1 };
            let decided = !first && best.is_some();
            if decided || !(weakest..=STRONGEST).contains(&level) {
                break;
            }
            now = self.at(level)?;
            if first && !now.told {
                break;
            }
        }
        Ok(best.map(|o| self.named(strength(o.level), o.rms_over_noise)))
    }

    fn named(&self, factor: f64, rms_over_noise: f64) -> Strength {
        let about = self.effect.about();
        let scaled = |p: &&crate::effects::Parameter| {
            p.role == Role::Linear || self.effect.seen() == Seen::Channels
        };
        let (parameter, unit) =
            about.parameters.iter().find(scaled).map_or(("", ""), |p| (p.name, p.unit));
        let table = self.scenario.effects.get(about.name);
        let values = table.and_then(|t| t.get(parameter)).map(|v| v.expand(1)).unwrap_or_default();
        let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        Strength {
            factor,
            value: factor * largest,
            parameter: parameter.into(),
            unit: unit.into(),
            rms_over_noise,
        }
    }

    fn at(&mut self, level: i32) -> Result<Outcome, StudyError> {
        let mut scenario = scaled(self.effect, self.scenario, strength(level))?;
        scenario.shorten(self.settings.duration_s);
        scenario.noise.snr_db = Some(self.settings.snr_db);
        let made = scenario.work_out(self.file)?;
        let started = Instant::now();
        let bench = Bench::new(self.effect, &made)?;
        let simulated = 2.0 * self.settings.duration_s;
        self.cost_ms = self.cost_ms.min(1e3 * started.elapsed().as_secs_f64() / simulated);
        let seeds = if self.effect.seen() == Seen::Simulation { 0 } else { self.settings.seeds };
        let trials = (1..=seeds).map(|seed| bench.trial(seed)).collect::<Result<Vec<_>, _>>()?;
        let told = trials.iter().filter(|t| t.left < t.left_without).count() as f64;
        let middle = |of: &dyn Fn(&regression::Trial) -> f64| median(trials.iter().map(of));
        Ok(Outcome {
            level,
            told: seeds > 0 && told >= self.settings.share * seeds as f64,
            quality: Quality {
                parameter_error: median(trials.iter().flat_map(|t| t.errors.iter().copied())),
                left: middle(&|t| t.left),
                left_without: middle(&|t| t.left_without),
            },
            rms_over_noise: middle(&|t| t.rms_over_noise),
        })
    }
}

/// Median; 0 where there are no values.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;

    fn measured(name: &str, text: &str) -> Detectability {
        let scenario = Scenario::parse(text, name).unwrap();
        let settings = Settings { seeds: 6, duration_s: 12.0, ..Settings::default() };
        detectability(find(name).unwrap(), &scenario, name, &settings).unwrap()
    }

    #[test]
    fn a_payload_is_found_while_it_is_light() {
        let found = measured("payload", include_str!("../../../scenarios/effects/payload.toml"));
        let Strength { value, rms_over_noise, .. } = found.detectable.unwrap();
        assert!((0.001..0.3).contains(&value), "{value} kg");
        assert!((0.005..1.0).contains(&rms_over_noise), "{rms_over_noise}");
        let typical = found.typical.unwrap();
        assert!(typical.parameter_error < 0.1, "{typical:?}");
        assert!(typical.left < 2.0 && typical.left_without > 20.0, "{typical:?}");
        assert!(found.cost_ms > 0.0);
    }

    /// The first joint has no inner neighbour: a column of zeros.
    #[test]
    fn a_neighbours_friction_is_found() {
        let text = include_str!("../../../scenarios/effects/joint_coupling.toml");
        let typical = measured("joint_coupling", text).typical.unwrap();
        assert!(typical.parameter_error < 0.2, "{typical:?}");
        assert!(typical.left < 2.0 && typical.left_without > 5.0, "{typical:?}");
    }

    #[test]
    fn what_inverse_dynamics_cannot_see_is_not_found() {
        let text = include_str!("../../../scenarios/effects/controller_mismatch.toml");
        let found = measured("controller_mismatch", text);
        assert_eq!((found.detectable, found.typical), (None, None));
    }
}
