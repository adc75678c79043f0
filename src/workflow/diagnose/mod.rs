//! Where a twin differs from its arm, why, and how far mending it helps.

mod document;
#[cfg(feature = "report")]
mod page;
mod resimulated;
#[cfg(feature = "viewer")]
mod scene;

use std::time::Instant;

use super::{Arm, Prepared, Reading, WorkflowError, by, conditioned};
use crate::diagnosis::{self, By, Diagnosis, Settings, Traces, mend};
use crate::effects;
use crate::follow::Watch;
use crate::recording::{Provenance, Recording};
use crate::report::Fact;
use crate::series::JointSeries;
use crate::servo::{self, Found};
use crate::signals::{Conditioning, Samples};
use crate::twin::Twin;

pub use document::DiagnosisDocument;

/// What `armtwin diagnose` can be told; the defaults are its.
///
/// ```
/// # use armtwin::workflow::Diagnose;
/// let how = Diagnose::default().without(["payload", "link_inertia"]).seed(7).simulated(false);
/// assert_eq!(how.settings.seed, 7);
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Diagnose {
    pub settings: Settings,
    pub reading: Reading,
    /// Against recorded torque, or by simulating command to position; `None`: what is recorded decides.
    pub by: Option<By>,
    /// Move both twins again in the simulation.
    pub simulate: bool,
}

impl Default for Diagnose {
    fn default() -> Self {
        let (settings, reading) = (Settings::default(), Reading::default());
        Self { settings, reading, by: None, simulate: true }
    }
}

/// A diagnosis and all that led to it.
pub struct Diagnosed {
    /// As given.
    pub twin: Twin,
    /// With the causes and all values found.
    pub mended: Twin,
    pub settings: Settings,
    /// Samples that causes are searched on.
    pub fit: Recorded,
    /// Samples that decide.
    pub check: Recorded,
    pub diagnosis: Diagnosis,
    /// What it rests on, sample by sample of the check recording.
    pub traces: Traces,
    /// Positions of the twin as given and of the mended one, moved again, rad.
    pub simulated: Vec<JointSeries>,
    /// Wall-clock, s.
    pub seconds: f64,
}

/// What became of a recording.
pub struct Recorded {
    pub provenance: Provenance,
    pub samples: Samples,
}

/// Diagnoses with the program's defaults: causes are searched on `fit` and decided on `check`; without
/// one, on the halves of `fit`.
///
/// # Errors
/// As [`Diagnose::run`].
pub fn diagnose<'a>(
    twin: &Twin,
    fit: &'a Recording,
    check: impl Into<Option<&'a Recording>>,
) -> Result<Diagnosed, WorkflowError> {
    Diagnose::default().run(twin, fit, check, &())
}

impl Diagnose {
    /// Takes effects out of the catalogue.
    pub fn without<S: Into<String>>(mut self, effects: impl IntoIterator<Item = S>) -> Self {
        self.settings.without = effects.into_iter().map(Into::into).collect();
        self
    }

    /// Random seed for the discrepancy's features and for bootstraps.
    pub fn seed(mut self, seed: u64) -> Self {
        self.settings.seed = seed;
        self
    }

    /// How well the twin's link masses are known, relative; 0 takes them for exact.
    pub fn mass_error(mut self, share: f64) -> Self {
        self.settings.mass_error = share;
        self
    }

    /// How well the centres of links are known, m.
    pub fn centre_error_m(mut self, metres: f64) -> Self {
        self.settings.centre_error_m = metres;
        self
    }

    /// Against recorded torque, or by simulating command to position.
    pub fn by(mut self, by: Option<By>) -> Self {
        self.by = by;
        self
    }

    /// Whether both twins are moved again in the simulation.
    pub fn simulated(mut self, simulate: bool) -> Self {
        self.simulate = simulate;
        self
    }

    /// Takes and conditions both recordings so.
    pub fn reading(mut self, reading: Reading) -> Self {
        self.reading = reading;
        self
    }

