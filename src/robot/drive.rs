//! From motor current to joint torque and back.

/// One entry per joint, base to wrist.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Drive {
    /// Motor turns per joint turn.
    pub gear_ratio: Vec<f64>,
    /// N.m/A on the motor side.
    pub torque_constant: Vec<f64>,
    /// kg.m2 as seen at the joint (rotor inertia x gear ratio squared).
    pub rotor_inertia: Vec<f64>,
}

impl Drive {
    /// N.m at the joint per A in the motor.
    pub fn torque_per_ampere(&self, joint: usize) -> f64 {
        self.gear_ratio[joint] * self.torque_constant[joint]
    }
}
