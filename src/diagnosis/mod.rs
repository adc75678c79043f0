//! The sim-to-real gap: where it lies, which effect causes it, how far it shrinks.

mod a_little_off;
mod answer;
mod beyond;
mod blind;
mod bootstrap;
mod bound;
mod built;
mod by;
mod called;
mod candidate;
mod change;
mod conditioning;
mod criteria;
mod curve;
mod data;
mod discrepancy;
mod episodes;
mod experiment;
mod findings;
mod fit;
mod floor;
mod gap;
mod held_out;
mod hypotheses;
mod independent;
mod intervals;
mod judge;
mod kept;
mod kinematics;
mod likely;
mod limits;
mod link_masses;
mod links;
mod local_noise;
mod locate;
mod mend;
mod merge;
mod model;
mod newton;
mod observed;
mod offered;
mod profile;
mod proved;
mod ranking;
mod reasons;
mod refine;
mod regimes;
mod revise;
mod rounds;
mod screen;
mod search;
mod searched;
mod shrink;
mod sizes;
mod slopes;
mod slow;
mod smoothing;
mod tolerances;
mod touches;
mod traces;
mod trial;
mod unexplained;
mod untestable;
mod verdict;
mod windows;
pub mod words;

pub use answer::{
    Cause, Checked, Dependence, Diagnosis, Gap, JointGap, JointShrink, Named, Ranked, Regime,
    Rejected, Replaced, RoundEvidence, Scored, Shrink, SimulationShrink, TorqueShrink, Unexplained,
    UnexplainedJoint, Untestable, Value, Verdict,
};
pub use bootstrap::interval;
pub use by::{By, CrossValidated, JointPositionShrink, Position, PositionShrink, TimeOffset};
pub use change::Change;
pub use conditioning::conditioning;
pub use criteria::Criteria;
pub use episodes::{Episode, Touch};
pub use experiment::TWIN;
pub use floor::{Floor, FloorFrom, noise_floor};
pub use gap::gap;
pub use locate::{LOCATING, locate};
pub use mend::{changed, mend};
pub use offered::Offer;
pub use proved::{Proof, Stands};
pub use reasons::by_reason;
pub use rounds::SEARCHING;
pub use shrink::{BeforeAfter, torque_shrink};
pub use traces::{Held, JointTraces, Traces};

use crate::follow::{Interrupted, Watch, stoppable};
use crate::signals::Samples;
use crate::twin::Twin;

