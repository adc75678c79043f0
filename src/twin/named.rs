//! A twin of which nothing is known but the arm.

use super::{Twin, read_robot};
use crate::robot::{Chain, Drive, RobotError};

impl Twin {
    /// A built-in arm by name, or a URDF, with Coulomb and viscous friction to be fitted. Where no torque
    /// constants are published for it, its drive is one N.m/A without gears, for recordings that hold
    /// torque: [`Drive::for_robot`] tells.
    ///
    /// # Errors
    /// If there is no such arm or the URDF is not one.
    pub fn of_robot(name: &str) -> Result<Self, RobotError> {
        let chain = Chain::default();
        let (source, loaded) = read_robot(name, &chain, std::path::Path::new(""))?;
        let dof = loaded.robot.dof();
        let drive = Drive::for_robot(&source, dof)
            .unwrap_or_else(|_| Drive::new(vec![1.0; dof], vec![1.0; dof]));
        let (robot, notes) = (loaded.robot, loaded.notes);
        Ok(Self { source, chain, robot, notes, drive, ..Self::default() })
    }
}
