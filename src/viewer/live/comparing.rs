//! A comparison while its twin is still being simulated.

use std::ops::Range;
use std::sync::Arc;

use super::{Address, Delivery, Live, STRETCH_S};
use crate::series::JointSeries;
use crate::viewer::plots::{ANGLE, RESIDUAL, TORQUE, TRACKING, VELOCITY};
use crate::viewer::scene::{log_frame, log_up};
use crate::viewer::{Comparison, Error, Motion, Torque, arm, layout, plots};

pub struct Comparing {
    live: Live,
    /// What the twin does is filled in as it comes.
    shown: Comparison,
    /// Samples that are filled in, and that are sent.
    known: usize,
    sent: usize,
    /// The instant before: s, rad.
    before: Option<(f64, Vec<f64>)>,
}

impl Comparing {
    /// Sends all of `known` but what the twin does: `simulated` and `summary` may hold anything.
    ///
    /// # Errors
    /// Series that do not fit the arm or the time base; if the system has no thread left.
    pub fn begin(address: &Address, known: Comparison) -> Result<Self, Error> {
        known.check_shapes()?;
        let first = Arc::new(known.clone());
        let arranged = Arc::clone(&first);
        let mut live = Live::begin(address, known.title.clone(), move || layout::root(&arranged))?;
        live.send(move |stream| {
            log_up(stream)?;
            arm::log(stream, &first.robot, &arm::RECORDED, &first.time, &first.recorded.q)?;
            arm::log_still(stream, &first.robot, &arm::SIMULATED)?;
            plots::log_styles(stream, &first, &[&ANGLE, &TRACKING])?;
            plots::log(stream, &first, &[&TORQUE, &RESIDUAL])
        });
        Ok(Self { live, shown: known, known: 0, sent: 0, before: None })
    }

    /// The twin's position `q`, rad, at `time_s`, later than the one before. Between two instants
    /// the samples are put on straight lines.
    pub fn add(&mut self, time_s: f64, q: &[f64]) {
        let (t0, q0) = self.before.take().unwrap_or_else(|| (time_s, q.to_vec()));
        while self.shown.time.get(self.known).is_some_and(|&t| t <= time_s) {
            let t = self.shown.time[self.known];
            let share = if time_s > t0 { ((t - t0) / (time_s - t0)).max(0.0) } else { 1.0 };
            let now: Vec<f64> = q0.iter().zip(q).map(|(a, b)| a + share * (b - a)).collect();
            self.shown.simulated.q.set_sample(self.known, &now);
            self.known += 1;
        }
        self.before = Some((time_s, q.to_vec()));
        if self.known > self.sent
            && self.shown.time[self.known - 1] - self.shown.time[self.sent] >= STRETCH_S
        {
            self.send();
        }
    }

    /// Adds what is known only at the end.
    pub fn end(mut self, whole: &Comparison) -> Delivery {
        // The last samples may lie beyond the last instant.
        let mut now = vec![0.0; whole.simulated.q.joints()];
        while self.known < self.shown.time.len() {
            whole.simulated.q.sample_into(self.known, &mut now);
            self.shown.simulated.q.set_sample(self.known, &now);
            self.known += 1;
        }
        if self.known > self.sent {
            self.send();
        }
        let whole = whole.clone();
        self.live.send(move |stream| {
            log_frame(stream, &whole.summary)?;
            arm::log_path(stream, &whole.robot, &arm::SIMULATED, &whole.simulated.q)?;
            plots::log(stream, &whole, &[&VELOCITY])
        });
        self.live.end()
    }

    fn send(&mut self) {
        let stretch = self.shown.stretch(self.sent..self.known);
        self.sent = self.known;
        self.live.send(move |stream| {
            let (robot, q) = (&stretch.robot, &stretch.simulated.q);
            arm::log_motion(stream, robot, &arm::SIMULATED, &stretch.time, q)?;
            plots::log_stretch(stream, &stretch, &[&ANGLE, &TRACKING])
        });
    }
}

impl Comparison {
    fn stretch(&self, range: Range<usize>) -> Self {
        let of = |s: &JointSeries| s.map_joints(|_, values| values[range.clone()].to_vec());
        let motion = |m: &Motion| Motion { q: of(&m.q), qd: of(&m.qd) };
        let Torque { measured, predicted } = &self.torque;
        Self {
            title: self.title.clone(),
            robot: self.robot.clone(),
            time: self.time[range.clone()].to_vec(),
            recorded: motion(&self.recorded),
            simulated: motion(&self.simulated),
            target_q: self.target_q.as_ref().map(of),
            torque: Torque { measured: of(measured), predicted: of(predicted) },
            summary: String::new(),
        }
    }
}
