//! The `[bag]` table of a column map: what a bag's messages do not say of themselves.

use serde::Deserialize;

use crate::recording::scale::Scale;

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BagMap {
    /// Needed where a bag has joint states on more than one topic.
    pub topic: Option<String>,
    /// Names from base to wrist; found by name if left out.
    pub joints: Option<Vec<String>>,
    /// Found by gravity if left out.
    pub effort: Option<Effort>,
    /// Amperes or N.m per unit of effort.
    pub effort_scale: Scale,
    pub time: Clock,
    /// The arm whose gravity tells current from torque; a built-in name or a URDF.
    pub robot: Option<String>,
    /// Links of the URDF between which the arm is, if the robot is more than an arm.
    pub base: Option<String>,
    pub tip: Option<String>,
}

/// What the sender put into `effort`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// A
    Current,
    /// N.m at the joint
    Torque,
}

impl Effort {
    pub fn stem(self) -> &'static str {
        match self {
            Effort::Current => "actual_current",
            Effort::Torque => "joint_torque",
        }
    }

    /// With its unit.
    pub fn words(self) -> &'static str {
        match self {
            Effort::Current => "motor current, A",
            Effort::Torque => "torque, N.m",
        }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// When the joints were measured, by the sender.
    #[default]
    Header,
    /// When the recorder wrote the message.
    Log,
}

impl BagMap {
    /// What is wrong with it.
    pub fn check(&self) -> Result<(), String> {
        let joints = self.joints.as_deref().unwrap_or_default();
        if let Some(twice) = joints.iter().enumerate().find(|(k, j)| joints[..*k].contains(j)) {
            return Err(format!("bag.joints names {:?} twice", twice.1));
        }
        if self.joints.is_some() && joints.is_empty() {
            return Err("bag.joints is empty; name the joints from base to wrist".into());
        }
        let count = match (&self.effort_scale, joints.len()) {
            (Scale::Each(scales), 0) => scales.len(),
            (_, joints) => joints.max(1),
        };
        self.effort_scale.expand(count).map(drop).map_err(|e| format!("bag.effort_scale: {e}"))
    }
}
