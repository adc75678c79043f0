//! By which method an arm is explained: what its drives gave, or where its command leads it.

use anyhow::bail;

use crate::recording::Recording;
use crate::twin::Twin;

/// How a recording is explained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// Inverse dynamics of the recorded motion against the recorded torque
    Torque,
    /// Position servos led along the recorded command, against the recorded position
    Simulation,
}

/// The flag.
#[derive(clap::Args, Clone, Default)]
pub struct ByArgs {
    /// Against recorded torque, or by simulating command to position [default: what is recorded decides]
    #[arg(long, value_enum, value_name = "METHOD")]
    by: Option<By>,
}

/// Columns that hold torque.
const TORQUE: [&str; 2] = ["joint_torque_", "actual_current_"];

impl ByArgs {
    pub fn forced(&self) -> Option<By> {
        self.by
    }

    /// Chooses, and makes twin and recordings such that only that method can be meant.
    ///
    /// # Errors
    /// If the method that is asked for cannot be had.
    pub fn choose(&self, twin: &mut Twin, recordings: &mut [&mut Recording]) -> anyhow::Result<By> {
        let recorded = |r: &&mut Recording| TORQUE.iter().all(|stem| !has(r, stem));
        let told = recordings.iter().all(recorded);
        let by = match (self.by, &twin.drive.servo) {
            (Some(By::Simulation), None) => bail!(
                "--by simulation: the twin does not say what its servos are; give it a [servo] table, for \
                 example model = \"sts3215\" (a twin is named by --twin)"
            ),
            (Some(by), _) => by,
            (None, Some(_)) if told => By::Simulation,
            (None, _) => By::Torque,
        };
        match by {
            By::Torque => twin.drive.servo = None,
            By::Simulation => recordings.iter_mut().for_each(|r| {
                r.channels.retain(|c| TORQUE.iter().all(|stem| !c.name.starts_with(stem)));
            }),
        }
        Ok(by)
    }
}

fn has(recording: &Recording, stem: &str) -> bool {
    recording.channels.iter().any(|c| c.name.starts_with(stem))
}

impl By {
    /// One line for people.
    pub fn line(self) -> &'static str {
        match self {
            By::Torque => "method: by torque, inverse dynamics of the recorded motion",
            By::Simulation => {
                "method: by simulation, from the recorded command to the position (no torque is recorded; \
                 --by says otherwise)"
            }
        }
    }
}
