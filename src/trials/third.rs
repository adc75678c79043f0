//! The third recording of a case: what its arm does without noise, sealed with the truth. Only the
//! score sees it.

use std::path::Path;

use super::seal::sealed_file;
use super::{Seals, TrialError};
use crate::motion::{MotionError, Settings, Trajectory};
use crate::recording::{Channel, Provenance, Recording, read, write_csv};
use crate::robot::Robot;
use crate::series::JointSeries;

/// Of an arm whose torque is recorded: motion as the encoders show it, and the drive's torque; rad, rad/s, rad/s^2, N.m,
/// deg C.
pub const BY_TORQUE: [&str; 5] =
    ["actual_q", "actual_qd", "actual_qdd", "joint_torque", "joint_temperatures"];

/// What is written is rounded to this, of a radian as of a newton metre.
const STEPS: f64 = 1e6;
const SHORTEST_S: f64 = 6.0;

/// Another motion than those of the fit and the check recording, half as long as they are (s).
///
/// # Errors
/// If the arm's settings do not work out.
pub fn motion(fit: &Settings, duration_s: f64, robot: &Robot) -> Result<Trajectory, MotionError> {
    let duration_s = (0.5 * duration_s).max(SHORTEST_S);
    let third = Settings { seed: fit.seed.wrapping_add(2), duration_s, ..fit.clone() };
    third.trajectory(robot)
}

fn name(case: &str) -> String {
    format!("{case}.third.csv.gz")
}

/// A recording of [`BY_TORQUE`], every joint at every time (s).
pub fn by_torque(time: &[f64], series: [&JointSeries; 5]) -> Recording {
    let channel = |(stem, series): (&str, &JointSeries), j: usize| Channel {
        name: format!("{stem}_{j}"),
        values: series.joint(j).to_vec(),
    };
    let joints = series[0].joints();
    let both = BY_TORQUE.into_iter().zip(series);
    Recording {
        time: time.to_vec(),
        channels: both.flat_map(|both| (0..joints).map(move |j| channel(both, j))).collect(),
        provenance: Provenance::default(),
    }
}

/// Seals the third recording of `case`, its values rounded.
///
/// # Errors
/// If it cannot be written.
pub fn write(mut recording: Recording, dir: &Path, case: &str) -> Result<(), TrialError> {
    let values = recording.channels.iter_mut().flat_map(|c| &mut c.values);
    values.for_each(|x| *x = (*x * STEPS).round() / STEPS);
    Ok(write_csv(&recording, &sealed_file(dir, &name(case)))?)
}

/// The sealed recording of `case`.
///
/// # Errors
/// If it is gone or does not match its seal.
pub fn open(seals: &Seals, dir: &Path, case: &str) -> Result<Recording, TrialError> {
    let name = name(case);
    seals.open_file(dir, &name)?;
    Ok(read(&sealed_file(dir, &name), None)?)
}
