//! What an effect sees and does in one step of a simulation.

use crate::robot::Robot;

/// The arm at the start of a simulation step; one entry per joint in every slice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmState<'a> {
    pub robot: &'a Robot,
    /// s since the start, and the length of the step.
    pub time: f64,
    pub dt: f64,
    /// rad, rad/s; on the motor's side where the transmission gives way.
    pub q: &'a [f64],
    pub qd: &'a [f64],
    /// Torque through the gear in the last step without friction, N.m.
    pub transmitted: &'a [f64],
    /// deg C
    pub temperature: &'a [f64],
}

/// One joint of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointState<'a> {
    /// From 0 at the base.
    pub joint: usize,
    pub time: f64,
    pub dt: f64,
    pub q: f64,
    pub qd: f64,
    pub transmitted: f64,
    pub temperature: f64,
    /// All joints.
    pub arm: &'a ArmState<'a>,
}

impl ArmState<'_> {
    pub fn joint(&self, joint: usize) -> JointState<'_> {
        JointState {
            joint,
            time: self.time,
            dt: self.dt,
            q: self.q[joint],
            qd: self.qd[joint],
            transmitted: self.transmitted[joint],
            temperature: self.temperature[joint],
            arm: self,
        }
    }
}

/// What acts on a joint during a simulation step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointLoad {
    /// Level of dry friction, N.m, >= 0 in sum: opposes motion, holds when standing.
    pub dry: f64,
    /// N.m.s/rad, multiplies the velocity of this step.
    pub damping: f64,
    /// N.m the drive must overcome, whatever the direction of motion.
    pub torque: f64,
}
