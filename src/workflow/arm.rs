//! The arm that recordings are held against, and how it came to be known.

use std::path::PathBuf;

use super::WorkflowError;
use crate::plausibility::{self, Judgement};
use crate::recording::{Recording, settle_effort};
use crate::robot::Drive;
use crate::twin::Twin;

/// Who says which arm it is.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Said {
    /// A twin that was made by the caller.
    Given,
    /// The caller too, who said nothing of the drive of the arm of this name.
    Undriven(String),
    /// A `TWIN.toml`.
    Twin(PathBuf),
    /// A built-in name or a URDF: of its drive nothing was said.
    Robot(String),
    /// Nobody.
    Nothing,
}

/// The arm that recordings are held against.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Arm {
    pub twin: Twin,
    pub said: Said,
    /// Whether its torque constants are known.
    pub scaled: bool,
}

impl From<Twin> for Arm {
    fn from(twin: Twin) -> Self {
        Self { twin, said: Said::Given, scaled: true }
    }
}

impl From<&Twin> for Arm {
    fn from(twin: &Twin) -> Self {
        twin.clone().into()
    }
}

impl From<&Arm> for Arm {
    fn from(arm: &Arm) -> Self {
        arm.clone()
    }
}

impl Arm {
    pub fn assumed(&self) -> bool {
        self.said == Said::Nothing
    }

    /// Whether somebody said what the twin already models.
    pub fn has_twin(&self) -> bool {
        matches!(self.said, Said::Given | Said::Undriven(_) | Said::Twin(_))
    }

    /// Takes a bag's `effort` by the weight of this arm where nothing else told what it is; refuses what
    /// is not of this arm, or of an arm whose torque nobody can tell.
    ///
    /// # Errors
    /// Says which arm would do, or what is to be said of its drive.
    pub fn settle(&self, recording: &mut Recording) -> Result<(), WorkflowError> {
        self.refuse_other_joints(recording)?;
        if self.settles(recording) {
            settle_effort(recording, &self.twin.robot);
        }
        self.refuse_unknown_drive(recording)
    }

    /// Whether [`Arm::settle`] may change this recording.
    pub(super) fn settles(&self, recording: &Recording) -> bool {
        !self.assumed() && recording.channel("effort_0").is_some()
    }

    /// Whether the recording is what it says, and of this arm.
    pub fn judge(&self, recording: &Recording) -> Judgement {
        let Self { twin, scaled, .. } = self;
        let arm = plausibility::Arm { twin, assumed: self.assumed(), scaled: *scaled };
        plausibility::judge(recording, &arm)
    }

    pub(super) fn refuse_other_joints(&self, recording: &Recording) -> Result<(), WorkflowError> {
        let (joints, dof) = (recording.joint_count("actual_q"), self.twin.robot.dof());
        if joints == dof || joints == 0 {
            return Ok(());
        }
        let file = &recording.provenance.source;
        let name = &self.twin.source;
        let refused = match self.said {
            Said::Nothing => format!(
                "{file}: it has {joints} joints, and the {name} that is assumed where no arm is named \
                 has {dof}: name the arm, --robot NAME (see `armtwin robots`; or its URDF) or --twin FILE"
            ),
            _ => format!(
                "{file}: it has {joints} joints, the {name} has {dof}: name another arm (--robot, \
                 --twin), or the joints of this one in a column map (--columns)"
            ),
        };
        Err(WorkflowError::Arm(refused))
    }

    pub(super) fn refuse_unknown_drive(&self, recording: &Recording) -> Result<(), WorkflowError> {
        let (Said::Robot(name) | Said::Undriven(name)) = &self.said else { return Ok(()) };
        let published = Drive::for_robot(name, self.twin.robot.dof()).is_ok();
        let needs = recording.channel("actual_current_0").is_some()
            && recording.channel("joint_torque_0").is_none();
        if published || !needs {
            return Ok(());
        }
        Err(WorkflowError::Arm(format!(
            "{}: it holds motor currents, and no torque constants are published for the {name} (only for \
             the ur5): give them in a twin (--twin FILE with robot = \"{name}\" and a [drive] table: \
             gear_ratio, torque_constant in N.m/A), or record joint_torque_* in N.m",
            recording.provenance.source
        )))
    }
}
