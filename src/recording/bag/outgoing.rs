//! A recording on its way into a bag: `/joint_states`, and a topic of our own for every signal that
//! has no place there, so that nothing is lost.

use std::path::Path;

use super::message::{JOINT_STATE, NUMBERS, joint_state, numbers};
use super::{OWN_TOPICS, bad};
use crate::recording::check::split_index;
use crate::recording::{Recording, RecordingError};

pub struct Outgoing<'r> {
    stamps: Vec<i64>,
    names: Vec<String>,
    /// Position, velocity, effort: by joint; without joints where not recorded.
    state: [Vec<&'r [f64]>; 3],
    others: Vec<Other<'r>>,
}

struct Other<'r> {
    topic: String,
    /// Names of the columns, between commas.
    label: String,
    columns: Vec<&'r [f64]>,
}

impl<'r> Outgoing<'r> {
    /// # Errors
    /// If there are no positions, or time does not fit into ROS stamps.
    pub fn new(recording: &'r Recording, path: &Path) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        let joints = recording.joint_count("actual_q");
        if joints == 0 {
            let what = "a bag needs joint positions, the recording has no actual_q_0".into();
            return Err(bad(&file, what, "write another format"));
        }
        let columns = |stem: &str| -> Vec<&[f64]> {
            let name = |j| format!("{stem}_{j}");
            let all: Vec<_> = (0..joints).filter_map(|j| recording.channel(&name(j))).collect();
            if all.len() == joints { all } else { Vec::new() }
        };
        let effort = ["joint_torque", "actual_current"].map(columns);
        let effort = effort.into_iter().find(|c| !c.is_empty()).unwrap_or_default();
        let state = [columns("actual_q"), columns("actual_qd"), effort];
        let inside = ["actual_q", if state[1].is_empty() { "" } else { "actual_qd" }];
        let others = recording.stems().into_iter().filter(|s| !inside.contains(&s.as_str()));
        Ok(Self {
            stamps: stamps(&recording.time, &file)?,
            names: (1..=joints).map(|j| format!("joint_{j}")).collect(),
            state,
            others: others.map(|stem| Other::of(recording, &stem)).collect(),
        })
    }

    pub fn samples(&self) -> usize {
        self.stamps.len()
    }

    /// ns
    pub fn stamp(&self, sample: usize) -> i64 {
        self.stamps[sample]
    }

    /// Name and message type.
    pub fn topics(&self) -> impl Iterator<Item = (&str, &'static str)> {
        let others = self.others.iter().map(|o| (o.topic.as_str(), NUMBERS));
        std::iter::once(("/joint_states", JOINT_STATE)).chain(others)
    }

    /// The bytes of a sample on a topic (in the order of [`Outgoing::topics`]).
    pub fn message(&self, topic: usize, sample: usize) -> Vec<u8> {
        let at = |columns: &[&[f64]]| columns.iter().map(|c| c[sample]).collect::<Vec<f64>>();
        match topic.checked_sub(1) {
            None => {
                let [q, qd, effort] = &self.state;
                let [q, qd, effort] = [at(q), at(qd), at(effort)];
                joint_state(self.stamps[sample], &self.names, [&q, &qd, &effort])
            }
            Some(other) => numbers(&self.others[other].label, &at(&self.others[other].columns)),
        }
    }
}

impl<'r> Other<'r> {
    fn of(recording: &'r Recording, stem: &str) -> Self {
        let belongs = |name: &str| split_index(name).map_or(name, |(s, _)| s) == stem;
        let all = recording.channels.iter().filter(|c| belongs(&c.name));
        let (names, columns): (Vec<&str>, Vec<&[f64]>) =
            all.map(|c| (c.name.as_str(), c.values.as_slice())).unzip();
        let clean = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let topic = format!("{OWN_TOPICS}{}", stem.chars().map(clean).collect::<String>());
        Self { topic, label: names.join(","), columns }
    }
}

/// Seconds -> ns, which must rise and fit into a ROS stamp.
fn stamps(time: &[f64], file: &str) -> Result<Vec<i64>, RecordingError> {
    let largest = f64::from(i32::MAX);
    if let Some(t) = time.iter().find(|t| !(0.0..largest).contains(*t)) {
        let what = format!("time {t} s does not fit into a ROS stamp (0 to {largest} s)");
        return Err(bad(file, what, "let time begin at 0"));
    }
    let stamps: Vec<i64> = time.iter().map(|t| (t * 1e9).round() as i64).collect();
    match stamps.windows(2).position(|w| w[1] <= w[0]) {
        None => Ok(stamps),
        Some(k) => {
            let what = format!("samples {} and {} are less than 1 ns apart", k + 1, k + 2);
            Err(bad(file, what, "write another format"))
        }
    }
}
