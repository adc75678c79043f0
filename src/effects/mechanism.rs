//! What effects change before the first step.

use super::hysteresis::dahl;
use crate::robot::{Robot, Servo};

/// What a simulation is built from. Vectors have one entry per joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    pub robot: Robot,
    /// kg.m2 added to each joint's diagonal (reflected rotor inertia).
    pub armature: Vec<f64>,
    /// What the encoder shows where the joint is at zero, rad: controller and recording see it.
    pub encoder_zero: Vec<f64>,
    /// What the current shows, and the controller believes, per N.m the motor gives; 1 is right.
    pub torque_gain: Vec<f64>,
    /// Largest torque of the motor at the joint, N.m; infinite without limit.
    pub torque_limit: Vec<f64>,
    /// Transmission between motor and link of each joint; `None` is rigid.
    pub transmission: Vec<Option<Transmission>>,
    pub control: ControlChange,
    /// What position servos are other than assumed.
    pub servo: Vec<ServoChange>,
}

/// An elastic or slack transmission. The link hangs on the motor by the torque of the wind-up
/// w = q_motor - q_link beyond half the gap, x = dead(w, gap/2):
/// tau = K x + K3 x^3 + damping wd + hysteresis z(w), with z after Dahl.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Transmission {
    /// K, N.m/rad
    pub stiffness: f64,
    /// K3, N.m/rad^3
    pub hardening: f64,
    /// N.m.s/rad, where the teeth touch
    pub damping: f64,
    /// Backlash of the teeth, both directions together, rad.
    pub gap: f64,
    /// N.m
    pub hysteresis: f64,
    /// Wind-up over which the hysteresis saturates, rad.
    pub hysteresis_width: f64,
}

impl Transmission {
    /// Elastic torque of a wind-up (rad), N.m.
    pub fn torque(&self, wind_up: f64) -> f64 {
        let x = self.beyond_gap(wind_up);
        self.stiffness * x + self.hardening * x * x * x
    }

    /// Does it carry K w + damping wd, and no more?
    pub(super) fn is_linear(&self) -> bool {
        self.gap == 0.0 && self.hardening == 0.0 && self.hysteresis == 0.0
    }

    /// N.m.s/rad at a wind-up (rad): none while nothing touches.
    pub fn damping_at(&self, wind_up: f64) -> f64 {
        if self.touches(wind_up) { self.damping } else { 0.0 }
    }

    pub(super) fn touches(&self, wind_up: f64) -> bool {
        self.gap == 0.0 || self.beyond_gap(wind_up) != 0.0
    }

    /// The side on which teeth touch at a wind-up (rad), -1 or 1; 0 in the gap. A spring always carries.
    pub fn side(&self, wind_up: f64) -> f64 {
        if self.touches(wind_up) { wind_up.signum() } else { 0.0 }
    }

    /// Elastic torque over wind-up beyond the gap, N.m/rad, at a wind-up (rad).
    pub fn stiffness_at(&self, wind_up: f64) -> f64 {
        self.stiffness + self.hardening * self.beyond_gap(wind_up).powi(2)
    }

    /// Slope of the hysteresis at its centre, N.m/rad.
    pub fn bending(&self) -> f64 {
        if self.hysteresis > 0.0 {
            self.hysteresis / self.hysteresis_width.max(f64::MIN_POSITIVE)
        } else {
            0.0
        }
    }

    /// The state of the hysteresis, -1 to 1, after a wind-up by `dw` (rad) more.
    pub fn bent(&self, z: f64, dw: f64) -> f64 {
        if self.hysteresis > 0.0 { dahl(z, dw, self.hysteresis_width) } else { z }
    }

    /// Stiffness at small wind-ups with the hysteresis, N.m/rad.
    pub(super) fn stiffest(&self) -> f64 {
        self.stiffness + self.bending()
    }

    /// These teeth before an elastic joint: one spring after the other, and what else that has itself.
    pub(super) fn before(self, elastic: Option<Self>) -> Self {
        let Some(elastic) = elastic else { return self };
        let stiffness = 1.0 / (1.0 / elastic.stiffness + 1.0 / self.stiffness);
        Self { stiffness, gap: self.gap, ..elastic }
    }

    fn beyond_gap(&self, wind_up: f64) -> f64 {
        wind_up - wind_up.clamp(-0.5 * self.gap, 0.5 * self.gap)
    }

    /// The wind-up that holds `torque` (N.m) still, rad, by bisection of the increasing law.
    pub fn wind_up(&self, torque: f64) -> f64 {
        let (mut low, mut high) = (0.0, 0.5 * self.gap + torque.abs() / self.stiffness);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let enough = self.torque(middle) >= torque.abs();
            *(if enough { &mut high } else { &mut low }) = middle;
        }
        high * torque.signum()
    }
}

/// How the true controller differs from the one the twin assumes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlChange {
    /// Factors on bandwidth, damping ratio and friction feed-forward.
    pub bandwidth: f64,
    pub damping: f64,
    pub feedforward: f64,
    /// Delay of the torque behind its computation, s.
    pub delay: f64,
}

impl Default for ControlChange {
    fn default() -> Self {
        Self { bandwidth: 1.0, damping: 1.0, feedforward: 1.0, delay: 0.0 }
    }
}

/// A position servo as it is, where another one is assumed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoChange {
    /// Factors on the gain and on the largest torque.
    pub gain: f64,
    pub max_torque: f64,
    /// Added: N.m.s/rad, a share of the motor's torque, rad, s, rad.
    pub damping: f64,
    pub friction: f64,
    pub dead_band: f64,
    pub delay: f64,
    pub offset: f64,
}

impl Default for ServoChange {
    fn default() -> Self {
        Self {
            gain: 1.0,
            max_torque: 1.0,
            damping: 0.0,
            friction: 0.0,
            dead_band: 0.0,
            delay: 0.0,
            offset: 0.0,
        }
    }
}

impl Mechanism {
    /// The servos as they are where `assumed` are assumed.
    pub fn servos(&self, assumed: &Servo) -> Servo {
        let mut servo = assumed.clone();
        for (j, change) in self.servo.iter().enumerate() {
            servo.gain[j] *= change.gain;
            servo.damping[j] += change.damping;
            servo.friction[j] += change.friction;
            servo.dead_band[j] += change.dead_band;
            servo.delay[j] += change.delay;
            servo.offset[j] += change.offset;
            let limit = change.max_torque * servo.max_torque[j];
            servo.max_torque[j] = limit.min(self.torque_limit[j]);
        }
        servo
    }

    /// The robot with ideal drives.
    pub fn new(robot: Robot) -> Self {
        let n = robot.dof();
        Self {
            robot,
            armature: vec![0.0; n],
            encoder_zero: vec![0.0; n],
            torque_gain: vec![1.0; n],
            torque_limit: vec![f64::INFINITY; n],
            transmission: vec![None; n],
            control: ControlChange::default(),
            servo: vec![ServoChange::default(); n],
        }
    }

    /// The robot with the rotor inertia of its drives, kg.m2.
    pub fn with_armature(robot: Robot, armature: Vec<f64>) -> Self {
        Self { armature, ..Self::new(robot) }
    }

    /// A joint gives way by a law; not at all where the gap or the compliance is none.
    pub(super) fn give_way(&mut self, joint: usize, size: f64, law: Transmission) {
        if size > 0.0 {
            self.transmission[joint] = Some(law);
        }
    }
}
