//! The third recording of a case: what its arm does without noise, sealed with the truth. Only the
//! score sees it.

use std::path::Path;

use super::seal::sealed_file;
use super::{Seals, TrialError};
use crate::recording::{Channel, Provenance, Recording, read, write_csv};
use crate::series::JointSeries;

/// Motion as the encoders show it, and the drive's torque.
#[derive(Debug, Clone, PartialEq)]
pub struct Third {
    pub time: Vec<f64>,
    /// rad, rad/s, rad/s^2, N.m, deg C
    pub q: JointSeries,
    pub qd: JointSeries,
    pub qdd: JointSeries,
    pub torque: JointSeries,
    pub temperature: JointSeries,
}

const STEMS: [&str; 5] =
    ["actual_q", "actual_qd", "actual_qdd", "joint_torque", "joint_temperatures"];

fn name(case: &str) -> String {
    format!("{case}.third.csv.gz")
}

/// # Errors
/// If it cannot be written.
pub fn write(third: &Third, dir: &Path, case: &str) -> Result<(), TrialError> {
    let series = [&third.q, &third.qd, &third.qdd, &third.torque, &third.temperature];
    let channel = |(stem, series): (&str, &JointSeries), j: usize| Channel {
        name: format!("{stem}_{j}"),
        values: series.joint(j).iter().map(|x| (x * 1e6).round() / 1e6).collect(),
    };
    let joints = third.q.joints();
    let both = STEMS.into_iter().zip(series);
    let recording = Recording {
        time: third.time.clone(),
        channels: both.flat_map(|both| (0..joints).map(move |j| channel(both, j))).collect(),
        provenance: Provenance::default(),
    };
    Ok(write_csv(&recording, &sealed_file(dir, &name(case)))?)
}

impl Third {
    /// The sealed recording of `case`.
    ///
    /// # Errors
    /// If it is gone or does not match its seal.
    pub fn open(seals: &Seals, dir: &Path, case: &str) -> Result<Self, TrialError> {
        let name = name(case);
        seals.open_file(dir, &name)?;
        let file = sealed_file(dir, &name);
        let recording = read(&file, None)?;
        let series = |stem: &str| {
            let missing = || TrialError::file(&file, format!("has no {stem}"));
            recording.joints(stem).ok_or_else(missing)
        };
        Ok(Self {
            q: series(STEMS[0])?,
            qd: series(STEMS[1])?,
            qdd: series(STEMS[2])?,
            torque: series(STEMS[3])?,
            temperature: series(STEMS[4])?,
            time: recording.time.clone(),
        })
    }
}
