//! The sim-to-real gap: where it lies, which effect causes it, how far it shrinks.

mod account;
mod answer;
mod bootstrap;
mod bound;
mod candidate;
mod chance;
mod colour;
mod columns;
mod conditioning;
mod episodes;
mod evidence;
mod experiment;
mod features;
mod floor;
mod gap;
mod intervals;
mod kinematics;
mod late;
mod leftover;
mod local_noise;
mod locate;
mod masses;
mod mend;
mod model;
mod newton;
mod notes;
mod probability;
mod profile;
mod rank;
mod reasons;
mod regimes;
mod repeats;
mod revise;
mod rivals;
mod search;
mod select;
mod shrink;
mod significance;
mod slow;
mod standstill;
mod surrogates;
mod system;
#[cfg(test)]
mod testing;
mod traces;
mod untestable;
mod verdict;
mod windows;
pub mod words;

pub use answer::{
    Cause, Checked, Diagnosis, Gap, JointGap, JointShrink, Leftover, Named, Ranked, Regime,
    Rejected, RoundEvidence, Scored, Shrink, SimulationShrink, TorqueShrink, Untestable, Value,
    Verdict,
};
pub use conditioning::conditioning;
pub use episodes::Episode;
pub use floor::{Floor, FloorFrom, noise_floor};
pub use gap::gap;
pub use locate::locate;
pub use mend::mend;
pub use reasons::by_reason;
pub use shrink::{BeforeAfter, torque_shrink};
pub use traces::{Held, JointTraces, Traces};

use crate::signals::Samples;
use crate::twin::Twin;

/// Choices of a diagnosis; echoed in every output.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Effects taken out of the catalogue.
    pub without: Vec<String>,
    /// Of surrogates and bootstraps.
    pub seed: u64,
    /// Searches repeated on surrogate gaps.
    pub surrogates: usize,
    /// How well the twin's link masses are known, relative; 0 takes them for exact.
    pub mass_error: f64,
    /// How well their centres are known, m.
    pub centre_error_m: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            without: Vec::new(),
            seed: 1,
            surrogates: 39,
            mass_error: 0.05,
            centre_error_m: 0.005,
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum DiagnosisError {
    #[error(transparent)]
    Signals(#[from] crate::signals::SignalError),
    #[error("{0}")]
    Recording(String),
}

impl DiagnosisError {
    /// Said of one of two recordings.
    fn of(self, which: &str) -> Self {
        match self {
            Self::Recording(problem) => {
                Self::Recording(format!("the {which} recording: {problem}"))
            }
            other => other,
        }
    }
}

/// Fits on `fit`, judges on `check`. `twin` is what is known of the arm; effects it lists without
/// values are fitted along and are no gap.
///
/// # Errors
/// If a recording has too few sliding samples to fit the twin.
pub fn diagnose(
    twin: &Twin,
    fit: &Samples,
    check: &Samples,
    settings: &Settings,
) -> Result<Diagnosis, DiagnosisError> {
    Ok(diagnose_traced(twin, fit, check, settings)?.0)
}

/// The same with what it rests on, sample by sample.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_traced(
    twin: &Twin,
    fit: &Samples,
    check: &Samples,
    settings: &Settings,
) -> Result<(Diagnosis, Traces), DiagnosisError> {
    let recordings = [twin.correct(fit), twin.correct(check)];
    let first = once(twin, &recordings, settings)?;
    let found = match standstill::left_out(&recordings, first.guard_s()) {
        Some(fewer) => once(twin, &fewer, settings)?.in_place_of(first),
        None => first,
    };
    Ok((found.answer, found.traces))
}

/// What a pass over both recordings finds.
struct Found {
    answer: Diagnosis,
    traces: Traces,
    /// How late the torque is by the causes that were found, 0 if it is not.
    delay_s: f64,
    /// How late it may be by what was declined.
    suspected_s: f64,
    /// What does better than the strongest cause, but cannot be named.
    outdone: Option<Named>,
}

fn once(
    twin: &Twin,
    [fit, check]: &[Samples; 2],
    settings: &Settings,
) -> Result<Found, DiagnosisError> {
    let floors = [noise_floor(fit, twin), noise_floor(check, twin)];
    let evidence = |which, samples, floor| {
        evidence::Evidence::new(twin, samples, floor).map_err(|error| error.of(which))
    };
    let (fit, check) = (evidence("fit", fit, &floors[0])?, evidence("check", check, &floors[1])?);
    let candidates = candidate::candidates(twin, &settings.without);
    let colours = colour::Colours::new(&fit, &check);
    let search =
        select::Search { fit: &fit, check: &check, settings, candidates, colours: &colours };
    let findings = verdict::Findings::new(&search, &floors[1]);
    let answer = findings.answer();
    let traces = Traces::new(&findings, &answer);
    let delay_s = late::delay(&findings.account.last.fit);
    let suspected_s = late::suspected(&findings.account.rounds);
    let outdone = findings.outdone().map(|[_, best]| rivals::named(best));
    Ok(Found { answer, traces, delay_s, suspected_s, outdone })
}
