//! A recording as servos saw it: command and position on one grid, and where each stretch may begin.

use super::ServoError;
use super::step::steps;
use crate::robot::Told;
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::twin::Twin;

/// Command, position and the state it was in, at uniform instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// s
    pub dt: f64,
    /// Steps of a simulation from one sample to the next.
    pub steps: usize,
    /// Time of the first sample in the recording, s.
    pub start: f64,
    /// All that is recorded of what the servos were told.
    pub told: Told,
    /// Position as recorded, rad.
    pub q: JointSeries,
    /// Smoothed position and velocity, where a simulation may begin, rad and rad/s.
    pub smooth_q: JointSeries,
    pub qd: JointSeries,
    /// Gain of every servo over its nominal one; 0 while it is off.
    pub factor: JointSeries,
    /// deg C, where recorded.
    pub temperature: Option<JointSeries>,
    /// False in gaps of the recording.
    pub usable: Vec<bool>,
    /// Smallest step between recorded positions, rad per joint.
    pub resolution: Vec<f64>,
}

impl Track {
    /// The track of a recording that was conditioned with the servos of `twin`.
    ///
    /// # Errors
    /// If its torque is recorded and no servo was asked, or the twin has none.
    pub fn new(samples: &Samples, twin: &Twin) -> Result<Self, ServoError> {
        let assumed = twin.drive.servo.as_ref().ok_or(ServoError::NoServo)?;
        let told = samples.told.as_ref().ok_or(ServoError::NotTold)?;
        Ok(Self {
            dt: samples.dt,
            steps: steps(twin, told),
            start: samples.start,
            told: told.clone(),
            q: told.q.clone(),
            smooth_q: samples.q.clone(),
            qd: samples.qd.clone(),
            factor: told.gain.map_joints(|j, g| g.iter().map(|g| g / assumed.gain[j]).collect()),
            temperature: samples.temperature.clone(),
            usable: told.recorded.clone(),
            resolution: told.resolution.clone(),
        })
    }

    /// Two recordings of one arm, whose encoders are the same: where a joint stands still a recording does not tell their step,
    /// and the other may.
    pub fn of_one_arm([mut a, mut b]: [Self; 2]) -> [Self; 2] {
        for (one, other) in a.resolution.iter_mut().zip(&mut b.resolution) {
            let step = one.max(*other);
            (*one, *other) = (step, step);
        }
        [a, b]
    }

    /// The same, its commands sent so much later beside positions, s.
    pub fn later(&self, by: f64) -> Self {
        let mut later = self.clone();
        later.told.late += by;
        later
    }

    /// Every other stretch of `seconds`, and those between; shorter ones where there would not be two of each.
    pub fn halves(&self, seconds: f64) -> [Self; 2] {
        let recorded_s = self.usable.iter().filter(|usable| **usable).count() as f64 * self.dt;
        let stretches = self.stretches(seconds.min(recorded_s / 4.0));
        [0, 1].map(|first| {
            let mut half = self.clone();
            let others = stretches.iter().skip(1 - first).step_by(2);
            others.for_each(|s| half.usable[s.clone()].fill(false));
            half
        })
    }

    /// Step of a simulation, s.
    pub fn step_s(&self) -> f64 {
        self.dt / self.steps as f64
    }

    pub fn joints(&self) -> usize {
        self.q.joints()
    }

    pub fn len(&self) -> usize {
        self.q.samples()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Stretches without a gap, of `seconds` at most, as ranges of samples.
    pub fn stretches(&self, seconds: f64) -> Vec<std::ops::Range<usize>> {
        let most = ((seconds / self.dt).min(self.len() as f64) as usize).max(2);
        let mut all = Vec::new();
        for run in crate::signals::runs(&self.usable) {
            let mut from = run.start;
            while from < run.end {
                // What is left over belongs to the last one.
                let rest = run.end - from;
                let take = if rest < most + most / 2 { rest } else { most };
                all.push(from..from + take);
                from += take;
            }
        }
        all.retain(|s| s.len() > 1);
        all
    }
}
