//! A stretch of motion: torque measured, torque predicted, and where the difference counts.

use std::ops::Range;

use super::WatchError;
use crate::diagnosis::conditioning;
use crate::recording::Recording;
use crate::robot::inverse_dynamics_series;
use crate::series::JointSeries;
use crate::signals::{condition, thin};
use crate::twin::Twin;

/// All joints over some seconds.
#[derive(Debug, Clone)]
pub struct Stretch {
    /// s, in the clock of the rows.
    pub time: Vec<f64>,
    pub dt: f64,
    /// rad, rad/s
    pub q: JointSeries,
    pub qd: JointSeries,
    /// N.m: as recorded, and the twin's.
    pub measured: JointSeries,
    pub predicted: JointSeries,
    /// What the gears carry, N.m.
    pub load: JointSeries,
    /// Sliding, and beside no gap; joint by joint.
    pub counts: Vec<Vec<bool>>,
    /// Mean over the stretch, deg C, where recorded.
    pub temperature_c: Option<Vec<f64>>,
}

impl Stretch {
    /// The whole recording, or the part of it that is in `core`, s.
    ///
    /// # Errors
    /// If the recording cannot be conditioned.
    pub fn of(
        recording: &Recording,
        core: Option<&Range<f64>>,
        twin: &Twin,
    ) -> Result<Self, WatchError> {
        let dof = twin.robot.dof();
        let thinned = thin(recording, 0.0);
        let recording = thinned.as_ref().unwrap_or(recording);
        let how = conditioning(recording, dof);
        let samples = twin.correct(&condition(recording, &twin.drive, dof, &how)?);
        let predicted = twin.torque(&twin.motion(&samples));
        let load = inverse_dynamics_series(&twin.laden(), &samples.q, &samples.qd, &samples.qdd);
        let within = |k: &usize| core.is_none_or(|core| core.contains(&samples.time(*k)));
        let kept: Vec<usize> = (0..samples.len()).filter(within).collect();
        let (first, last) = (kept.first().copied().unwrap_or(0), kept.last().map_or(0, |k| k + 1));
        let part = |s: &JointSeries| s.map_joints(|_, x| x[first..last].to_vec());
        let mean = |x: &[f64]| x[first..last].iter().sum::<f64>() / (last - first).max(1) as f64;
        let temperature = samples.temperature.as_ref();
        Ok(Self {
            time: kept.iter().map(|&k| samples.time(k)).collect(),
            dt: samples.dt,
            q: part(&samples.q),
            qd: part(&samples.qd),
            measured: part(&samples.torque),
            predicted: part(&predicted),
            load: part(&load),
            counts: (0..dof).map(|j| samples.mask(j)[first..last].to_vec()).collect(),
            temperature_c: temperature.map(|t| (0..dof).map(|j| mean(t.joint(j))).collect()),
        })
    }

    pub fn joints(&self) -> usize {
        self.q.joints()
    }

    pub fn len(&self) -> usize {
        self.time.len()
    }

    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Torque measured less the twin's, N.m.
    pub fn left(&self, joint: usize, k: usize) -> f64 {
        self.measured.joint(joint)[k] - self.predicted.joint(joint)[k]
    }
}
