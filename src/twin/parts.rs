//! What twin and scenario files have in common: the arm, its `[drive]`, values per joint.

use std::io;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::files::guard::folder_of;
use crate::robot::servo::kind;
use crate::robot::{self, Chain, Drive, Loaded, RobotError, Servo};

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
    pub fn on(
        &self,
        robot: &str,
        dof: usize,
        servo: Option<&ServoTable>,
    ) -> Result<Drive, RobotError> {
        let each = |v: &Option<PerJoint>| v.as_ref().map(|v| v.expand(dof));
        let mut drive = match (each(&self.gear_ratio), each(&self.torque_constant)) {
            (Some(gear_ratio), Some(torque_constant)) => Drive::new(gear_ratio, torque_constant),
            // A servo tells no current.
            (None, None) if servo.is_some() => Drive::new(vec![1.0; dof], vec![1.0; dof]),
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
        drive.servo = servo.map(|s| s.on(dof)).transpose()?;
        drive.check(dof)?;
        Ok(drive)
    }
}

/// The `[servo]` table: a known servo, or its values, or both; values win.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ServoTable {
    /// A servo whose values are published.
    pub model: Option<String>,
    /// Supply, V, of such a servo.
    pub volts: Option<PerJoint>,
    /// Value of the gain register: with `model` it says the gain, else what `gain` is for.
    pub gain_register: Option<PerJoint>,
    pub gain: Option<PerJoint>,
    pub damping: Option<PerJoint>,
    pub max_torque: Option<PerJoint>,
    pub dead_band: Option<PerJoint>,
    pub delay: Option<PerJoint>,
    pub offset: Option<PerJoint>,
}

impl ServoTable {
    /// The servos of an arm of `dof` joints.
    ///
    /// # Errors
    /// If there is neither a known model nor a gain, or a value does not fit.
    pub fn on(&self, dof: usize) -> Result<Servo, RobotError> {
        let each = |v: &Option<PerJoint>| v.as_ref().map(|v| v.expand(dof));
        let mut servo = match (&self.model, each(&self.gain)) {
            (Some(model), _) => {
                let kind = kind(model)?;
                let volts = each(&self.volts).unwrap_or_else(|| vec![kind.volts; dof]);
                let usual = || vec![kind.register; dof];
                Servo::of_kind(kind, &volts, &each(&self.gain_register).unwrap_or_else(usual))
            }
            (None, Some(gain)) => Servo::new(gain),
            (None, None) => {
                return Err(RobotError::Servo(
                    "give model = \"sts3215\" or another known servo, or gain (N.m/rad)".into(),
                ));
            }
        };
        servo.register = each(&self.gain_register).or(servo.register);
        for (given, own) in [
            (&self.gain, &mut servo.gain),
            (&self.damping, &mut servo.damping),
            (&self.max_torque, &mut servo.max_torque),
            (&self.dead_band, &mut servo.dead_band),
            (&self.delay, &mut servo.delay),
            (&self.offset, &mut servo.offset),
        ] {
            each(given).into_iter().for_each(|values| *own = values);
        }
        servo.check(dof)?;
        Ok(servo)
    }

    /// The table that [`ServoTable::on`] makes the same servos of.
    pub fn of(servo: &Servo) -> Self {
        let each = |v: &Vec<f64>| Some(PerJoint::Each(v.clone()));
        let said = |v: &Vec<f64>| each(v).filter(|_| v.iter().any(|x| *x != 0.0));
        Self {
            model: None,
            volts: None,
            gain_register: servo.register.as_ref().and_then(each),
            gain: each(&servo.gain),
            damping: said(&servo.damping),
            max_torque: each(&servo.max_torque)
                .filter(|_| servo.max_torque.iter().all(|m| m.is_finite())),
            dead_band: said(&servo.dead_band),
            delay: said(&servo.delay),
            offset: said(&servo.offset),
        }
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
