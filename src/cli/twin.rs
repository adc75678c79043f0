//! The arm and the twin a command is given.

use std::path::{Path, PathBuf};

use super::out;
use crate::robot::RobotError;
use crate::twin::{Twin, TwinError};
use crate::workflow::Said;

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

/// The arm that recordings are held against.
pub use crate::workflow::Arm;

impl ArmArgs {
    pub fn of_twin(twin: &Path) -> Self {
        Self { twin: Some(twin.into()), robot: None }
    }

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
    pub(super) fn line(&self) -> String {
        let name = &self.twin.source;
        match &self.said {
            Said::Given | Said::Undriven(_) => format!("arm: {name}"),
            Said::Twin(path) => format!("arm: {name} (by {})", path.display()),
            Said::Robot(_) => format!("arm: {name} (by --robot)"),
            Said::Nothing => {
                format!("arm: {name} (assumed; --robot NAME or --twin FILE says otherwise)")
            }
        }
    }
}
