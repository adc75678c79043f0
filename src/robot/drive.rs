//! From motor current to joint torque and back, or from a commanded angle to joint torque.

use super::{RobotError, Servo};
use crate::series::JointSeries;

/// In SI units no quantity of a drive is larger, nor is its inverse.
const LARGEST: f64 = 1e9;

/// One entry per joint, base to wrist.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Drive {
    /// Motor turns per joint turn.
    pub gear_ratio: Vec<f64>,
    /// N.m/A on the motor side.
    pub torque_constant: Vec<f64>,
    /// kg.m2 as seen at the joint (rotor inertia x gear ratio squared).
    pub rotor_inertia: Vec<f64>,
    /// Largest motor current, A; `None` is unlimited.
    pub current_limit: Option<Vec<f64>>,
    /// Largest joint torque, N.m; `None` is unlimited.
    pub torque_limit: Option<Vec<f64>>,
    /// Where the motors are position servos.
    pub servo: Option<Servo>,
}

/// What a drive holds of an effect, one value per joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrivePart {
    RotorInertia,
}

impl Drive {
    pub fn part(&self, part: DrivePart) -> &Vec<f64> {
        match part {
            DrivePart::RotorInertia => &self.rotor_inertia,
        }
    }

    pub fn part_mut(&mut self, part: DrivePart) -> &mut Vec<f64> {
        match part {
            DrivePart::RotorInertia => &mut self.rotor_inertia,
        }
    }

    /// A drive without rotor inertia and limits.
    pub fn new(gear_ratio: Vec<f64>, torque_constant: Vec<f64>) -> Self {
        let rotor_inertia = vec![0.0; gear_ratio.len()];
        Self {
            gear_ratio,
            torque_constant,
            rotor_inertia,
            current_limit: None,
            torque_limit: None,
            servo: None,
        }
    }

    /// The paper's UR5 (section 4.2: gear ratio 101 and torque constants of the six motors).
    pub fn ur5() -> Self {
        Self::new(vec![101.0; 6], vec![0.135, 0.136, 0.135, 0.095, 0.086, 0.089])
    }

    /// The published drive of a built-in arm; there is one for the UR5 only.
    ///
    /// # Errors
    /// For every other arm, saying what the twin must give.
    pub fn for_robot(name: &str, dof: usize) -> Result<Self, RobotError> {
        match name {
            "ur5" | "ur5-as-printed" if dof == 6 => Ok(Self::ur5()),
            _ => Err(RobotError::Drive(format!(
                "no torque constants are published for `{name}`; give gear_ratio and \
                 torque_constant (N.m/A, one per joint or one for all) under [drive]; any will do, \
                 say 1, where recordings have joint_torque_* columns"
            ))),
        }
    }

    pub fn dof(&self) -> usize {
        self.gear_ratio.len()
    }

    /// N.m at the joint per A in the motor.
    pub fn torque_per_ampere(&self, joint: usize) -> f64 {
        self.gear_ratio[joint] * self.torque_constant[joint]
    }

    /// Joint torque, N.m, of a motor current, A.
    pub fn torque(&self, joint: usize, current: f64) -> f64 {
        current * self.torque_per_ampere(joint)
    }

    /// Motor current, A, for a joint torque, N.m.
    pub fn current(&self, joint: usize, torque: f64) -> f64 {
        torque / self.torque_per_ampere(joint)
    }

    /// The joint torque the drive delivers when `torque` is asked for, N.m.
    pub fn limited(&self, joint: usize, torque: f64) -> f64 {
        let largest = self.largest_torque(joint);
        torque.clamp(-largest, largest)
    }

    /// N.m at the joint, infinite without limits.
    pub fn largest_torque(&self, joint: usize) -> f64 {
        let of = |limit: &Option<Vec<f64>>| limit.as_ref().map_or(f64::INFINITY, |l| l[joint]);
        let by_current = of(&self.current_limit) * self.torque_per_ampere(joint);
        by_current.min(of(&self.torque_limit))
    }

    /// Joint torques, N.m, of motor currents, A.
    pub fn torque_series(&self, current: &JointSeries) -> JointSeries {
        current.map_joints(|j, i| i.iter().map(|&i| self.torque(j, i)).collect())
    }

    /// Motor currents, A, for joint torques, N.m.
    pub fn current_series(&self, torque: &JointSeries) -> JointSeries {
        torque.map_joints(|j, t| t.iter().map(|&t| self.current(j, t)).collect())
    }

    /// Does it fit an arm of `dof` joints?
    ///
    /// # Errors
    /// Names the key of the twin's `[drive]` whose values are wrong, and the joint.
    pub fn check(&self, dof: usize) -> Result<(), RobotError> {
        let empty = Vec::new();
        let positive = |x: f64| x > 0.0 && x <= LARGEST;
        let factor = |x: f64| positive(x) && x >= 1.0 / LARGEST;
        let keys: [(&str, &Vec<f64>, bool); 5] = [
            ("gear_ratio", &self.gear_ratio, true),
            ("torque_constant", &self.torque_constant, true),
            ("rotor_inertia", &self.rotor_inertia, true),
            ("current_limit", self.current_limit.as_ref().unwrap_or(&empty), false),
            ("torque_limit", self.torque_limit.as_ref().unwrap_or(&empty), false),
        ];
        for (key, values, required) in keys {
            if values.len() != dof && (required || !values.is_empty()) {
                return Err(RobotError::Drive(format!(
                    "{key} has {} values for an arm of {dof} joints; give one per joint",
                    values.len()
                )));
            }
            let fine = |x: f64| match key {
                "rotor_inertia" => x == 0.0 || positive(x),
                "gear_ratio" | "torque_constant" => factor(x),
                _ => positive(x),
            };
            if let Some(joint) = values.iter().position(|&x| !fine(x)) {
                return Err(RobotError::Drive(format!(
                    "{key} of joint {} is {:e}; give a positive number of {LARGEST:e} at most",
                    joint + 1,
                    values[joint]
                )));
            }
        }
        self.servo.as_ref().map_or(Ok(()), |servo| servo.check(dof))
    }
}