    /// # Errors
    /// Unknown effects, a recording that is not of this arm or contradicts itself, two recordings with the same
    /// samples, too few sliding samples, or an end by `watch`.
    pub fn run<'a>(
        &self,
        arm: impl Into<Arm>,
        fit: &'a Recording,
        check: impl Into<Option<&'a Recording>>,
        watch: &dyn Watch,
    ) -> Result<Diagnosed, WorkflowError> {
        self.check()?;
        let arm = arm.into();
        let (fit, check) = self.reading.both(&arm, fit, check.into(), watch)?;
        self.on(&arm.twin, fit, check, watch)
    }

    /// # Errors
    /// Names what does not exist, or is out of its range.
    pub fn check(&self) -> Result<(), WorkflowError> {
        let unknown = self.settings.without.iter().find(|name| effects::find(name).is_none());
        if let Some(unknown) = unknown {
            return Err(WorkflowError::Asked(format!(
                "without {unknown}: no such effect; choose from {}",
                effects::names()
            )));
        }
        let given = [
            ("mass_error", self.settings.mass_error),
            ("centre_error", self.settings.centre_error_m),
        ];
        match given.into_iter().find(|(_, v)| !(0.0..=1.0).contains(v)) {
            Some((name, v)) => Err(WorkflowError::Asked(format!(
                "{name} {v}: give a number from 0 (known exactly) to 1"
            ))),
            None => Ok(()),
        }
    }

    /// Diagnoses on recordings that were taken before: searches on the first, decides on the second, mends the
    /// twin and moves both twins again.
    ///
    /// # Errors
    /// As [`Diagnose::run`].
    pub fn on<'a>(
        &self,
        twin: &Twin,
        fit: Prepared<'a>,
        check: Option<Prepared<'a>>,
        watch: &dyn Watch,
    ) -> Result<Diagnosed, WorkflowError> {
        let mut twin = twin.clone();
        let pair = fit.pair(check)?;
        let by = by::choose(self.by, &mut twin, &pair.each_ref())?;
        let [fit, check] = pair.map(|recording| by::kept(by, recording));
        let twin = &twin;
        let how = self.reading.signals.over(common([&fit, &check], twin.robot.dof()));
        let samples = [&fit, &check].map(|r| conditioned(r, twin, &how));
        let [fit_samples, check_samples] = samples;
        let (fit_samples, check_samples) = (fit_samples?, check_samples?);
        let clock = Instant::now();
        let samples = [&fit_samples, &check_samples];
        let Found { diagnosis, traces, simulated } = match by {
            By::Torque => self.by_torque(twin, samples, &check, watch)?,
            By::Simulation => servo::diagnose(twin, samples, &self.settings, watch)?,
        };
        let mended = mend(twin, &diagnosis.fitted, &diagnosis.changes());
        let seconds = clock.elapsed().as_secs_f64();
        let recorded = |recording: &Recording, samples| {
            let provenance = recording.provenance.clone();
            Recorded { provenance, samples }
        };
        Ok(Diagnosed {
            twin: twin.clone(),
            mended,
            settings: self.settings.clone(),
            fit: recorded(&fit, fit_samples),
            check: recorded(&check, check_samples),
            diagnosis,
            traces,
            simulated,
            seconds,
        })
    }

    /// Searches by recorded torque, and moves both twins again where that is wanted.
    fn by_torque(
        &self,
        twin: &Twin,
        [fit, check]: [&Samples; 2],
        recording: &Recording,
        watch: &dyn Watch,
    ) -> Result<Found, WorkflowError> {
        watch.tell(diagnosis::SEARCHING, 0, 0);
        let (mut diagnosis, traces) =
            diagnosis::diagnose_traced(twin, fit, check, &self.settings, watch)?;
        let mut simulated = Vec::new();
        if self.simulate {
            let mended = mend(twin, &diagnosis.fitted, &diagnosis.changes());
            simulated = resimulated::add(&mut diagnosis, [twin, &mended], recording, check, watch)?;
        }
        Ok(Found { diagnosis, traces, simulated })
    }
}

/// Where one of them lacks the command, both are conditioned without; where one is long, both are
/// low-passed alike.
fn common(recordings: [&Recording; 2], dof: usize) -> Conditioning {
    let [fit, check] = recordings.map(|r| diagnosis::conditioning(r, dof));
    match (fit.derivatives == check.derivatives, fit.torque_cutoff_hz >= check.torque_cutoff_hz) {
        (false, _) => Conditioning::default(),
        (true, true) => fit,
        (true, false) => check,
    }
}

impl Diagnosed {
    /// What was found, in one sentence.
    pub fn sentence(&self) -> String {
        diagnosis::words::sentence(&self.diagnosis)
    }

    /// What was diagnosed, and how.
    pub fn facts(&self) -> Vec<Fact> {
        let s = &self.settings;
        let mut facts = vec![("robot".to_string(), self.twin.source.clone())];
        for (what, r) in [("fit", &self.fit), ("check", &self.check)] {
            let from = &r.provenance;
            facts.push((what.into(), format!("{} ({})", from.source, from.format)));
            let notes = from.notes.iter().chain(&r.samples.notes);
            facts.extend(notes.map(|note| (String::new(), note.clone())));
        }
        let without = match s.without.is_empty() {
            true => "nothing".into(),
            false => s.without.join(", "),
        };
        facts.push((
            "settings".into(),
            format!(
                "link masses known to {:.0} %, centres to {:.0} mm, taken out of the catalogue: \
                 {without}",
                100.0 * s.mass_error,
                1e3 * s.centre_error_m
            ),
        ));
        facts
    }
}
