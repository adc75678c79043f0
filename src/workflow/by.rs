//! By which method an arm is explained: what its drives gave, or where its command leads it.

use super::{Prepared, WorkflowError};
use crate::diagnosis::By;
use crate::recording::Recording;
use crate::twin::Twin;

/// Columns that hold torque.
const TORQUE: [&str; 2] = ["joint_torque_", "actual_current_"];

/// What is recorded decides where nobody does: servos without torque are simulated. The twin is made such that
/// only that method can be meant.
///
/// # Errors
/// If simulation is asked for and the twin has no servos.
pub fn choose(
    asked: Option<By>,
    twin: &mut Twin,
    recordings: &[&Prepared<'_>],
) -> Result<By, WorkflowError> {
    let by = match (asked, &twin.drive.servo) {
        (Some(By::Simulation), None) => {
            return Err(WorkflowError::Asked(
                "by simulation: the twin does not say what its servos are; give it a [servo] table, for \
                 example model = \"sts3215\""
                    .into(),
            ));
        }
        (Some(by), _) => by,
        (None, Some(_)) if !recordings.iter().any(|r| has_torque(r)) => By::Simulation,
        (None, _) => By::Torque,
    };
    if by == By::Torque {
        twin.drive.servo = None;
    }
    Ok(by)
}

/// The recording with what the method goes by.
pub fn kept(by: By, recording: Prepared<'_>) -> Prepared<'_> {
    match by {
        By::Torque => recording,
        By::Simulation => without_torque(recording),
    }
}

fn is_torque(name: &str) -> bool {
    TORQUE.iter().any(|stem| name.starts_with(stem))
}

fn has_torque(recording: &Recording) -> bool {
    recording.channels.iter().any(|c| is_torque(&c.name))
}

fn without_torque(recording: Prepared<'_>) -> Prepared<'_> {
    if !has_torque(&recording) {
        return recording;
    }
    let mut recording = recording.into_owned();
    recording.channels.retain(|c| !is_torque(&c.name));
    Prepared::of(recording)
}
