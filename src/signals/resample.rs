//! From recorded instants onto a uniform grid.

use std::ops::Range;

/// How a value between two recorded instants comes about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// The straight line through the two neighbours.
    Linear,
    /// Lagrange's cubic through the two neighbours on either side.
    Cubic,
}

/// Steps this close to the commonest one count as equal to it.
const AGREE: f64 = 0.02;
/// Grid instants this close to a recorded one (in periods) take its value unchanged.
const SNAP: f64 = 1e-3;

/// Equidistant instants `start + k dt` over a recording, and where each falls between recorded
/// instants; [`UniformGrid::resample`] carries any number of columns over.
#[derive(Debug, Clone, PartialEq)]
pub struct UniformGrid {
    /// s
    pub start: f64,
    /// s
    pub dt: f64,
    interpolation: Interpolation,
    /// For each instant the recorded interval it lies in and how far into it, 0 to 1.
    places: Vec<(usize, f64)>,
    recorded: Vec<f64>,
    gap_s: f64,
}

impl UniformGrid {
    /// `time` strictly increasing, at least two instants; `rate_hz` as in
    /// [`super::Conditioning::rate_hz`]; steps longer than `gap_periods` usual steps are gaps.
    pub fn new(
        time: &[f64],
        rate_hz: Option<f64>,
        interpolation: Interpolation,
        gap_periods: f64,
    ) -> Self {
        let period = usual_step(time, gap_periods);
        let dt = rate_hz.map_or(period, |rate| 1.0 / rate);
        let duration = time[time.len() - 1] - time[0];
        let samples = (duration / dt + SNAP).floor() as usize + 1;
        let places = place(time, dt, samples, period);
        let gap_s = gap_periods * period;
        Self { start: time[0], dt, interpolation, places, recorded: time.to_vec(), gap_s }
    }

    /// Instants on the grid.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Instants that lie inside gaps of the recording.
    pub fn in_gap(&self) -> Vec<bool> {
        self.places.iter().map(|&(i, u)| u > 0.0 && u < 1.0 && self.is_gap(i)).collect()
    }

    /// Gaps as recording times, s.
    pub fn gaps(&self) -> Vec<Range<f64>> {
        let t = &self.recorded;
        (0..t.len() - 1).filter(|&i| self.is_gap(i)).map(|i| t[i]..t[i + 1]).collect()
    }

    /// Share of instants whose value is interpolated rather than taken as recorded.
    pub fn interpolated(&self) -> f64 {
        let between = self.places.iter().filter(|(_, u)| *u > 0.0 && *u < 1.0).count();
        between as f64 / self.len() as f64
    }

    /// `values` at the recorded instants -> values on the grid.
    pub fn resample(&self, values: &[f64]) -> Vec<f64> {
        self.places.iter().map(|&(i, u)| self.value(values, i, u)).collect()
    }

    fn is_gap(&self, i: usize) -> bool {
        self.recorded[i + 1] - self.recorded[i] > self.gap_s
    }

    fn value(&self, y: &[f64], i: usize, u: f64) -> f64 {
        if u == 0.0 {
            return y[i];
        }
        if u == 1.0 {
            return y[i + 1];
        }
        let inside = i > 0 && i + 2 < y.len();
        let smooth = self.interpolation == Interpolation::Cubic && inside;
        if !smooth || (i - 1..i + 2).any(|k| self.is_gap(k)) {
            return y[i] + u * (y[i + 1] - y[i]);
        }
        let t = &self.recorded[i - 1..i + 3];
        lagrange(t, &y[i - 1..i + 3], t[1] + u * (t[2] - t[1]))
    }
}

/// The polynomial through the points (t, y), at `x`.
fn lagrange(t: &[f64], y: &[f64], x: f64) -> f64 {
    let basis = |i: usize| {
        let others = (0..t.len()).filter(|&k| k != i);
        others.map(|k| (x - t[k]) / (t[i] - t[k])).product::<f64>()
    };
    y.iter().enumerate().map(|(i, y)| y * basis(i)).sum()
}

/// The commonest step, refined to the mean of the steps that agree with it; where fewer than four
/// in five agree, the mean of all steps that are no gaps.
fn usual_step(time: &[f64], gap_periods: f64) -> f64 {
    let steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let agree = |s: &&f64| (**s - median).abs() <= AGREE * median;
    let no_gap = |s: &&f64| **s <= gap_periods * median;
    if steps.iter().filter(agree).count() * 5 >= steps.len() * 4 {
        mean(steps.iter().filter(agree))
    } else {
        mean(steps.iter().filter(no_gap))
    }
}

fn mean<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(s, n), v| (s + v, n + 1));
    sum / count as f64
}

/// The interval and fraction of each grid instant, snapped to recorded instants.
fn place(time: &[f64], dt: f64, samples: usize, period: f64) -> Vec<(usize, f64)> {
    let mut i = 0;
    let mut at = |k: usize| {
        let t = time[0] + k as f64 * dt;
        while i + 2 < time.len() && time[i + 1] <= t {
            i += 1;
        }
        let (from, to) = (t - time[i], time[i + 1] - t);
        let near = SNAP * period;
        if from <= near {
            (i, 0.0)
        } else if to <= near {
            (i, 1.0)
        } else {
            (i, from / (from + to))
        }
    };
    (0..samples).map(&mut at).collect()
}
