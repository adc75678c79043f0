//! What an effect is explained with.

use std::borrow::Cow;

use super::Transmission;
use super::flange::Flange;
use super::rigid::{self, Regressor, Rigid, Slopes};
use crate::robot::{Robot, Told};
use crate::series::JointSeries;

/// Conditioned motion of all joints, and the arm it belongs to.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    pub robot: &'a Robot,
    /// Time of the first sample in the recording, s.
    pub start: f64,
    /// Time between samples, s.
    pub dt: f64,
    /// rad, rad/s, rad/s^2
    pub q: &'a JointSeries,
    pub qd: &'a JointSeries,
    pub qdd: &'a JointSeries,
    /// deg C, where known.
    pub temperature: Option<&'a JointSeries>,
    /// Highest frequency at which torques are compared, Hz; infinite without a filter.
    pub band_hz: f64,
    /// What is known of the drive's torque without the effect in question, N.m: see
    /// [`Motion::drive_torque`].
    pub known: Option<&'a JointSeries>,
    /// Transmissions of `robot` that are known to give way, by joint; empty where all are rigid.
    pub giving: &'a [Option<Transmission>],
    /// Rigid torque of `robot` along this motion, kept for the next candidate; `None` works it out each time.
    pub rigid: Option<&'a Rigid>,
    /// What position servos were told, where the arm has such.
    pub told: Option<&'a Told>,
    /// Turns of each motor per turn of its joint; empty where that is not known.
    pub gear_ratio: &'a [f64],
}

impl<'a> Motion<'a> {
    /// Motion from time 0, without temperatures or filter.
    pub fn new(
        robot: &'a Robot,
        dt: f64,
        q: &'a JointSeries,
        qd: &'a JointSeries,
        qdd: &'a JointSeries,
    ) -> Self {
        Self {
            robot,
            start: 0.0,
            dt,
            q,
            qd,
            qdd,
            temperature: None,
            band_hz: f64::INFINITY,
            known: None,
            giving: &[],
            rigid: None,
            told: None,
            gear_ratio: &[],
        }
    }

    pub fn samples(&self) -> usize {
        self.q.samples()
    }

    /// Time of sample `k`, s.
    pub fn time(&self, k: usize) -> f64 {
        self.start + k as f64 * self.dt
    }

    /// What the gears carry, N.m: the torque of the rigid robot.
    pub fn rigid_torque(&self) -> Cow<'a, JointSeries> {
        match self.rigid {
            Some(kept) => Cow::Borrowed(kept.torque(self.robot, self.series())),
            None => Cow::Owned(rigid::torque(self.robot, self.series())),
        }
    }

    /// Slopes of that torque over the motion of `joint`.
    pub fn slopes(&self, joint: usize) -> Cow<'a, Slopes> {
        match self.rigid {
            Some(kept) => Cow::Borrowed(kept.slopes(self.robot, self.series(), joint)),
            None => Cow::Owned(Slopes::new(self.robot, self.series(), joint)),
        }
    }

    /// Torque of every joint per unit of the inertial parameters of `link`.
    pub fn regressor(&self, link: usize) -> Cow<'a, Regressor> {
        match self.rigid {
            Some(kept) => Cow::Borrowed(kept.regressor(self.robot, self.series(), link)),
            None => Cow::Owned(rigid::regressor(self.robot, self.series(), link)),
        }
    }

    /// Where the flange goes.
    pub fn flange(&self) -> Cow<'a, Flange> {
        match self.rigid {
            Some(kept) => Cow::Borrowed(kept.flange(self.robot, self.q)),
            None => Cow::Owned(Flange::along(self.robot, self.q)),
        }
    }

    fn series(&self) -> [&'a JointSeries; 3] {
        [self.q, self.qd, self.qdd]
    }

    /// What is known of the drive's torque, N.m; the rigid robot's where nothing else is.
    pub fn drive_torque(&self) -> JointSeries {
        self.known.cloned().unwrap_or_else(|| self.rigid_torque().into_owned())
    }
}
