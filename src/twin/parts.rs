//! What twin and scenario files have in common: the arm, its `[drive]`, values per joint.

use std::io;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::files::guard::folder_of;
use crate::robot::{self, Chain, Drive, Loaded, RobotError};

/// `5.0` or `[5.0, 6.0, 4.5, 1.2, 1.4, 1.2]`, base to wrist.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number for all joints or a list with one number per joint")]
pub enum PerJoint {
    All(f64),
    Each(Vec<f64>),
}

impl PerJoint {
    /// `count` values; a list stays as long as it is.
    pub fn expand(&self, count: usize) -> Vec<f64> {
        match self {
            PerJoint::All(value) => vec![*value; count],
            PerJoint::Each(values) => values.clone(),
        }
    }
}

/// The `[drive]` table: what is left out is the built-in arm's.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DriveTable {
    pub gear_ratio: Option<PerJoint>,
    pub torque_constant: Option<PerJoint>,
    pub rotor_inertia: Option<PerJoint>,
    pub current_limit: Option<PerJoint>,
    pub torque_limit: Option<PerJoint>,
}

impl DriveTable {
    /// The table that [`DriveTable::on`] makes `drive` of.
    pub fn of(drive: &Drive) -> Self {
        let each = |v: &Vec<f64>| Some(PerJoint::Each(v.clone()));
        Self {
            gear_ratio: each(&drive.gear_ratio),
            torque_constant: each(&drive.torque_constant),
            rotor_inertia: each(&drive.rotor_inertia),
            current_limit: drive.current_limit.as_ref().and_then(each),
            torque_limit: drive.torque_limit.as_ref().and_then(each),
        }
    }

    /// The drive of an arm of `dof` joints; `robot` is its name or path.
    ///
    /// # Errors
    /// If a value is missing for this arm, is not positive, or a list has the wrong length.
    pub fn on(&self, robot: &str, dof: usize) -> Result<Drive, RobotError> {
        let each = |v: &Option<PerJoint>| v.as_ref().map(|v| v.expand(dof));
        let mut drive = match (each(&self.gear_ratio), each(&self.torque_constant)) {
            (Some(gear_ratio), Some(torque_constant)) => Drive::new(gear_ratio, torque_constant),
            (gear_ratio, torque_constant) => {
                let known = Drive::for_robot(robot, dof)?;
                Drive {
                    gear_ratio: gear_ratio.unwrap_or(known.gear_ratio),
                    torque_constant: torque_constant.unwrap_or(known.torque_constant),
                    ..known
                }
            }
        };
        if let Some(rotor_inertia) = each(&self.rotor_inertia) {
            drive.rotor_inertia = rotor_inertia;
        }
        drive.current_limit = each(&self.current_limit).or(drive.current_limit);
        drive.torque_limit = each(&self.torque_limit).or(drive.torque_limit);
        drive.check(dof)?;
        Ok(drive)
    }
}

/// The built-in arm, or the URDF: its path counts from the folder of `file` and is made absolute,
/// so that what is saved elsewhere finds it. Returns that name or path with the `chain` of the robot
/// that is the arm.
///
/// # Errors
/// If there is no such arm or the URDF is not one.
pub fn read_robot(name: &str, chain: &Chain, file: &Path) -> Result<(String, Loaded), RobotError> {
    let beside = file.parent().unwrap_or(Path::new("")).join(name);
    let source = match robot::builtin(name) {
        None if beside.exists() => in_real_folder(&beside).unwrap_or(beside).display().to_string(),
        _ => name.to_string(),
    };
    let loaded = robot::load(&source, chain)?;
    Ok((source, loaded))
}

/// The URDF at `source` as a file at `path` names it. `None` for a built-in arm, and where they share no
/// folder that could be moved with both in it.
pub fn named_from(source: &str, path: &Path) -> Option<String> {
    let urdf = in_real_folder(Path::new(source)).ok().filter(|urdf| urdf.is_file())?;
    let folder = folder_of(path).canonicalize().ok()?;
    let both = urdf.components().zip(folder.components()).take_while(|(a, b)| a == b);
    let shared: Vec<Component<'_>> = both.map(|(a, _)| a).collect();
    if robot::builtin(source).is_some() || !matches!(shared.last(), Some(Component::Normal(_))) {
        return None;
    }
    let up = folder.components().skip(shared.len()).map(|_| Component::ParentDir);
    let name: PathBuf = up.chain(urdf.components().skip(shared.len())).collect();
    let name = name.display().to_string();
    // The file, not the arm of that name.
    Some(if robot::builtin(&name).is_some() { format!("./{name}") } else { name })
}

/// Absolute, without links among its folders.
fn in_real_folder(file: &Path) -> io::Result<PathBuf> {
    Ok(folder_of(file).canonicalize()?.join(file.file_name().unwrap_or_default()))
}
