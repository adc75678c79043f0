//! Which samples enter a regression: usable, sliding, and one in every few.

use std::ops::Range;

use super::Samples;

/// Samples per period of the torque cutoff that decimation keeps.
const KEPT_PER_CUTOFF: f64 = 2.5;

/// Rows of a regression: which samples, and when.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rows {
    /// Sample of each row, increasing.
    pub samples: Vec<usize>,
    /// `samples` over the decimation factor: neighbouring rows whose slots differ by 1 are
    /// neighbours in time, others have masked samples between them.
    pub slots: Vec<usize>,
    /// Decimation factor of the joint's samples.
    pub decimation: usize,
}

impl Rows {
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// The rows' values of a series on the full grid.
    pub fn take(&self, series: &[f64]) -> Vec<f64> {
        self.samples.iter().map(|&k| series[k]).collect()
    }
}

impl Samples {
    /// True where `joint` slides: |qd| above the standstill threshold and further than `guard_s`
    /// from any sample below it.
    pub fn sliding(&self, joint: usize) -> Vec<bool> {
        let threshold = self.conditioning.standstill_rad_s;
        let qd = self.qd.joint(joint);
        let fast: Vec<bool> = qd.iter().map(|v| threshold <= 0.0 || v.abs() > threshold).collect();
        erode(&fast, self.count(self.conditioning.guard_s))
    }

    /// Sliding and usable: what a sliding model may be fitted on. Where positions are explained, those that tell
    /// something new.
    pub fn mask(&self, joint: usize) -> Vec<bool> {
        if let (Some(_), Some(told)) = (&self.response, &self.told) {
            return fresh(told.q.joint(joint), told.resolution[joint], &self.usable);
        }
        let sliding = self.sliding(joint);
        sliding.iter().zip(&self.usable).map(|(s, u)| *s && *u).collect()
    }

    /// Low-passed signals are redundant: keep every n-th sample, 2.5 per period of the torque
    /// cutoff. 1 where torque is not filtered, or positions are explained.
    pub fn decimation(&self) -> usize {
        let cutoff = self.conditioning.torque_cutoff_hz;
        let follow = || match cutoff > 0.0 && self.response.is_none() {
            true => (self.rate_hz() / (KEPT_PER_CUTOFF * cutoff)) as usize,
            false => 1,
        };
        self.conditioning.decimation.unwrap_or_else(follow).max(1)
    }

    /// The rows of a regression on the sliding, usable samples of `joint`, decimated.
    pub fn rows(&self, joint: usize) -> Rows {
        self.rows_where(&self.mask(joint))
    }

    /// The rows of a regression on the samples where `mask` is true, decimated.
    pub fn rows_where(&self, mask: &[bool]) -> Rows {
        let decimation = self.decimation();
        let samples: Vec<usize> =
            (0..self.len()).step_by(decimation).filter(|&k| mask[k]).collect();
        let slots = samples.iter().map(|k| k / decimation).collect();
        Rows { samples, slots, decimation }
    }

    pub(super) fn count(&self, seconds: f64) -> usize {
        (seconds / self.dt).round() as usize
    }
}

/// Which of the usable readings `q` of an encoder with this `step` (both rad) tell something new. One that stays within the encoder's step is one reading however long it
/// stays, with one rounding error: the sample in the middle stands for it, where the error takes no side.
pub fn fresh(q: &[f64], step: f64, usable: &[bool]) -> Vec<bool> {
    let mut fresh = vec![false; q.len()];
    for run in runs(usable) {
        let mut from = run.start;
        for next in run.start + 1..=run.end {
            if next == run.end || (q[next] - q[from]).abs() > 0.5 * step {
                fresh[(from + next - 1) / 2] = true;
                from = next;
            }
        }
    }
    fresh
}

/// True where all of the `reach` neighbours on both sides are true; nothing is known beyond the
/// ends, so they do not count.
pub fn erode(mask: &[bool], reach: usize) -> Vec<bool> {
    let mut kept = mask.to_vec();
    for off in runs(&mask.iter().map(|m| !m).collect::<Vec<_>>()) {
        let (from, to) = (off.start.saturating_sub(reach), (off.end + reach).min(mask.len()));
        kept[from..to].fill(false);
    }
    kept
}

/// Contiguous stretches of true.
pub fn runs(mask: &[bool]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut start = None;
    for (k, &on) in mask.iter().enumerate() {
        match (on, start) {
            (true, None) => start = Some(k),
            (false, Some(from)) => {
                runs.push(from..k);
                start = None;
            }
            _ => {}
        }
    }
    runs.extend(start.map(|from| from..mask.len()));
    runs
}
