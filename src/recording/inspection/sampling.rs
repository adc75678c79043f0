//! Rate, jitter and gaps of the time column.

use super::quantile;

/// Longer than this many nominal steps is a gap.
const GAP_STEPS: f64 = 1.5;
/// Steps that differ by less are equal, as a share of the nominal step.
const JITTER: f64 = 0.05;

#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Sampling {
    pub start_s: f64,
    pub duration_s: f64,
    pub mean_hz: f64,
    /// Sample rate by the usual step, gaps left out, Hz.
    pub nominal_hz: f64,
    pub step_min_s: f64,
    pub step_median_s: f64,
    pub step_max_s: f64,
    /// Share of the steps that are neither gaps nor the nominal step.
    pub jitter_share: f64,
    /// Samples that fit into the gaps.
    pub missing: usize,
    pub gaps: Vec<Gap>,
}

#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Gap {
    /// Time of the sample before, s from the first sample.
    pub after_s: f64,
    pub step_s: f64,
    pub missing: usize,
}

impl Sampling {
    /// `time` rises and has at least two values.
    pub fn of(time: &[f64]) -> Self {
        let steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
        let nominal = nominal_step(&steps);
        let gap = |(k, step): (usize, &f64)| {
            let missing = (step / nominal).round() as usize - 1;
            Gap { after_s: time[k] - time[0], step_s: *step, missing }
        };
        let long = |(_, step): &(usize, &f64)| **step > GAP_STEPS * nominal;
        let gaps: Vec<Gap> = steps.iter().enumerate().filter(long).map(gap).collect();
        let uneven = steps.iter().filter(|s| (**s / nominal - 1.0).abs() > JITTER).count();
        let duration = time[time.len() - 1] - time[0];
        Self {
            start_s: time[0],
            duration_s: duration,
            mean_hz: steps.len() as f64 / duration,
            nominal_hz: 1.0 / nominal,
            step_min_s: quantile(&steps, 0.0),
            step_median_s: quantile(&steps, 0.5),
            step_max_s: quantile(&steps, 1.0),
            jitter_share: (uneven - gaps.len()) as f64 / steps.len() as f64,
            missing: gaps.iter().map(|g| g.missing).sum(),
            gaps,
        }
    }
}

/// The usual step of `time`, s: the median, whatever the gaps. `time` has at least two values.
pub fn step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Median of the steps that are no gaps, so that it stands even where every second one is missing.
fn nominal_step(steps: &[f64]) -> f64 {
    let usual = GAP_STEPS * quantile(steps, 0.1);
    let short: Vec<f64> = steps.iter().copied().filter(|s| *s <= usual).collect();
    quantile(&short, 0.5)
}
