//! What is shown: signals of the recorded arm and of its twin on one time base.

use super::Error;
use crate::robot::Robot;
use crate::series::JointSeries;

/// Everything a `.rrd` is made from. All series have one row per joint of `robot` and one value
/// per entry of `time`; a value that is not known is NaN and leaves a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Shown as the recording's name.
    pub title: String,
    /// Supplies link geometry and joint names.
    pub robot: Robot,
    /// s, increasing.
    pub time: Vec<f64>,
    pub recorded: Motion,
    pub simulated: Motion,
    /// The commanded position, rad, where there is one.
    pub target_q: Option<JointSeries>,
    pub torque: Torque,
    /// Markdown: what was fitted, and the numbers.
    pub summary: String,
}

/// rad and rad/s.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    pub q: JointSeries,
    pub qd: JointSeries,
}

/// N.m at the joint, drive side. NaN where a joint stands still and friction holds it with
/// whatever torque there is: what the twin predicts then is no number to compare with.
#[derive(Debug, Clone, PartialEq)]
pub struct Torque {
    pub measured: JointSeries,
    pub predicted: JointSeries,
}

impl Comparison {
    /// Checks that every series fits the arm and the time base.
    pub(super) fn check_shapes(&self) -> Result<(), Error> {
        if self.time.is_empty() || self.robot.dof() == 0 {
            return Err(Error::Empty);
        }
        let required = [
            ("recorded position", &self.recorded.q),
            ("recorded velocity", &self.recorded.qd),
            ("simulated position", &self.simulated.q),
            ("simulated velocity", &self.simulated.qd),
            ("measured torque", &self.torque.measured),
            ("predicted torque", &self.torque.predicted),
        ];
        let target = self.target_q.iter().map(|q| ("commanded position", q));
        required
            .into_iter()
            .chain(target)
            .try_for_each(|(what, s)| check_shape(what, s, self.robot.dof(), self.time.len()))
    }
}

/// One row per joint, one value per instant.
pub fn check_shape(
    what: &'static str,
    series: &JointSeries,
    dof: usize,
    times: usize,
) -> Result<(), Error> {
    let (joints, samples) = (series.joints(), series.samples());
    if (joints, samples) == (dof, times) {
        return Ok(());
    }
    Err(Error::Shape { what, joints, samples, dof, times })
}
