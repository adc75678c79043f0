//! What is shown of a diagnosis: the recorded arm, the twin as given and the mended twin.

use std::borrow::Cow;

use rerun::{RecordingStream, TimeColumn};

use super::blueprint::{Node, arms, columns, grid, rows, stack, tabs, text, time_series};
use super::comparison::check_shape;
use super::layout::SUMMARY;
use super::layout::joint_name;
use super::plots::{Curve, TIMELINE, curve, log_curves};
use super::scene::{Shown, log_frame};
use super::{Error, arm, palette};
use crate::robot::Robot;
use crate::series::JointSeries;

/// Positions have one value per entry of `time`.
#[derive(Debug, Clone, PartialEq)]
pub struct Mending {
    /// Shown as the recording's name.
    pub title: String,
    pub robot: Robot,
    /// s, increasing.
    pub time: Vec<f64>,
    /// rad
    pub recorded: JointSeries,
    /// What the twin as given and the mended one, if there is one, do along the same command, rad;
    /// empty where they could not be simulated.
    pub simulated: Vec<JointSeries>,
    /// Base to wrist.
    pub joints: Vec<JointMending>,
    /// Markdown: the accepted effects, and the numbers.
    pub summary: String,
}

/// Torques of a joint, N.m, low-passed; one value per entry of its own `time`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointMending {
    /// s, increasing; where neighbours are further apart than `step` a stretch is left out.
    pub time: Vec<f64>,
    pub step: f64,
    pub measured: Vec<f64>,
    /// Measured less the torque of the twin as given and of the mended one, if there is one.
    pub residual: Vec<Vec<f64>>,
    /// Shortly after a reversal.
    pub reversal: Vec<bool>,
    /// Where an accepted contact touches; empty without one.
    pub contact: Vec<bool>,
}

/// How thick an interval is marked, points.
const MARK: f32 = 6.0;
/// In the order in which they are arranged: key in the entity path, label with unit.
const QUANTITIES: [(&str, &str); 4] = [
    ("torque", "torque / N.m"),
    ("residual", "torque, measured - twin / N.m"),
    ("angle", "angle / rad"),
    ("tracking", "angle, recorded - simulated / rad"),
];
const NAMES: [&str; 2] = ["twin as given", "mended twin"];
const COLORS: [palette::Rgb; 2] = [palette::BEFORE, palette::AFTER];

fn entity(joint: usize, key: &str) -> String {
    format!("joint_{}/{key}", joint + 1)
}

impl Shown for Mending {
    fn title(&self) -> &str {
        &self.title
    }

    fn check(&self) -> Result<(), Error> {
        let (dof, times) = (self.robot.dof(), self.time.len());
        if times == 0 || dof == 0 {
            return Err(Error::Empty);
        }
        check_shape("recorded position", &self.recorded, dof, times)?;
        let simulated = self.simulated.iter();
        simulated.into_iter().try_for_each(|q| check_shape("simulated position", q, dof, times))?;
        let uneven = self.joints.iter().find(|j| !j.is_even());
        match (self.joints.len() == dof, uneven) {
            (true, None) => Ok(()),
            _ => Err(Error::Log("joints of uneven length".into())),
        }
    }

    fn arrangement(&self) -> Node {
        let frame = arm::frame(&self.robot, &self.recorded);
        let name = match self.simulated.len() {
            0 => "Recorded",
            1 => "Recorded (solid), twin as given (orange)",
            _ => "Recorded (solid), twin as given (orange), mended twin (green)",
        };
        let left = rows(
            "Arm",
            vec![arms(name, &frame), text("What the twin lacks", SUMMARY)],
            vec![3.0, 2.0],
        );
        let shown = || QUANTITIES.iter().filter(|(key, _)| self.shows(key));
        let titles = [("residual", "Residuals"), ("torque", "Torques"), ("angle", "Angles")];
        let over_joints = |(key, title): (&str, &str)| {
            let label = QUANTITIES.iter().find(|q| q.0 == key).map_or("", |q| q.1);
            grid(title, (0..self.robot.dof()).map(|j| self.plot(j, key, label)).collect())
        };
        let mut signals: Vec<Node> = titles.into_iter().map(over_joints).collect();
        signals.extend((0..self.robot.dof()).map(|j| {
            let plots = shown().map(|(key, label)| self.plot(j, key, label));
            stack(&format!("Joint {}", j + 1), plots.collect())
        }));
        columns("Diagnosis", vec![left, tabs("Signals", signals)], vec![2.0, 3.0])
    }

    fn log(&self, stream: &RecordingStream) -> Result<(), Error> {
        log_frame(stream, &self.summary)?;
        arm::log(stream, &self.robot, &arm::RECORDED, &self.time, &self.recorded)?;
        for (look, q) in [arm::BEFORE, arm::AFTER].iter().zip(&self.simulated) {
            arm::log(stream, &self.robot, look, &self.time, q)?;
        }
        let time = TimeColumn::new_duration_secs(TIMELINE, self.time.iter().copied());
        for (j, joint) in self.joints.iter().enumerate() {
            joint.log(stream, j)?;
            self.log_motion(stream, &time, j)?;
        }
        Ok(())
    }
}

