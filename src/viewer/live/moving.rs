//! A simulated arm beside the motion it was told to make, while it moves.

use std::borrow::Cow;
use std::sync::Arc;

use rerun::{RecordingStream, TimeColumn};

use super::{Address, Delivery, Live, STRETCH_S};
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::viewer::blueprint::{Node, arms, columns, grid, tabs, time_series};
use crate::viewer::layout::joint_name;
use crate::viewer::plots::{Curve, TIMELINE, curve, log_style, log_values};
use crate::viewer::scene::log_up;
use crate::viewer::{Error, arm, palette};

/// In the order of their tabs: key in the entity path, title, label with unit.
const QUANTITIES: [(&str, &str, &str); 3] = [
    ("tracking", "Tracking", "angle, simulated - commanded / mrad"),
    ("torque", "Torques", "motor torque / N.m"),
    ("angle", "Angles", "angle / rad"),
];

pub struct Moving {
    live: Live,
    robot: Arc<Robot>,
    stretch: Stretch,
}

/// Signals since the last message, joint by joint: rad, rad, N.m.
#[derive(Default)]
struct Stretch {
    time: Vec<f64>,
    q: Vec<Vec<f64>>,
    commanded: Vec<Vec<f64>>,
    torque: Vec<Vec<f64>>,
}

impl Moving {
    /// `planned` is the commanded motion, rad, coarse: its flange path is drawn, and the camera
    /// looks at it.
    ///
    /// # Errors
    /// If the system has no thread left.
    pub fn begin(
        address: &Address,
        title: String,
        robot: Robot,
        planned: JointSeries,
    ) -> Result<Self, Error> {
        let robot = Arc::new(robot);
        let (pictured, path) = (Arc::clone(&robot), planned.clone());
        let mut live = Live::begin(address, title, move || arrangement(&pictured, &path))?;
        let drawn = Arc::clone(&robot);
        live.send(move |stream| {
            log_up(stream)?;
            [arm::MOVED, arm::COMMANDED]
                .iter()
                .try_for_each(|l| arm::log_still(stream, &drawn, l))?;
            arm::log_path(stream, &drawn, &arm::COMMANDED, &planned)?;
            Stretch::new(drawn.dof()).log_styles(stream)
        });
        let stretch = Stretch::new(robot.dof());
        Ok(Self { live, robot, stretch })
    }

    /// Adds an instant: s, rad, N.m, rad.
    pub fn add(&mut self, time_s: f64, q: &[f64], torque: &[f64], commanded: &[f64]) {
        let now = &mut self.stretch;
        now.time.push(time_s);
        for (series, values) in
            [(&mut now.q, q), (&mut now.torque, torque), (&mut now.commanded, commanded)]
        {
            series.iter_mut().zip(values).for_each(|(s, v)| s.push(*v));
        }
        if time_s - now.time[0] >= STRETCH_S {
            self.send();
        }
    }

    pub fn end(mut self) -> Delivery {
        if !self.stretch.time.is_empty() {
            self.send();
        }
        self.live.end()
    }

    fn send(&mut self) {
        let whole = std::mem::replace(&mut self.stretch, Stretch::new(self.robot.dof()));
        let robot = Arc::clone(&self.robot);
        self.live.send(move |stream| whole.log(stream, &robot));
    }
}

impl Stretch {
    fn new(dof: usize) -> Self {
        let none = vec![Vec::new(); dof];
        Self { time: Vec::new(), q: none.clone(), commanded: none.clone(), torque: none }
    }

    fn log(&self, stream: &RecordingStream, robot: &Robot) -> Result<(), Error> {
        for (look, q) in [(arm::MOVED, &self.q), (arm::COMMANDED, &self.commanded)] {
            arm::log_motion(stream, robot, &look, &self.time, &JointSeries::from_joints(q))?;
        }
        let time = TimeColumn::new_duration_secs(TIMELINE, self.time.iter().copied());
        for joint in 0..robot.dof() {
            for (key, ..) in QUANTITIES {
                log_values(stream, &time, &entity(joint, key), &self.curves(joint, key))?;
            }
        }
        Ok(())
    }

    fn log_styles(&self, stream: &RecordingStream) -> Result<(), Error> {
        for joint in 0..self.q.len() {
            for (key, ..) in QUANTITIES {
                log_style(stream, &entity(joint, key), &self.curves(joint, key))?;
            }
        }
        Ok(())
    }

    fn curves(&self, j: usize, key: &str) -> Vec<Curve<'_>> {
        let (q, commanded) = (&self.q[j], &self.commanded[j]);
        match key {
            "torque" => vec![curve("simulated", palette::RECORDED, &self.torque[j])],
            "angle" => vec![
                curve("commanded", palette::TARGET, commanded),
                curve("simulated", palette::RECORDED, q),
            ],
            _ => {
                let values =
                    Cow::Owned(q.iter().zip(commanded).map(|(q, c)| 1e3 * (q - c)).collect());
                vec![Curve { values, ..curve("difference", palette::DIFFERENCE, &[]) }]
            }
        }
    }
}

fn entity(joint: usize, key: &str) -> String {
    format!("joint_{}/{key}", joint + 1)
}

fn arrangement(robot: &Robot, planned: &JointSeries) -> Node {
    let view = arms("Simulated (solid) and commanded (translucent)", &arm::frame(robot, planned));
    let plot = |joint: usize, key: &str, label: &str| {
        let name = format!("{} {}: {label}", joint + 1, joint_name(robot, joint));
        time_series(name, entity(joint, key), key == "angle")
    };
    let signals = QUANTITIES.iter().map(|(key, title, label)| {
        grid(title, (0..robot.dof()).map(|j| plot(j, key, label)).collect())
    });
    columns("Simulation", vec![view, tabs("Signals", signals.collect())], vec![2.0, 3.0])
}
