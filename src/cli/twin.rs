//! The arm and the twin a command is given.

use std::path::{Path, PathBuf};

use anyhow::bail;

use super::out;
use crate::plausibility::{self, Judgement};
use crate::recording::{Recording, settle_effort};
use crate::robot::{Drive, RobotError};
use crate::twin::{Twin, TwinError};

/// The twin of a file, or the UR5; what was assumed about its robot is said.
pub fn load(path: Option<&Path>) -> Result<Twin, TwinError> {
    let twin = path.map_or_else(|| Ok(Twin::default()), Twin::load)?;
    out::notes(&twin.source, &twin.notes);
    Ok(twin)
}

/// Which arm a recording is of.
#[derive(clap::Args, Clone, Default)]
pub struct ArmArgs {
    /// What is known about the arm [default: the built-in UR5 with the paper's drive]
    #[arg(long, value_name = "TWIN.toml")]
    pub twin: Option<PathBuf>,
    /// The arm, where no twin is given: a name of `armtwin robots`, or a URDF [default: ur5]
    #[arg(long, value_name = "NAME", conflicts_with = "twin")]
    robot: Option<String>,
}

/// How the arm came to be known.
enum Said {
    Twin(PathBuf),
    Robot(String),
    Nothing,
}

/// The arm that recordings are held against.
pub struct Arm {
    pub twin: Twin,
    said: Said,
    /// Whether its torque constants are known.
    pub scaled: bool,
}

impl ArmArgs {
    pub fn load(&self) -> anyhow::Result<Arm> {
        let (twin, said) = match (&self.twin, &self.robot) {
            (Some(path), _) => (load(Some(path))?, Said::Twin(path.clone())),
            (None, Some(name)) => (named(name)?, Said::Robot(name.clone())),
            (None, None) => (load(None)?, Said::Nothing),
        };
        Ok(Arm { twin, said, scaled: true })
    }

    /// Whether somebody said which arm it is.
    pub fn given(&self) -> bool {
        self.twin.is_some() || self.robot.is_some()
    }

    /// As another command takes them; a leading blank.
    pub fn as_given(&self) -> String {
        match (&self.twin, &self.robot) {
            (Some(twin), _) => format!(" --twin {}", twin.display()),
            (None, Some(robot)) => format!(" --robot {robot}"),
            // Without one, every command takes the same.
            (None, None) => String::new(),
        }
    }
}

fn named(name: &str) -> Result<Twin, RobotError> {
    let twin = Twin::of_robot(name)?;
    out::notes(&twin.source, &twin.notes);
    Ok(twin)
}

impl Arm {
    /// The first line of what a command prints: which arm, and who says so.
    pub fn line(&self) -> String {
        let name = &self.twin.source;
        match &self.said {
            Said::Twin(path) => format!("arm: {name} (by {})", path.display()),
            Said::Robot(_) => format!("arm: {name} (by --robot)"),
            Said::Nothing => {
                format!("arm: {name} (assumed; --robot NAME or --twin FILE says otherwise)")
            }
        }
    }

    pub fn assumed(&self) -> bool {
        matches!(self.said, Said::Nothing)
    }

    /// Takes a bag's `effort` by the weight of this arm where nothing else told what it is; refuses what
    /// is not of this arm, or of an arm whose torque nobody can tell.
    pub fn settle(&self, recording: &mut Recording) -> anyhow::Result<()> {
        self.refuse_other_joints(recording)?;
        if !self.assumed() {
            settle_effort(recording, &self.twin.robot);
        }
        self.refuse_unknown_drive(recording)
    }

    /// Whether the recording is what it says, and of this arm.
    pub fn judge(&self, recording: &Recording) -> Judgement {
        let Self { twin, scaled, .. } = self;
        let arm = plausibility::Arm { twin, assumed: self.assumed(), scaled: *scaled };
        plausibility::judge(recording, &arm)
    }

    fn refuse_other_joints(&self, recording: &Recording) -> anyhow::Result<()> {
        let (joints, dof) = (recording.joint_count("actual_q"), self.twin.robot.dof());
        if joints == dof || joints == 0 {
            return Ok(());
        }
        let file = &recording.provenance.source;
        let name = &self.twin.source;
        match self.said {
            Said::Nothing => bail!(
                "{file}: it has {joints} joints, and the {name} that is assumed where no arm is named \
                 has {dof}: name the arm, --robot NAME (see `armtwin robots`; or its URDF) or --twin FILE"
            ),
            _ => bail!(
                "{file}: it has {joints} joints, the {name} has {dof}: name another arm (--robot, \
                 --twin), or the joints of this one in a column map (--columns)"
            ),
        }
    }

    fn refuse_unknown_drive(&self, recording: &Recording) -> anyhow::Result<()> {
        let Said::Robot(name) = &self.said else { return Ok(()) };
        let published = Drive::for_robot(name, self.twin.robot.dof()).is_ok();
        let needs = recording.channel("actual_current_0").is_some()
            && recording.channel("joint_torque_0").is_none();
        if published || !needs {
            return Ok(());
        }
        bail!(
            "{}: it holds motor currents, and no torque constants are published for the {name} (only for \
             the ur5): give them in a twin (--twin FILE with robot = \"{name}\" and a [drive] table: \
             gear_ratio, torque_constant in N.m/A), or record joint_torque_* in N.m",
            recording.provenance.source
        )
    }
}
