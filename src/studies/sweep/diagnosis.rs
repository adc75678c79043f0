//! Diagnosis of an arm in which one effect is hidden: is it named, and at the right place?

use super::arm::Bench;
use super::grid::Cell;
use super::study::{NO_EFFECT, Study};
use super::table::{Row, Value};
use crate::diagnosis::{Cause, Diagnosis, Named as Place, Settings, conditioning, diagnose};
use crate::effects::{Scope, find};
use crate::signals::condition;
use crate::studies::StudyError;

/// What a diagnosis said, judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    pub verdict: String,
    /// `payload, stribeck 1 2`: effects and, where not the whole arm, joints from 1.
    pub causes: String,
    /// The first cause, or what it says would look the same, is the hidden effect.
    pub right: bool,
    /// The hidden effect is named at one of its joints.
    pub place: bool,
    /// Something is named that is neither there nor said to look like what is there.
    pub wrong: bool,
    /// Probability of the hidden effect in the ranking, at whatever place.
    pub probability: f64,
    pub unknown: f64,
    /// Largest gap of a joint over its noise floor.
    pub gap_over_noise: f64,
    /// Share of the gap's mean square that goes, on the check recording.
    pub shrink: f64,
}

impl Default for Named {
    fn default() -> Self {
        let nan = f64::NAN;
        Self {
            verdict: String::new(),
            causes: String::new(),
            right: false,
            place: false,
            wrong: false,
            probability: nan,
            unknown: nan,
            gap_over_noise: nan,
            shrink: nan,
        }
    }
}

impl Named {
    pub fn row(self) -> Row {
        vec![
            ("verdict", Value::Text(self.verdict)),
            ("causes", Value::Text(self.causes)),
            ("right", self.right.into()),
            ("place", self.place.into()),
            ("wrong", self.wrong.into()),
            ("probability", self.probability.into()),
            ("unknown", self.unknown.into()),
            ("gap_over_noise", self.gap_over_noise.into()),
            ("shrink", self.shrink.into()),
        ]
    }
}

/// # Errors
/// If a recording cannot be conditioned or does not slide.
pub fn rows(study: &Study, cell: &Cell, bench: &Bench) -> Result<Vec<Row>, StudyError> {
    let found = diagnosed(study, cell, bench)?;
    let hidden = cell.effect.as_deref().filter(|name| *name != NO_EFFECT && cell.strength != 0.0);
    Ok(vec![judged(&found, hidden, bench).row()])
}

/// # Errors
/// As [`rows`].
pub fn diagnosed(study: &Study, cell: &Cell, bench: &Bench) -> Result<Diagnosis, StudyError> {
    let twin = bench.twin(true);
    let twin =
        crate::twin::Twin { effects: ["coulomb", "viscous"].map(String::from).into(), ..twin };
    let recordings = bench.recordings(cell)?;
    let how = conditioning(&recordings[0], twin.robot.dof());
    let samples = |r| condition(r, &twin.drive, twin.robot.dof(), &how);
    let (fit, check) = (samples(&recordings[0])?, samples(&recordings[1])?);
    let settings = Settings { seed: cell.seed, ..study.diagnosis.clone() };
    Ok(diagnose(&twin, &fit, &check, &settings)?)
}

fn judged(found: &Diagnosis, hidden: Option<&str>, bench: &Bench) -> Named {
    let at = |name: &str| -> Vec<usize> {
        let injected = bench.made.setup.effects.iter().find(|i| i.effect.about().name == name);
        injected.map(|i| i.joints.iter().map(|j| j + 1).collect()).unwrap_or_default()
    };
    let is = |named: &Place| Some(named.effect.as_str()) == hidden;
    let first = found.causes.first().map(said).unwrap_or_default();
    let right = first.iter().find(|n| is(n));
    let stands_for = |cause: &Cause| said(cause).iter().any(is);
    let of = |name: &str| {
        found.ranking.iter().filter(|r| r.effect == name).map(|r| r.probability).sum::<f64>()
    };
    let over = found.gap.joints.iter().map(|j| j.rms_nm / j.noise_floor_nm);
    Named {
        verdict: text(&found.verdict),
        causes: found.causes.iter().map(words).collect::<Vec<_>>().join(", "),
        right: right.is_some(),
        place: right.is_some_and(|n| placed(n, &at(&n.effect))),
        wrong: found.causes.iter().any(|c| !stands_for(c)),
        probability: of(hidden.unwrap_or("none")),
        unknown: of("unknown"),
        gap_over_noise: over.fold(0.0, f64::max),
        shrink: found.shrink.torque.fraction,
    }
}

/// A cause and what would look the same.
fn said(cause: &Cause) -> Vec<Place> {
    let own = Place { effect: cause.effect.clone(), joints: cause.joints.clone() };
    std::iter::once(own).chain(cause.equivalent.iter().cloned()).collect()
}

/// An effect of the whole arm has no joint.
fn placed(named: &Place, at: &[usize]) -> bool {
    let whole = find(&named.effect).is_some_and(|e| e.about().scope == Scope::Arm);
    whole || named.joints.is_empty() || named.joints.iter().any(|j| at.contains(j))
}

fn words(cause: &Cause) -> String {
    let joints = cause.joints.iter().map(|j| format!(" {j}"));
    format!("{}{}", cause.effect, joints.collect::<String>())
}

fn text(verdict: &impl serde::Serialize) -> String {
    let value = serde_json::to_value(verdict).ok();
    value.and_then(|v| v.as_str().map(str::to_string)).unwrap_or_default()
}