impl Mending {
    fn shows(&self, key: &str) -> bool {
        key != "tracking" || !self.simulated.is_empty()
    }

    fn plot(&self, joint: usize, key: &str, label: &str) -> Node {
        let name = format!("{} {}: {label}", joint + 1, joint_name(&self.robot, joint));
        time_series(name, entity(joint, key), true)
    }

    fn log_motion(
        &self,
        stream: &RecordingStream,
        time: &TimeColumn,
        joint: usize,
    ) -> Result<(), Error> {
        let recorded = self.recorded.joint(joint);
        let mut angles = vec![curve("recorded", palette::RECORDED, recorded)];
        let mut tracking = Vec::new();
        for ((name, color), q) in NAMES.into_iter().zip(COLORS).zip(&self.simulated) {
            angles.push(curve(name, color, q.joint(joint)));
            let less: Vec<f64> = recorded.iter().zip(q.joint(joint)).map(|(r, s)| r - s).collect();
            tracking.push(Curve { values: Cow::Owned(less), ..curve(name, color, &[]) });
        }
        log_curves(stream, time, &entity(joint, "angle"), &angles)?;
        if tracking.is_empty() {
            return Ok(());
        }
        log_curves(stream, time, &entity(joint, "tracking"), &tracking)
    }
}

impl JointMending {
    fn is_even(&self) -> bool {
        let n = self.time.len();
        let marks = [&self.reversal, &self.contact];
        let mut series = self.residual.iter().chain([&self.measured]);
        series.all(|s| s.len() == n) && marks.iter().all(|m| m.is_empty() || m.len() == n)
    }

    fn log(&self, stream: &RecordingStream, joint: usize) -> Result<(), Error> {
        if self.time.is_empty() {
            return Ok(());
        }
        let whole = self.with_gaps();
        let time = TimeColumn::new_duration_secs(TIMELINE, whole.time.iter().copied());
        let owned = |name, color, values: Vec<f64>| Curve {
            values: Cow::Owned(values),
            ..curve(name, color, &[])
        };
        let mut torque = vec![curve("measured", palette::RECORDED, &whole.measured)];
        let mut residual = whole.marks();
        for ((name, color), left) in NAMES.into_iter().zip(COLORS).zip(&whole.residual) {
            let of_twin = whole.measured.iter().zip(left).map(|(m, r)| m - r).collect();
            torque.push(owned(name, color, of_twin));
            residual.push(curve(name, color, left));
        }
        log_curves(stream, &time, &entity(joint, "torque"), &torque)?;
        log_curves(stream, &time, &entity(joint, "residual"), &residual)
    }

    /// Intervals, as thick lines at zero.
    fn marks(&self) -> Vec<Curve<'_>> {
        let marks = [
            ("reversal", palette::REVERSAL, &self.reversal),
            ("contact", palette::CONTACT, &self.contact),
        ];
        let line = |(name, color, held): (&'static str, palette::Rgb, &Vec<bool>)| {
            let values = held.iter().map(|h| if *h { 0.0 } else { f64::NAN }).collect();
            Curve { values: Cow::Owned(values), width: MARK, ..curve(name, color, &[]) }
        };
        marks.into_iter().filter(|m| m.2.contains(&true)).map(line).collect()
    }

    /// With an instant without values wherever a stretch is left out, so that no line bridges it.
    fn with_gaps(&self) -> Self {
        let residual = vec![Vec::new(); self.residual.len()];
        let mut out = Self { step: self.step, residual, ..Self::default() };
        let unknown = vec![f64::NAN; self.residual.len()];
        let flag = |marks: &[bool], k: usize| marks.get(k).copied().unwrap_or(false);
        for (k, &t) in self.time.iter().enumerate() {
            let before = k.checked_sub(1).map(|k| self.time[k]);
            if let Some(before) = before.filter(|b| t - b > 1.5 * self.step) {
                out.push(before + 0.5 * self.step, f64::NAN, &unknown, [false; 2]);
            }
            let left: Vec<f64> = self.residual.iter().map(|r| r[k]).collect();
            let marks = [flag(&self.reversal, k), flag(&self.contact, k)];
            out.push(t, self.measured[k], &left, marks);
        }
        out
    }

    fn push(&mut self, t: f64, measured: f64, left: &[f64], marks: [bool; 2]) {
        self.time.push(t);
        self.measured.push(measured);
        self.residual.iter_mut().zip(left).for_each(|(r, left)| r.push(*left));
        self.reversal.push(marks[0]);
        self.contact.push(marks[1]);
    }
}
