//! What every recording must satisfy whatever its format, and what commands may ask of it.

use super::{Recording, RecordingError};
use crate::series::JointSeries;

/// Fewer rows are no motion.
pub const FEWEST_SAMPLES: usize = 10;

/// Signals of which every joint must have one.
pub const JOINT_SIGNALS: &[&str] = &[
    "actual_q",
    "actual_qd",
    "actual_qdd",
    "actual_current",
    "target_q",
    "target_qd",
    "target_qdd",
    "target_current",
    "target_moment",
    "joint_torque",
    "joint_temperatures",
    "joint_control_output",
];

/// Refuses too few samples, time that does not rise, and a joint that is missing.
/// `lines` are the file's line numbers of the rows.
pub fn refuse_bad(
    recording: &Recording,
    time_name: &str,
    lines: &[usize],
) -> Result<(), RecordingError> {
    let file = recording.provenance.source.clone();
    let samples = recording.time.len();
    if samples < FEWEST_SAMPLES {
        return Err(RecordingError::TooFew { file, samples, needed: FEWEST_SAMPLES });
    }
    if let Some(k) = recording.time.windows(2).position(|w| w[1] <= w[0]) {
        let (before, after) = (recording.time[k], recording.time[k + 1]);
        let what = if before == after { "repeats" } else { "goes backwards" };
        let (row, column) = (lines[k + 1], time_name.into());
        return Err(RecordingError::Time { file, row, column, what, before, after });
    }
    recording.refuse_missing_joint()
}

impl Recording {
    /// Samples of all joints of `stem` (`actual_q`), of which there must be `dof`.
    ///
    /// # Errors
    /// Names the file and the first missing column.
    pub fn require_joints(&self, stem: &str, dof: usize) -> Result<JointSeries, RecordingError> {
        let joints = self.joint_count(stem);
        if let (true, Some(series)) = (joints == dof, self.joints(stem)) {
            return Ok(series);
        }
        let file = self.provenance.source.clone();
        if joints > dof {
            return Err(RecordingError::JointCount {
                file,
                stem: stem.into(),
                joints,
                other: "the twin's arm".into(),
                other_joints: dof,
                column: format!("{stem}_{} expected", dof),
            });
        }
        Err(RecordingError::MissingColumn {
            file,
            column: format!("{stem}_{joints}"),
            found: self.stems().join(", "),
            remedy: "it is needed here: record it, or map it with a column map (--columns)",
        })
    }

    /// How many joints from 0 on have a column of this signal.
    pub fn joint_count(&self, stem: &str) -> usize {
        (0..).take_while(|j| self.channel(&format!("{stem}_{j}")).is_some()).count()
    }

    /// Signals in the order of the file: names without the index at their end, each once.
    pub fn stems(&self) -> Vec<String> {
        let mut stems: Vec<String> = Vec::new();
        for channel in &self.channels {
            let stem = split_index(&channel.name).map_or(channel.name.as_str(), |(s, _)| s);
            if stems.last().is_none_or(|s| s != stem) && !stems.iter().any(|s| s == stem) {
                stems.push(stem.into());
            }
        }
        stems
    }

    /// A gap in the joints of a signal, or signals with different numbers of joints.
    fn refuse_missing_joint(&self) -> Result<(), RecordingError> {
        let file = || self.provenance.source.clone();
        let mut reference: Option<(&str, usize)> = None;
        for stem in JOINT_SIGNALS {
            let indices = self.channels.iter().filter_map(|c| split_index(&c.name));
            let last = indices.filter(|(s, _)| s == stem).map(|(_, j)| j).max();
            let Some(last) = last else { continue };
            let joints = self.joint_count(stem);
            if joints <= last {
                return Err(RecordingError::JointGap {
                    file: file(),
                    stem: (*stem).into(),
                    column: format!("{stem}_{joints}"),
                    next: format!("{stem}_{last}"),
                });
            }
            let (other, other_joints) = *reference.get_or_insert((stem, joints));
            if joints != other_joints {
                let short = if joints < other_joints { *stem } else { other };
                return Err(RecordingError::JointCount {
                    file: file(),
                    stem: (*stem).into(),
                    joints,
                    other: other.into(),
                    other_joints,
                    column: format!("{short}_{}", joints.min(other_joints)),
                });
            }
        }
        Ok(())
    }
}

/// Renames joints that are counted from 1 throughout; says so.
pub fn count_from_zero(names: &mut [String]) -> Option<String> {
    let joint = |name: &str| {
        split_index(name).filter(|(stem, _)| JOINT_SIGNALS.contains(stem)).map(|(_, j)| j)
    };
    let lowest = names.iter().filter_map(|n| joint(n)).min()?;
    if lowest != 1 {
        return None;
    }
    // A single joint that is missing at the base is no count from 1: all signals begin there.
    let begins = |stem: &str| names.iter().any(|n| *n == format!("{stem}_1"));
    let there =
        |stem: &&&str| names.iter().any(|n| split_index(n).is_some_and(|(s, _)| s == **stem));
    if !JOINT_SIGNALS.iter().filter(there).all(|stem| begins(stem)) {
        return None;
    }
    for name in names.iter_mut() {
        if let Some((stem, j)) = split_index(name).filter(|(s, _)| JOINT_SIGNALS.contains(s)) {
            *name = format!("{stem}_{}", j - 1);
        }
    }
    Some("joints are counted from 1 in the column names (actual_q_1 is joint 1)".into())
}

/// `actual_q_3` -> (`actual_q`, 3)
pub fn split_index(name: &str) -> Option<(&str, usize)> {
    let (stem, index) = name.rsplit_once('_')?;
    index.parse().ok().map(|index| (stem, index))
}
