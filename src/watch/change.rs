//! What a change is: the minutes before it and those after, diagnosed.

use super::{Alarm, Figure, REGIMES};
use crate::diagnosis::{self, Cause, Diagnosis, DiagnosisError, Settings, mend, words};
use crate::effects;
use crate::recording::Recording;
use crate::signals::{Samples, condition, thin};
use crate::twin::Twin;

/// What is told of a change.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Answer {
    pub alarm: Alarm,
    /// One or two sentences.
    pub says: String,
    /// What the twin lacks since then, the strongest first.
    pub causes: Vec<Cause>,
    pub diagnosis: Box<Diagnosis>,
}

/// The twin with what it lacked `before`, as far as those minutes tell it; as it is where they hold too
/// little motion.
pub fn usual(twin: &Twin, before: &Recording, settings: &Settings) -> Twin {
    diagnosed(twin, before, settings)
        .map_or_else(|_| twin.clone(), |found| mend(twin, &found.fitted, &found.changes()))
}

/// Diagnoses what `after` has that the arm of the `usual` twin had not.
///
/// # Errors
/// If the minutes after the change hold too little motion.
pub fn answer(
    usual: &Twin,
    after: &Recording,
    alarm: Alarm,
    settings: &Settings,
) -> Result<Answer, DiagnosisError> {
    let found = diagnosed(usual, after, settings)?;
    let says = says(&found);
    Ok(Answer { alarm, says, causes: found.causes.clone(), diagnosis: Box::new(found) })
}

/// One recording held against the twin: its halves search and decide.
fn diagnosed(
    twin: &Twin,
    recording: &Recording,
    settings: &Settings,
) -> Result<Diagnosis, DiagnosisError> {
    let [fit, check] = samples(recording, twin)?;
    diagnosis::diagnose(twin, &fit, &check, settings)
}

/// Both halves, conditioned alike.
fn samples(recording: &Recording, twin: &Twin) -> Result<[Samples; 2], DiagnosisError> {
    let thinned = thin(recording, 0.0);
    let recording = thinned.as_ref().unwrap_or(recording);
    if recording.time.len() < 2 {
        return Err(DiagnosisError::Recording("nothing is remembered".into()));
    }
    let dof = twin.robot.dof();
    let how = diagnosis::conditioning(recording, dof);
    let [fit, check] = recording.halves();
    Ok([condition(&fit, &twin.drive, dof, &how)?, condition(&check, &twin.drive, dof, &how)?])
}

/// `dry friction in gears, bearings and seals (coulomb at joint 3, +31 %; 97 % sure)`; or that nothing is
/// named.
fn says(found: &Diagnosis) -> String {
    let one = |cause: &Cause| {
        let why = effects::find(&cause.effect).map_or("", |e| e.about().cause);
        let sure = words::percent(cause.probability);
        let amount = amount(cause);
        format!("{} at {}{amount}, {sure} sure ({why})", cause.effect, words::place(&cause.joints))
    };
    match &found.causes[..] {
        [] => "no effect of the catalogue is named for it".into(),
        [first] => one(first),
        [first, others @ ..] => {
            let others: Vec<String> = others
                .iter()
                .map(|c| format!("{} at {}", c.effect, words::place(&c.joints)))
                .collect();
            format!("{}; and {}", one(first), others.join(", "))
        }
    }
}

/// `: coulomb +31 %` where the twin has a value, else the value.
fn amount(cause: &Cause) -> String {
    let Some(value) = words::foremost(cause) else { return String::new() };
    let unit = if value.unit == "-" { String::new() } else { format!(" {}", value.unit) };
    match &cause.replaces {
        Some(old) if old.twin != 0.0 => {
            let change = 100.0 * (value.value / old.twin - 1.0);
            format!(
                ": {} {change:+.0} % ({:.3}{unit} after {:.3})",
                value.name, value.value, old.twin
            )
        }
        _ => format!(": {} {:.3}{unit}", value.name, value.value),
    }
}

impl Alarm {
    /// `joint 3 needs 1.8 N.m more along its motion, 2.1 N.m more at reversals`: what grew the most since
    /// the level was learned.
    pub fn words(
        &self,
        now: &[Option<Figure>; REGIMES.len()],
        level: &[Option<Figure>; REGIMES.len()],
    ) -> String {
        let joint = self.joint + 1;
        let both = |r: usize| Some((now[r]?, level[r]?));
        let grown =
            |r: &usize| both(*r).map_or(0.0, |(now, level)| (now.along_nm - level.along_nm).abs());
        let most = (0..REGIMES.len()).max_by(|a, b| grown(a).total_cmp(&grown(b)));
        let Some((r, (n, l))) = most.and_then(|r| Some((r, both(r)?))) else {
            return format!("the gap of joint {joint} changed");
        };
        let more = n.along_nm - l.along_nm;
        let size = n.rms_nm - l.rms_nm;
        let place = place(REGIMES[r]);
        match more.abs() > 0.5 * size.abs() {
            true => {
                let way = if more > 0.0 { "more" } else { "less" };
                format!("joint {joint} needs {:.2} N.m {way} {place}", more.abs())
            }
            false => {
                let Some((n, l)) = both(0) else {
                    return format!("the gap of joint {joint} changed");
                };
                format!(
                    "the gap of joint {joint} is {:.2} N.m rms, {:.2} N.m before",
                    n.rms_nm, l.rms_nm
                )
            }
        }
    }
}

fn place(regime: &str) -> &'static str {
    match regime {
        "reversal" => "at reversals",
        "slow" => "when it moves slowly",
        "fast" => "when it moves fast",
        "driven" => "against its load",
        "back_driven" => "with its load",
        _ => "along its motion",
    }
}
