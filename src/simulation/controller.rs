//! Computed torque (Siciliano et al., *Robotics: Modelling, Planning and Control*, 2009, section
//! 8.5.2) with the nominal arm and a friction feed-forward that is not quite right:
//!
//! ```text
//! u   = qdd_d + 2 D w (qd_d - qd) + w^2 (q_d - q)
//! tau = M(q) u + c(q, qd) + g(q) + rotor_inertia u + share friction(qd_d)
//! ```
//!
//! No integrator, as on purpose: where friction is fed forward wrongly a joint at rest keeps its
//! small error instead of hunting, and rest phases tell offset from asymmetric friction.

use crate::effects::{ControlChange, JointLoad, Mechanism};
use crate::motion::{Spline, Trajectory};
use crate::robot::{Robot, Workspace, inverse_dynamics};

/// The `[controller]` table of a scenario.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ControllerSettings {
    /// Torque is recomputed this often and held in between, Hz.
    pub rate_hz: f64,
    /// Natural frequency w of the tracking error, rad/s.
    pub bandwidth_rad_s: f64,
    /// Damping ratio D of the tracking error.
    pub damping_ratio: f64,
    /// Share of the injected friction (dry level and damping at the commanded speed) that the
    /// controller feeds forward: 1 knows it exactly, 0 knows of none.
    pub friction_feedforward: f64,
    pub feedback: Feedback,
}

/// What the controller sees of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Feedback {
    /// The true state.
    State,
    /// Position and velocity with the scenario's noise and quantisation.
    Sensors,
}

impl Default for ControllerSettings {
    fn default() -> Self {
        Self {
            rate_hz: 500.0,
            bandwidth_rad_s: 60.0,
            damping_ratio: 1.0,
            friction_feedforward: 0.9,
            feedback: Feedback::State,
        }
    }
}

impl ControllerSettings {
    /// The controller as it is, where the scenario's is the assumed one.
    pub(super) fn changed(&self, by: &ControlChange) -> Self {
        Self {
            bandwidth_rad_s: by.bandwidth * self.bandwidth_rad_s,
            damping_ratio: by.damping * self.damping_ratio,
            friction_feedforward: by.feedforward * self.friction_feedforward,
            ..self.clone()
        }
    }

    /// The rate is checked with the other rates, by the clock.
    pub(super) fn check(&self) -> Result<(), String> {
        let must = |key, value: f64, range: std::ops::RangeInclusive<f64>| {
            let (low, high) = (range.start(), range.end());
            let message = || format!("controller.{key} = {value}: give {low} to {high}");
            range.contains(&value).then_some(()).ok_or_else(message)
        };
        must("bandwidth_rad_s", self.bandwidth_rad_s, 0.0..=1000.0)?;
        must("damping_ratio", self.damping_ratio, 0.0..=10.0)?;
        must("friction_feedforward", self.friction_feedforward, 0.0..=2.0)
    }
}

/// Position, velocity and acceleration of every joint at one instant (rad, rad/s, rad/s^2).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Target {
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub qdd: Vec<f64>,
}

impl Target {
    pub fn still(dof: usize) -> Self {
        Self { q: vec![0.0; dof], qd: vec![0.0; dof], qdd: vec![0.0; dof] }
    }

    /// Where the commanded motion is at time `t` (s).
    pub fn aim(&mut self, command: &dyn Command, t: f64) {
        command.at(t, &mut self.q, &mut self.qd, &mut self.qdd);
    }
}

/// A motion the controller can be asked for.
pub trait Command {
    /// s
    fn duration(&self) -> f64;

    /// Position (rad), velocity (rad/s) and acceleration (rad/s^2) of all joints, `t` s after
    /// the start.
    fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]);
}

impl Command for Trajectory {
    fn duration(&self) -> f64 {
        self.duration()
    }

    fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.at(t, q, qd, qdd);
    }
}

/// A recorded motion, driven again.
impl Command for Spline {
    fn duration(&self) -> f64 {
        self.end() - self.start()
    }

    fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        self.at(self.start() + t, q, qd, qdd);
    }
}

/// Below about this commanded speed the fed-forward dry friction fades, rad/s: a sign function
/// would kick a joint at every reversal.
const FADE_RAD_S: f64 = 0.01;

/// The controller and its buffers; without memory from one call to the next.
pub struct ComputedTorque {
    robot: Robot,
    rotor_inertia: Vec<f64>,
    settings: ControllerSettings,
    workspace: Workspace,
    u: Vec<f64>,
}

impl ComputedTorque {
    /// For the arm as the controller knows it: the nominal one.
    pub fn new(nominal: &Mechanism, settings: ControllerSettings) -> Self {
        Self {
            robot: nominal.robot.clone(),
            rotor_inertia: nominal.armature.clone(),
            settings,
            workspace: Workspace::new(&nominal.robot),
            u: vec![0.0; nominal.robot.dof()],
        }
    }

    pub fn settings(&self) -> &ControllerSettings {
        &self.settings
    }

    /// Motor torque (N.m at the joint) towards `target` from the measured `q` and `qd`; `friction`
    /// is what the injected effects do at the commanded velocity.
    pub fn torque(
        &mut self,
        target: &Target,
        q: &[f64],
        qd: &[f64],
        friction: &[JointLoad],
        tau: &mut [f64],
    ) {
        let ControllerSettings { bandwidth_rad_s: w, damping_ratio, .. } = self.settings;
        for (j, u) in self.u.iter_mut().enumerate() {
            let (error, error_rate) = (target.q[j] - q[j], target.qd[j] - qd[j]);
            *u = target.qdd[j] + 2.0 * damping_ratio * w * error_rate + w * w * error;
        }
        inverse_dynamics(&self.robot, &mut self.workspace, q, qd, &self.u, tau);
        for (j, tau) in tau.iter_mut().enumerate() {
            let load = friction[j].dry * (target.qd[j] / FADE_RAD_S).tanh()
                + friction[j].damping * target.qd[j];
            *tau += self.rotor_inertia[j] * self.u[j] + self.settings.friction_feedforward * load;
        }
    }

    /// What the nominal arm without friction would need along the target (RTDE's target_moment).
    pub fn target_moment(&mut self, target: &Target, tau: &mut [f64]) {
        let Target { q, qd, qdd } = target;
        inverse_dynamics(&self.robot, &mut self.workspace, q, qd, qdd, tau);
        for (j, tau) in tau.iter_mut().enumerate() {
            *tau += self.rotor_inertia[j] * qdd[j];
        }
    }
}
