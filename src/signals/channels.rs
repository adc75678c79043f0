//! Which columns of a recording become motion and torque.

use super::{Derivatives, SignalError};
use crate::recording::Recording;
use crate::robot::{Drive, servo};
use crate::series::JointSeries;

/// Columns as recorded, on the recording's own time.
pub(super) struct Picked {
    pub q: JointSeries,
    /// Recorded velocity, where the derivatives are made from it.
    pub qd: Option<JointSeries>,
    /// Recorded velocity, where they are made from something else.
    pub unused_qd: Option<JointSeries>,
    /// Commanded position, velocity and acceleration, where the derivatives are made from them.
    pub target: Option<[JointSeries; 3]>,
    pub torque: Torque,
    pub temperature: Option<JointSeries>,
    pub notes: Vec<String>,
}

/// What tells the torque of the drives.
pub(super) enum Torque {
    /// N.m at the joint.
    Recorded(JointSeries),
    /// The servos' law: command, rad, and how the servos were set.
    Servo { command: JointSeries, settings: servo::Settings },
}

pub(super) fn pick(
    recording: &Recording,
    drive: &Drive,
    dof: usize,
    derivatives: Derivatives,
) -> Result<Picked, SignalError> {
    use Derivatives::{Paper, Recorded, TrackingError};
    let recorded = recording.joint_count("actual_q");
    if recorded > dof {
        return Err(SignalError::JointCount { joints: recorded, dof });
    }
    let mut notes = Vec::new();
    let need = |stem, purpose, remedy| joints(recording, stem, dof, purpose, remedy);
    let velocity = "velocity; derivatives = \"position\" needs positions only";
    let command = "the commanded motion; derivatives = \"position\" needs positions only";
    let record = "record it or choose other derivatives";
    Ok(Picked {
        q: need("actual_q", "joint positions", "record it, or name the column in --columns")?,
        qd: match derivatives {
            Recorded | Paper => Some(need("actual_qd", velocity, record)?),
            _ => None,
        },
        unused_qd: match derivatives {
            Recorded | Paper => None,
            _ => joints(recording, "actual_qd", dof, "", "").ok(),
        },
        target: match derivatives {
            TrackingError => Some([
                need("target_q", command, record)?,
                need("target_qd", command, record)?,
                need("target_qdd", command, record)?,
            ]),
            _ => None,
        },
        torque: torque(recording, drive, dof, &mut notes)?,
        temperature: temperature(recording, dof),
        notes,
    })
}

/// `joint_torque_*` where recorded, else motor current times gear ratio and torque constant, else what
/// position servos make of command and position.
fn torque(
    recording: &Recording,
    drive: &Drive,
    dof: usize,
    notes: &mut Vec<String>,
) -> Result<Torque, SignalError> {
    let purpose = "joint torques";
    if recording.channel("joint_torque_0").is_some() {
        notes.push("torque: joint_torque_* as recorded".into());
        let remedy = "record the torque of every joint, or leave joint_torque_* out";
        return joints(recording, "joint_torque", dof, purpose, remedy).map(Torque::Recorded);
    }
    if drive.servo.is_some() && recording.channel("actual_current_0").is_none() {
        return told(recording, dof, notes);
    }
    let remedy = match recording.channel("effort_0") {
        Some(_) => "say in a column map what effort is: [bag] effort = \"current\" or \"torque\"",
        None => {
            "record motor currents, or joint_torque_* in N.m; an arm of position servos whose \
             command is recorded needs no torque, say what they are in the twin's [servo]"
        }
    };
    let current = joints(recording, "actual_current", dof, purpose, remedy)?;
    let constants = drive.gear_ratio.len().min(drive.torque_constant.len());
    if constants < dof {
        return Err(SignalError::DriveMismatch { drive: constants, dof });
    }
    let gains: Vec<f64> = (0..dof).map(|j| drive.torque_per_ampere(j)).collect();
    let printed: Vec<String> = gains.iter().map(|g| format!("{g:.3}")).collect();
    notes.push(format!("torque: actual_current_* times {} N.m/A", printed.join(" ")));
    Ok(Torque::Recorded(current.map_joints(|j, i| i.iter().map(|i| gains[j] * i).collect())))
}

/// What the servos were told, and how they were set.
fn told(recording: &Recording, dof: usize, notes: &mut Vec<String>) -> Result<Torque, SignalError> {
    let purpose = "the servos' command";
    let command = joints(recording, "target_q", dof, purpose, "record what the servos are told")?;
    let setting = |stem| joints(recording, stem, dof, "", "").ok();
    let settings =
        servo::Settings { register: setting("servo_gain"), powered: setting("servo_powered") };
    notes.push("torque: by the servos' law from command and position".into());
    Ok(Torque::Servo { command, settings })
}

fn temperature(recording: &Recording, dof: usize) -> Option<JointSeries> {
    joints(recording, "joint_temperatures", dof, "", "").ok()
}

/// `stem_0` .. `stem_{dof-1}`, or which of them is missing.
fn joints(
    recording: &Recording,
    stem: &str,
    dof: usize,
    purpose: &'static str,
    remedy: &'static str,
) -> Result<JointSeries, SignalError> {
    let column = |j| {
        let channel = format!("{stem}_{j}");
        match recording.channel(&channel) {
            Some(values) => Ok(values.to_vec()),
            None => {
                let found = stems(recording);
                Err(SignalError::MissingChannel { channel, purpose, remedy, found })
            }
        }
    };
    let rows = (0..dof).map(column).collect::<Result<Vec<_>, _>>()?;
    Ok(JointSeries::from_joints(&rows))
}

/// "actual_q_0..5, actual_current_0..5": what a recording has, briefly.
fn stems(recording: &Recording) -> String {
    let mut seen: Vec<(&str, usize)> = Vec::new();
    for channel in &recording.channels {
        let stem = channel.name.trim_end_matches(|c: char| c.is_ascii_digit());
        match seen.iter_mut().find(|(s, _)| *s == stem) {
            Some((_, count)) => *count += 1,
            None => seen.push((stem, 1)),
        }
    }
    let range = |(stem, count): &(&str, usize)| match (stem.ends_with('_'), count) {
        (true, 2..) => format!("{stem}0..{}", count - 1),
        _ => stem.trim_end_matches('_').to_string(),
    };
    match seen.is_empty() {
        true => "no channels".into(),
        false => seen.iter().map(range).collect::<Vec<_>>().join(", "),
    }
}
