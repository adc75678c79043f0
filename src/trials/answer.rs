//! A case answered from its folder alone.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::TrialError;
use super::baselines::{BaselineAnswer, baselines};
use super::case::{CHECK, Case, FIT, ROBOT, SETTINGS, TWIN};
use crate::diagnosis::{Criteria, Diagnosis, Settings, conditioning, diagnose};
use crate::files::sha256;
use crate::recording::{Recording, read};
use crate::servo;
use crate::signals::{Conditioning, Samples, condition};
use crate::twin::Twin;

pub const SCHEMA: &str = "armtwin.answer/1";

/// `ANSWERS/case-0000.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    pub schema: String,
    pub armtwin: String,
    pub case: String,
    /// What the answer was made from: file name -> SHA-256.
    pub inputs: BTreeMap<String, String>,
    pub settings: Settings,
    pub conditioning: Conditioning,
    pub diagnosis: Option<Diagnosis>,
    /// Why there is no diagnosis.
    pub failed: Option<String>,
    pub baselines: Vec<BaselineAnswer>,
}

impl Answer {
    /// The answer in `file`, if it is one to the case in `folder` as it is now.
    pub fn kept(file: &Path, folder: &Path) -> Option<Self> {
        let answer: Self = serde_json::from_slice(&fs::read(file).ok()?).ok()?;
        let whole = answer.diagnosis.is_some()
            && answer.schema == SCHEMA
            && answer.armtwin == env!("CARGO_PKG_VERSION")
            && answer.inputs == inputs(folder).ok()?;
        whole.then_some(answer)
    }

    /// The kept answer, if these criteria decided it.
    pub fn kept_by(file: &Path, folder: &Path, criteria: &Criteria) -> Option<Self> {
        Self::kept(file, folder).filter(|answer| answer.settings.criteria == *criteria)
    }
}

/// Diagnoses the case in `folder`; nothing outside that folder is read. A diagnosis that fails is
/// an answer too.
///
/// # Errors
/// If a file of the case cannot be read.
pub fn answer(folder: &Path) -> Result<Answer, TrialError> {
    let opened = Opened::new(folder)?;
    Ok(opened.answer(opened.case.settings.criteria))
}

/// A case with all of its answer that does not depend on what decides.
pub struct Opened {
    case: Case,
    inputs: BTreeMap<String, String>,
    twin: Twin,
    conditioning: Conditioning,
    /// Samples to fit and samples to check.
    samples: [Samples; 2],
    baselines: Vec<BaselineAnswer>,
}

impl Opened {
    /// # Errors
    /// If a file of the case cannot be read.
    pub fn new(folder: &Path) -> Result<Self, TrialError> {
        let case = Case::open(folder)?;
        let twin = Twin::load(&case.file(TWIN))?;
        let recordings = [read(&case.file(FIT), None)?, read(&case.file(CHECK), None)?];
        let conditioning = conditioning(&recordings[0], twin.robot.dof());
        let samples = |r: &Recording| condition(r, &twin.drive, twin.robot.dof(), &conditioning);
        let samples = [samples(&recordings[0])?, samples(&recordings[1])?];
        let baselines = match twin.drive.servo {
            Some(_) => Vec::new(),
            None => baselines(&twin, &samples[0], &samples[1], &case.settings),
        };
        Ok(Self { inputs: inputs(folder)?, case, twin, conditioning, samples, baselines })
    }

    /// The answer by these criteria, which may be other than the case's own.
    pub fn answer(&self, criteria: Criteria) -> Answer {
        let settings = Settings { criteria, ..self.case.settings.clone() };
        let diagnosis = self.diagnose(&settings);
        Answer {
            schema: SCHEMA.into(),
            armtwin: env!("CARGO_PKG_VERSION").into(),
            case: self.case.name.clone(),
            inputs: self.inputs.clone(),
            settings,
            conditioning: self.conditioning.clone(),
            failed: diagnosis.as_ref().err().cloned(),
            diagnosis: diagnosis.ok(),
            baselines: self.baselines.clone(),
        }
    }

    /// Position servos are explained by simulation, all else by torque.
    fn diagnose(&self, settings: &Settings) -> Result<Diagnosis, String> {
        let [fit, check] = &self.samples;
        match self.twin.drive.servo {
            Some(_) => servo::diagnose(&self.twin, [fit, check], settings, &())
                .map(|found| found.diagnosis)
                .map_err(|e| e.to_string()),
            None => diagnose(&self.twin, fit, check, settings).map_err(|e| e.to_string()),
        }
    }
}

/// Hashes of what the answerer was given.
fn inputs(folder: &Path) -> Result<BTreeMap<String, String>, TrialError> {
    let hash = |name: &str| {
        let file = folder.join(name);
        let bytes = fs::read(&file).map_err(TrialError::io(&file, "read"))?;
        Ok((name.to_string(), sha256(&bytes)))
    };
    let own = folder.join(ROBOT).exists().then_some(ROBOT);
    [FIT, CHECK, TWIN, SETTINGS].into_iter().chain(own).map(hash).collect()
}
