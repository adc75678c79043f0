//! A recording made ready: its motion, and what the twin leaves of its torque.

use std::path::Path;

use crate::effects::{Motion, Scope, Size};
use crate::recording::Recording;
use crate::regression::qr::{Qr, unexplained};
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::signals::{Conditioning, LowPass, Rows, Samples, condition};
use crate::trials::TrialError;
use crate::trials::strength::rms;
use crate::twin::Twin;

/// Rows that a joint must slide in to count as moving.
const FEWEST_ROWS: usize = 50;
/// A joint is never taken for known better than this, N.m: a simulated one can be.
const LEAST_NM: f64 = 1e-6;

pub struct Ground {
    /// The recording as it came.
    pub recording: Recording,
    pub samples: Samples,
    /// The robot with the loads the twin knows of.
    robot: Robot,
    /// How large the arm is, its loads aside: the catalogue's ranges go with it.
    pub size: Size,
    filter: Option<LowPass>,
    /// Rows of each joint that are sliding and usable.
    rows: Vec<Rows>,
    /// Orthonormal columns of what the twin leaves open, at those rows.
    open: Vec<Vec<Vec<f64>>>,
    /// What the twin with its open effects fitted leaves of each joint, N.m.
    pub left_nm: Vec<f64>,
    /// What the recorded velocity differs from that of the recorded position, rad/s; empty where no
    /// velocity is recorded.
    pub velocity_left: Vec<f64>,
}

impl Ground {
    /// # Errors
    /// If the recording lacks what the twin needs, or no joint of it moves.
    pub fn new(recording: Recording, twin: &Twin, how: &Conditioning) -> Result<Self, TrialError> {
        let source = recording.provenance.source.clone();
        let wrong = |problem: String| TrialError::file(Path::new(&source), problem);
        let dof = twin.robot.dof();
        let samples =
            condition(&recording, &twin.drive, dof, how).map_err(|e| wrong(e.to_string()))?;
        let samples = twin.correct(&samples);
        let filter = samples.torque_filter().map_err(|e| wrong(e.to_string()))?;
        let mut ground = Self {
            rows: (0..dof).map(|j| samples.rows(j)).collect(),
            open: vec![Vec::new(); dof],
            left_nm: Vec::new(),
            velocity_left: Vec::new(),
            robot: twin.laden(),
            size: Size::of(&twin.robot),
            filter,
            samples,
            recording,
        };
        if ground.moving().is_empty() {
            return Err(wrong("no joint moves long enough to graft anything onto it".into()));
        }
        ground.open = (0..dof).map(|j| ground.open_columns(twin, j)).collect();
        ground.left_nm = ground.left(twin);
        ground.velocity_left = ground.velocity_error();
        Ok(ground)
    }

    /// Motion along the recording. `known` is the recorded torque: what scales the drive's scales that.
    pub fn motion(&self) -> Motion<'_> {
        let Samples { dt, start, q, qd, qdd, torque, temperature, conditioning, .. } =
            &self.samples;
        Motion {
            start: *start,
            temperature: temperature.as_ref(),
            band_hz: match conditioning.torque_cutoff_hz {
                cutoff if cutoff > 0.0 => cutoff,
                _ => f64::INFINITY,
            },
            known: Some(torque),
            ..Motion::new(&self.robot, *dt, q, qd, qdd)
        }
    }

    pub fn dof(&self) -> usize {
        self.samples.joints()
    }

    /// Joints that slide long enough to show anything, from 0.
    pub fn moving(&self) -> Vec<usize> {
        (0..self.dof()).filter(|j| self.rows[*j].len() >= FEWEST_ROWS).collect()
    }

    pub fn duration_s(&self) -> f64 {
        self.samples.len() as f64 * self.samples.dt
    }

    /// The sliding rows of one joint, low-passed as a regression does.
    fn taken(&self, joint: usize, series: &[f64]) -> Vec<f64> {
        let mut column = [series.to_vec()];
        if let Some(filter) = &self.filter {
            filter.apply_many(&mut column);
        }
        self.rows[joint].take(&column[0])
    }

    fn open_columns(&self, twin: &Twin, joint: usize) -> Vec<Vec<f64>> {
        let motion = Motion { known: None, ..self.motion() };
        let mut open: Vec<Vec<f64>> = Vec::new();
        for effect in twin.open() {
            let all: Vec<Vec<f64>> = match effect.about().scope {
                Scope::Link => (0..self.dof())
                    .flat_map(|from| effect.reach(&motion, from, &twin.nonlinear_at(effect, from)))
                    .map(|series| series.joint(joint).to_vec())
                    .collect(),
                _ => effect.columns(&motion, joint, &twin.nonlinear_at(effect, joint)),
            };
            open.extend(all.iter().map(|column| self.taken(joint, column)));
        }
        Qr::new(open).q
    }

    /// Root mean square of what the twin's open effects cannot take up of a torque, N.m per joint;
    /// 0 for joints that do not move.
    pub fn beyond_twin(&self, torque: &JointSeries) -> Vec<f64> {
        self.each_moving(|j| rms(&unexplained(&self.open[j], self.taken(j, torque.joint(j)))))
    }

    /// Root mean square of a torque while sliding, N.m per joint.
    pub fn own(&self, torque: &JointSeries) -> Vec<f64> {
        self.each_moving(|j| rms(&self.taken(j, torque.joint(j))))
    }

    /// Root mean square of any signal while sliding, not low-passed, one per joint.
    pub fn sliding(&self, signal: &JointSeries) -> Vec<f64> {
        self.each_moving(|j| rms(&self.rows[j].take(signal.joint(j))))
    }

    fn each_moving(&self, of: impl Fn(usize) -> f64) -> Vec<f64> {
        let moving = self.moving();
        (0..self.dof()).map(|j| if moving.contains(&j) { of(j) } else { 0.0 }).collect()
    }

    fn left(&self, twin: &Twin) -> Vec<f64> {
        let known = twin.torque(&twin.motion(&self.samples));
        let gap = difference(&self.samples.torque, &known);
        self.beyond_twin(&gap).into_iter().map(|left| left.max(LEAST_NM)).collect()
    }

    fn velocity_error(&self) -> Vec<f64> {
        let Some(sensed) = &self.samples.sensed else { return Vec::new() };
        self.sliding(&difference(&sensed.qd, &self.samples.qd))
    }
}

fn difference(a: &JointSeries, b: &JointSeries) -> JointSeries {
    a.map_joints(|j, a| a.iter().zip(b.joint(j)).map(|(a, b)| a - b).collect())
}
