//! An arm while it is watched: where it is, its torque beside the twin's, and the gap.

use std::sync::Arc;

use rerun::{RecordingStream, TimeColumn};

use super::{Address, Delivery, Live};
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::viewer::blueprint::{Node, arms, columns, grid, tabs, time_series};
use crate::viewer::layout::joint_name;
use crate::viewer::plots::{Curve, TIMELINE, curve, log_style, log_values};
use crate::viewer::scene::log_up;
use crate::viewer::{Error, arm, palette};

/// In the order of their tabs: key in the entity path, title, label with unit.
const QUANTITIES: [(&str, &str, &str); 3] = [
    ("torque", "Torques", "torque / N.m"),
    ("residual", "Gap", "torque, measured - predicted / N.m"),
    ("angle", "Angles", "angle / rad"),
];

/// Samples per second that are shown: enough for the eye, little for a day.
const SHOWN_HZ: f64 = 25.0;

/// Sends stretches as they are seen.
pub struct Watching {
    live: Live,
    robot: Arc<Robot>,
}

/// Joint by joint: s, rad, N.m, N.m.
#[derive(Debug, Clone)]
pub struct Watched {
    pub time: Vec<f64>,
    pub q: JointSeries,
    pub measured: JointSeries,
    pub predicted: JointSeries,
}

impl Watching {
    /// # Errors
    /// If the system has no thread left.
    pub fn begin(address: &Address, title: String, robot: Robot) -> Result<Self, Error> {
        let robot = Arc::new(robot);
        let pictured = Arc::clone(&robot);
        let mut live = Live::begin(address, title, move || arrangement(&pictured))?;
        let drawn = Arc::clone(&robot);
        live.send(move |stream| {
            log_up(stream)?;
            arm::log_still(stream, &drawn, &arm::RECORDED)?;
            let none = JointSeries::zeros(drawn.dof(), 0);
            let empty = Watched {
                time: Vec::new(),
                q: none.clone(),
                measured: none.clone(),
                predicted: none,
            };
            (0..drawn.dof()).try_for_each(|j| {
                QUANTITIES.iter().try_for_each(|(key, ..)| {
                    log_style(stream, &entity(j, key), &empty.curves(j, key))
                })
            })
        });
        Ok(Self { live, robot })
    }

    pub fn add(&mut self, watched: &Watched, dt: f64) {
        let thinned = watched.every(((1.0 / SHOWN_HZ) / dt).round().max(1.0) as usize);
        let robot = Arc::clone(&self.robot);
        self.live.send(move |stream| thinned.log(stream, &robot));
    }

    pub fn end(self) -> Delivery {
        self.live.end()
    }
}

impl Watched {
    fn every(&self, n: usize) -> Self {
        let thin = |s: &JointSeries| s.map_joints(|_, x| x.iter().step_by(n).copied().collect());
        Self {
            time: self.time.iter().step_by(n).copied().collect(),
            q: thin(&self.q),
            measured: thin(&self.measured),
            predicted: thin(&self.predicted),
        }
    }

    fn log(&self, stream: &RecordingStream, robot: &Robot) -> Result<(), Error> {
        arm::log_motion(stream, robot, &arm::RECORDED, &self.time, &self.q)?;
        let time = TimeColumn::new_duration_secs(TIMELINE, self.time.iter().copied());
        for joint in 0..robot.dof() {
            for (key, ..) in QUANTITIES {
                log_values(stream, &time, &entity(joint, key), &self.curves(joint, key))?;
            }
        }
        Ok(())
    }

    fn curves(&self, j: usize, key: &str) -> Vec<Curve<'_>> {
        let (measured, predicted) = (self.measured.joint(j), self.predicted.joint(j));
        match key {
            "torque" => vec![
                curve("measured", palette::RECORDED, measured),
                curve("predicted", palette::SIMULATED, predicted),
            ],
            "angle" => vec![curve("measured", palette::RECORDED, self.q.joint(j))],
            _ => {
                let left = measured.iter().zip(predicted).map(|(m, p)| m - p).collect();
                vec![Curve {
                    values: std::borrow::Cow::Owned(left),
                    ..curve("difference", palette::DIFFERENCE, &[])
                }]
            }
        }
    }
}

fn entity(joint: usize, key: &str) -> String {
    format!("joint_{}/{key}", joint + 1)
}

fn arrangement(robot: &Robot) -> Node {
    let still = JointSeries::zeros(robot.dof(), 1);
    let view = arms("The arm as it stands", &arm::frame(robot, &still));
    let plot = |joint: usize, key: &str, label: &str| {
        let name = format!("{} {}: {label}", joint + 1, joint_name(robot, joint));
        time_series(name, entity(joint, key), key == "torque")
    };
    let signals = QUANTITIES.iter().map(|(key, title, label)| {
        grid(title, (0..robot.dof()).map(|j| plot(j, key, label)).collect())
    });
    columns("Watching", vec![view, tabs("Signals", signals.collect())], vec![2.0, 3.0])
}
