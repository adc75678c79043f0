//! A recording from numbers that are at hand.

use super::check::refuse_bad;
use super::{Channel, Provenance, Recording, RecordingError};
use crate::series::JointSeries;

impl Recording {
    /// A recording from signals of all joints by their RTDE names without index (`actual_q`,
    /// `actual_qd`, `target_q` in rad and seconds; `actual_current` in A or `joint_torque` in N.m; ...),
    /// each with as many samples as `time` (s). It must do what a recording of a file must: rows without a number,
    /// or with the stamp of the row before, are left out where they are few, and a note says so.
    ///
    /// ```
    /// use armtwin::{Recording, series::JointSeries};
    ///
    /// let time: Vec<f64> = (0..500).map(|k| 0.008 * k as f64).collect();
    /// let shoulder: Vec<f64> = time.iter().map(|t| t.sin()).collect();
    /// let q = JointSeries::from_joints(&[shoulder.clone(), shoulder]);
    /// let recording = Recording::from_arrays(time, &[("actual_q", &q)], "my robot")?;
    /// assert_eq!(recording.joint_count("actual_q"), 2);
    /// # Ok::<(), armtwin::recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// Lengths that differ, too few samples, time that does not rise, joints that are missing, more than a few
    /// rows without a number.
    pub fn from_arrays(
        time: Vec<f64>,
        signals: &[(&str, &JointSeries)],
        source: &str,
    ) -> Result<Self, RecordingError> {
        let of_joint = |stem: &str, values: &JointSeries, j| Channel {
            name: format!("{stem}_{j}"),
            values: values.joint(j).to_vec(),
        };
        let of_signal = |(stem, values): &(&str, &JointSeries)| {
            (0..values.joints()).map(|j| of_joint(stem, values, j)).collect::<Vec<_>>()
        };
        Self::from_columns(time, signals.iter().flat_map(of_signal).collect(), source)
    }

    /// Like [`Recording::from_arrays`], from columns as a file has them: `actual_q_0`, `actual_q_1`, ..., and
    /// whatever else there is.
    ///
    /// # Errors
    /// As [`Recording::from_arrays`].
    pub fn from_columns(
        time: Vec<f64>,
        channels: Vec<Channel>,
        source: &str,
    ) -> Result<Self, RecordingError> {
        let file = || source.to_string();
        if let Some(c) = channels.iter().find(|c| c.values.len() != time.len()) {
            let (column, given, needed) = (c.name.clone(), c.values.len(), time.len());
            return Err(RecordingError::Length { file: file(), column, given, needed });
        }
        let provenance = Provenance { source: file(), format: "arrays".into(), notes: Vec::new() };
        let mut recording = Self { time, channels, provenance };
        let mut rows: Vec<usize> = (1..=recording.time.len()).collect();
        recording.mend(&mut rows)?;
        refuse_bad(&recording, "time", &rows)?;
        Ok(recording)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrays(n: usize) -> (Vec<f64>, JointSeries) {
        let time: Vec<f64> = (0..n).map(|k| 0.01 * k as f64).collect();
        (time.clone(), JointSeries::from_joints(&[time.clone(), time]))
    }

    #[test]
    fn arrays_become_columns_and_few_empty_rows_go() {
        let (mut time, mut q) = arrays(400);
        let whole = Recording::from_arrays(time.clone(), &[("actual_q", &q)], "mine").unwrap();
        assert_eq!(whole.channels[1].name, "actual_q_1");
        assert_eq!((whole.time.len(), &whole.channels[1].values), (400, &time));
        q.joint_mut(1)[7] = f64::NAN;
        time[3] = f64::INFINITY;
        let part = Recording::from_arrays(time, &[("actual_q", &q)], "mine").unwrap();
        assert_eq!((part.time.len(), part.channels[0].values.len()), (398, 398));
        assert!(part.provenance.notes[0].contains("2 row(s)"), "{:?}", part.provenance.notes);
    }

    #[test]
    fn arrays_that_are_no_recording_are_refused_by_name() {
        let (time, q) = arrays(400);
        let said = |time: Vec<f64>, q: &JointSeries| {
            Recording::from_arrays(time, &[("actual_q", q)], "mine").unwrap_err().to_string()
        };
        let short = said(time[1..].to_vec(), &q);
        assert!(short.contains("actual_q_0") && short.contains("399"), "{short}");
        let mut holes = q.clone();
        holes.joint_mut(1)[150..200].fill(f64::NAN);
        let empty = said(time.clone(), &holes);
        assert!(empty.contains("actual_q_1") && empty.contains("row 151"), "{empty}");
        let mut back = time;
        back[300] = 0.0;
        assert!(said(back, &q).contains("backwards"));
    }
}