/// Choices of a diagnosis; echoed in every output.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Effects taken out of the catalogue.
    pub without: Vec<String>,
    /// Random seed for the discrepancy's features and for bootstraps.
    pub seed: u64,
    /// How well the twin's link masses are known, relative; 0 takes them for exact.
    pub mass_error: f64,
    /// How well their centres are known, m.
    pub centre_error_m: f64,
    /// Thresholds that decide.
    #[serde(default)]
    pub criteria: Criteria,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            without: Vec::new(),
            seed: 1,
            mass_error: 0.05,
            centre_error_m: 0.005,
            criteria: Criteria::default(),
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum DiagnosisError {
    #[error(transparent)]
    Signals(#[from] crate::signals::SignalError),
    #[error("{0}")]
    Recording(String),
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    #[error(transparent)]
    Proof(Box<dyn std::error::Error + Send + Sync>),
}

impl DiagnosisError {
    /// The error with the name of the recording it is about.
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
    Ok(diagnose_traced(twin, fit, check, settings, &())?.0)
}

/// The answer of [`diagnose`] with what it rests on, sample by sample, in work that `watch` may end.
///
/// # Errors
/// As [`diagnose`], and if it is ended.
pub fn diagnose_traced(
    twin: &Twin,
    fit: &Samples,
    check: &Samples,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<(Diagnosis, Traces), DiagnosisError> {
    stoppable(watch, || with_guard(twin, fit, check, settings, watch))?
}

/// As [`diagnose_traced`], where `proof` takes the place of the check recording's torque.
///
/// # Errors
/// As [`diagnose`], and if it is ended or `proof` fails.
pub fn diagnose_proved(
    twin: &Twin,
    fit: &Samples,
    check: &Samples,
    settings: &Settings,
    proof: &mut Proof<'_>,
    watch: &dyn Watch,
) -> Result<(Diagnosis, Traces), DiagnosisError> {
    let samples = [twin.correct(fit), twin.correct(check)];
    stoppable(watch, || once(twin, &samples, settings, Some(proof), watch))?
}

fn with_guard(
    twin: &Twin,
    fit: &Samples,
    check: &Samples,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<(Diagnosis, Traces), DiagnosisError> {
    let samples = [twin.correct(fit), twin.correct(check)];
    let first = once(twin, &samples, settings, None, watch)?;
    // A torque that is recorded late shows that of the standing joint when it slides again.
    let guard_s = LATE * delay_s(&first.0);
    if samples.iter().all(|s| s.conditioning.guard_s >= guard_s - 0.5 * s.dt) {
        return Ok(first);
    }
    let fewer = samples.map(|mut s| {
        s.conditioning.guard_s = s.conditioning.guard_s.max(guard_s);
        s
    });
    once(twin, &fewer, settings, None, watch)
}

/// Multiple of the torque's delay that is left out beside standstill: the first one found is too short for
/// what standing joints add to it.
const LATE: f64 = 1.5;

/// How late the torque is by the causes, s.
fn delay_s(found: &Diagnosis) -> f64 {
    let values = found.causes.iter().flat_map(|c| &c.parameters);
    values.filter(|v| v.name == "time_delay").map(|v| v.value).fold(0.0, f64::max)
}

fn once(
    twin: &Twin,
    samples: &[Samples; 2],
    settings: &Settings,
    proof: Option<&mut Proof<'_>>,
    watch: &dyn Watch,
) -> Result<(Diagnosis, Traces), DiagnosisError> {
    let floors = samples.each_ref().map(|s| noise_floor(s, twin));
    let observed = |i: usize, which: &str| {
        let observed = observed::Observed::new(i, twin, &samples[i], &floors[i]);
        observed.map_err(|error| error.of(which))
    };
    let (fit, check) = (observed(0, "fit")?, observed(1, "check")?);
    let rounds = rounds::Rounds::new(watch, settings.criteria.most_causes);
    let [one, other_one] = [0, 1].map(|search| rounds.of(search));
    let both = data::Data::new(vec![&fit, &check], settings).watched(&one);
    let alone = data::Data::new(vec![&fit], settings).watched(&other_one);
    let other = data::Data::new(vec![&check], settings).watched(watch);
    let search = |data, recordings: &[usize]| {
        let candidates = candidate::candidates(twin, &settings.without, recordings);
        searched::Searched::new(data, candidates, settings.criteria)
    };
    // What acts in one recording alone cannot be proved on another.
    let here: &[usize] = if proof.is_some() { &[] } else { &[0, 1] };
    let (both, alone) = rayon::join(|| search(&both, here), || search(&alone, &[0]));
    let [all, blind] = [&both, &alone].map(searched::Searched::hypotheses);
    let [found, found_alone] = [both.found(&all), alone.found(&blind)];
    // The noise is the arm's: a check recording is often too short to tell how much of it is independent.
    let other = independent::as_dependent(other, &found_alone.last, &found.last.model);
    let judge = judge::Judge { fit: &alone.data, check: &other, criteria: settings.criteria };
    let floor = floors[1].clone();
    let both = (&all, found);
    let alone = (&blind, found_alone);
    let recordings = [&fit, &check];
    let findings = findings::Findings::new(both, alone, judge, recordings, floor, settings, proof)?;
    let mut answer = findings.answer();
    let mended = mend(twin, &answer.fitted, &answer.changes());
    touches::touched(&mended, samples, &mut answer.episodes)?;
    let traces = Traces::new(&findings, &answer);
    Ok((answer, traces))
}
