//! The catalogue of physical effects: one file each, used to inject and to explain.
//!
//! Sign convention: an effect's torque is what the drive must supply in addition to rigid-body
//! inverse dynamics, tau_motor = ID(q, qd, qdd) + sum of effects.

mod catalogue;
mod coulomb;
mod current_offset;
mod load_friction;
mod payload;
mod rotor_inertia;
mod stribeck;
mod viscous;
mod viscous_cubic;
mod viscous_quadratic;

#[cfg(test)]
mod tests;

pub use catalogue::{CATALOGUE, find, names};

use crate::robot::Robot;
use crate::series::JointSeries;

/// What a parameter is; data, so that command line, docs, scenario keys and tests follow from it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Key in scenario files and JSON, for example `coulomb`.
    pub name: &'static str,
    pub symbol: &'static str,
    pub unit: &'static str,
    /// Physical bounds, both attainable.
    pub min: f64,
    pub max: f64,
    /// Of a UR5-class joint.
    pub typical: f64,
    /// The value at which the effect vanishes.
    pub null: f64,
    pub role: Role,
}

/// How a parameter enters the torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    Linear,
    Nonlinear,
}

/// Does every joint have its own parameters or does the arm share one set?
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    Joint,
    Arm,
}

#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct About {
    pub name: &'static str,
    /// What the drive must supply, N.m, in the symbols of the parameters.
    pub law: &'static str,
    pub scope: Scope,
    /// Linear parameters first, in the order of the columns.
    pub parameters: &'static [Parameter],
    /// How many numbers [`Effect::act`] remembers per joint from step to step.
    pub memory: usize,
    /// Never gives energy to the arm, for any values within the bounds: tau qd >= 0.
    pub dissipates: bool,
    /// One line each, for people.
    pub cause: &'static str,
    pub remedy: &'static str,
    /// Paper, section, equation.
    pub source: &'static str,
}

/// A physical effect: the contract a new file in this folder implements, plus one line in
/// [`CATALOGUE`]. Everything but `about` and `columns` has a default; an effect implements the
/// hooks where it acts:
///
/// * in the mechanism before the first step (inertia, payload, tilt, encoder zero, limits,
///   elastic or slack transmission): [`build`](Effect::build); what it changes is a field of
///   [`Mechanism`];
/// * in every step (friction, ripple, spring): [`act`](Effect::act); what it reads is a field of
///   [`JointState`], what it remembers is its memory.
///
/// `columns` explains the same physics from conditioned motion. An effect that inverse dynamics
/// cannot see returns columns of zeros. A hook on the measured channels (gain, delay, lag,
/// quantisation) is to come with the first effect that needs one; it will have a default, too.
pub trait Effect: Sync {
    fn about(&self) -> &'static About;

    /// Explain: N.m at `joint` per unit of each linear parameter, one column of
    /// `motion.samples()` values per linear parameter, for given nonlinear parameters.
    /// Of an effect on the whole arm every joint has its columns, the parameters are shared.
    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>>;

    /// Inject: what the effect adds to `load` at one joint in one step, for parameter values in
    /// the order of [`About::parameters`]. Sliding laws only fill in dry level and damping; the
    /// simulation's constraint solver makes them stick. `memory` holds [`About::memory`] numbers
    /// of this effect at this joint, zero before the first step, kept from step to step.
    fn act(
        &self,
        _values: &[f64],
        _state: &JointState,
        _memory: &mut [f64],
        _load: &mut JointLoad,
    ) {
    }

    /// Inject: what changes in the mechanism before the first step. Called once per joint that
    /// has the effect; for an effect on the whole arm once, with `joint` 0.
    fn build(&self, _values: &[f64], _joint: usize, _mechanism: &mut Mechanism) {}
}

/// Conditioned motion that an effect is explained with, and the arm it belongs to.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    pub robot: &'a Robot,
    /// Time between samples, s.
    pub dt: f64,
    /// rad, rad/s, rad/s^2
    pub q: &'a JointSeries,
    pub qd: &'a JointSeries,
    pub qdd: &'a JointSeries,
    /// deg C, where known.
    pub temperature: Option<&'a JointSeries>,
}

impl<'a> Motion<'a> {
    /// Motion without temperatures.
    pub fn new(
        robot: &'a Robot,
        dt: f64,
        q: &'a JointSeries,
        qd: &'a JointSeries,
        qdd: &'a JointSeries,
    ) -> Self {
        Self { robot, dt, q, qd, qdd, temperature: None }
    }

    pub fn samples(&self) -> usize {
        self.q.samples()
    }
}

/// A joint at the start of a simulation step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState {
    /// s since the start, and the length of the step.
    pub time: f64,
    pub dt: f64,
    pub q: f64,
    pub qd: f64,
    /// Torque through the gear in the last step without friction, N.m.
    pub transmitted: f64,
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

/// What a simulation is built from; effects change it before the first step.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    pub robot: Robot,
    /// kg.m2 added to each joint's diagonal (reflected rotor inertia).
    pub armature: Vec<f64>,
}

impl Mechanism {
    /// The robot with ideal drives.
    pub fn new(robot: Robot) -> Self {
        Self { armature: vec![0.0; robot.dof()], robot }
    }
}
