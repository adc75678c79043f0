//! What an effect is explained with.

use crate::robot::{Robot, inverse_dynamics_series};
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
    /// What is known of the drive's torque without the effect in question, N.m: see
    /// [`Motion::drive_torque`].
    pub known: Option<&'a JointSeries>,
}

impl<'a> Motion<'a> {
    /// Motion from time 0, without temperatures.
    pub fn new(
        robot: &'a Robot,
        dt: f64,
        q: &'a JointSeries,
        qd: &'a JointSeries,
        qdd: &'a JointSeries,
    ) -> Self {
        Self { robot, start: 0.0, dt, q, qd, qdd, temperature: None, known: None }
    }

    pub fn samples(&self) -> usize {
        self.q.samples()
    }

    /// Of sample `k`, s.
    pub fn time(&self, k: usize) -> f64 {
        self.start + k as f64 * self.dt
    }

    /// What the gears carry, N.m: the torque of the rigid robot.
    pub fn rigid_torque(&self) -> JointSeries {
        inverse_dynamics_series(self.robot, self.q, self.qd, self.qdd)
    }

    /// What is known of the drive's torque, N.m; the rigid robot's where nothing else is.
    pub fn drive_torque(&self) -> JointSeries {
        self.known.cloned().unwrap_or_else(|| self.rigid_torque())
    }
}
