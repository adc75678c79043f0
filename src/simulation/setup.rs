//! Everything a simulation needs, checked: what a scenario comes down to.

use super::{ControllerSettings, Injection, Noise, Quantisation, Thermal};
use crate::robot::{Drive, Robot};

/// An arm, what is hidden in it, who drives it and what is recorded.
#[derive(Clone)]
pub struct Setup {
    /// The nominal arm, as the controller knows it.
    pub robot: Robot,
    pub drive: Drive,
    pub effects: Vec<Injection>,
    pub controller: ControllerSettings,
    pub noise: Noise,
    pub quantisation: Quantisation,
    pub thermal: Thermal,
    pub clock: Clock,
}

/// Step, controller hold and recording interval: whole multiples of each other, in this order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    pub step_s: f64,
    pub steps_per_hold: usize,
    pub steps_per_sample: usize,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ClockError {
    #[error("{key} = {value}: give a number {condition}")]
    Number { key: &'static str, value: f64, condition: &'static str },
    #[error(
        "{key} = {value} does not fit: {faster} Hz must be a whole multiple of it (for example \
         {example})"
    )]
    Multiple { key: &'static str, value: f64, faster: f64, example: f64 },
}

impl Clock {
    /// From the step (s), the controller's rate and the recording's rate (Hz).
    ///
    /// # Errors
    /// If 1/step is not a whole multiple of the controller's rate, or that not of the recording's.
    pub fn new(step_s: f64, controller_hz: f64, recording_hz: f64) -> Result<Self, ClockError> {
        let must = |key, value, holds: bool, condition| match holds {
            true => Ok(()),
            false => Err(ClockError::Number { key, value, condition }),
        };
        must("step_s", step_s, (1e-6..=0.01).contains(&step_s), "from 0.000001 to 0.01 s")?;
        let rate = 1.0..=1e5;
        let condition = "from 1 to 100000 Hz";
        must("controller.rate_hz", controller_hz, rate.contains(&controller_hz), condition)?;
        must("rate_hz", recording_hz, rate.contains(&recording_hz), condition)?;
        let steps_per_hold = multiple("controller.rate_hz", controller_hz, 1.0 / step_s)?;
        let holds_per_sample = multiple("rate_hz", recording_hz, controller_hz)?;
        Ok(Self { step_s, steps_per_hold, steps_per_sample: holds_per_sample * steps_per_hold })
    }

    /// With steps of at most `longest_s`, a whole part of this clock's; rates stay.
    pub(super) fn refined(&self, longest_s: f64) -> Self {
        let parts = (self.step_s / longest_s - 1e-9).ceil().max(1.0) as usize;
        Self {
            step_s: self.step_s / parts as f64,
            steps_per_hold: self.steps_per_hold * parts,
            steps_per_sample: self.steps_per_sample * parts,
        }
    }

    /// Does the controller set a new torque at step `k`? The samples lie in the middle of a hold.
    pub fn controls(&self, k: usize) -> bool {
        k == 0 || (k + self.steps_per_hold / 2).is_multiple_of(self.steps_per_hold)
    }

    pub fn samples(&self, k: usize) -> bool {
        k.is_multiple_of(self.steps_per_sample)
    }
}

fn multiple(key: &'static str, value: f64, faster: f64) -> Result<usize, ClockError> {
    let times = (faster / value).round().max(1.0);
    if (times * value / faster - 1.0).abs() > 1e-9 {
        let example = faster / times;
        return Err(ClockError::Multiple { key, value, faster, example });
    }
    Ok(times as usize)
}
