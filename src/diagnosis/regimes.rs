//! The conditions under which a joint's gap is looked at.

use super::floor::{Floor, noise_gain};
use crate::robot::inverse_dynamics_series;
use crate::series::JointSeries;
use crate::signals::{LowPass, Samples, runs};
use crate::twin::Twin;

/// Length of a reversal after sliding has begun in the other direction, s.
const REVERSAL_S: f64 = 0.2;
/// Limits of slow and fast, as shares of the speed that a joint stays below 95 % of its sliding time.
const SLOW: f64 = 0.2;
const FAST: f64 = 0.6;
/// Warming by less is none, K.
const WARMING_K: f64 = 1.0;
/// Angles closer together are one place, rad.
const RANGE_RAD: f64 = 0.1;
/// Limits between low and mid, and between mid and high frequencies, Hz. Poses and loads change below the
/// first, links and teeth vibrate above the second.
const BANDS_HZ: [f64; 2] = [0.5, 3.0];
const BAND_ORDER: usize = 2;

/// Where a condition holds, and the residual to be looked at there.
pub struct Condition {
    pub regime: &'static str,
    /// Samples where it holds, within the joint's mask.
    pub holds: Vec<bool>,
    /// Where it is not the residual itself: its part in a band of frequencies, N.m.
    pub part: Option<Vec<f64>>,
    /// N.m
    pub floor_nm: f64,
}

/// What the joint's gear transmits according to the twin, N.m: rigid body and known loads.
pub fn transmitted(samples: &Samples, twin: &Twin) -> JointSeries {
    inverse_dynamics_series(&twin.laden(), &samples.q, &samples.qd, &samples.qdd)
}

/// All conditions at a joint; those that the data do not hold are empty. `load` is what the gear
/// transmits, N.m; `residual` is cut into bands of frequency.
pub fn conditions(
    samples: &Samples,
    joint: usize,
    mask: &[bool],
    load: &[f64],
    residual: &[f64],
    floor: &Floor,
) -> Vec<Condition> {
    let at = At { samples, joint, mask, floor_nm: floor.noise_nm };
    let mut all = vec![at.reversal()];
    all.extend(at.speeds());
    all.extend(at.loads(load));
    all.extend(at.temperatures());
    all.extend(at.angles());
    all.extend(at.times());
    all.extend(at.bands(residual));
    all
}

struct At<'a> {
    samples: &'a Samples,
    joint: usize,
    mask: &'a [bool],
    floor_nm: f64,
}

impl At<'_> {
    fn of(&self, regime: &'static str, holds: impl Fn(usize) -> bool) -> Condition {
        let holds = self.mask.iter().enumerate().map(|(k, used)| *used && holds(k)).collect();
        Condition { regime, holds, part: None, floor_nm: self.floor_nm }
    }

    /// Shortly after sliding has begun against the direction it ended in.
    fn reversal(&self) -> Condition {
        let qd = self.samples.qd.joint(self.joint);
        let threshold = self.samples.conditioning.standstill_rad_s.max(1e-6);
        let mut after = vec![false; qd.len()];
        let mut direction = 0.0;
        let reach = (REVERSAL_S / self.samples.dt).round() as usize;
        for run in self.one_way(threshold) {
            let now = qd[run.start].signum();
            if now * direction < 0.0 {
                after[run.start..run.end.min(run.start + reach)].fill(true);
            }
            direction = now;
        }
        self.of("reversal", |k| after[k])
    }

    /// Stretches of sliding in one direction.
    fn one_way(&self, threshold: f64) -> Vec<std::ops::Range<usize>> {
        let qd = self.samples.qd.joint(self.joint);
        let towards = |s: f64| runs(&qd.iter().map(|w| s * w > threshold).collect::<Vec<_>>());
        let mut both = towards(1.0);
        both.extend(towards(-1.0));
        both.sort_by_key(|r| r.start);
        both
    }

    fn speeds(&self) -> [Condition; 2] {
        let qd = self.samples.qd.joint(self.joint);
        let top = self.quantile(|k| qd[k].abs(), 0.95);
        let slow = self.of("slow", |k| qd[k].abs() < SLOW * top);
        [slow, self.of("fast", |k| qd[k].abs() > FAST * top)]
    }

    /// Is the load moved by the motor or the motor by the load, and how big is it? Absent where
    /// loads differ by no more than noise.
    fn loads(&self, load: &[f64]) -> Vec<Condition> {
        let qd = self.samples.qd.joint(self.joint);
        let [light, heavy] = [1.0 / 3.0, 2.0 / 3.0].map(|s| self.quantile(|k| load[k].abs(), s));
        if heavy - light <= self.floor_nm {
            return Vec::new();
        }
        vec![
            self.of("driven", |k| load[k] * qd[k] > 0.0),
            self.of("back_driven", |k| load[k] * qd[k] < 0.0),
            self.of("load_low", |k| load[k].abs() < light),
            self.of("load_high", |k| load[k].abs() > heavy),
        ]
    }

    fn temperatures(&self) -> Vec<Condition> {
        let Some(series) = &self.samples.temperature else { return Vec::new() };
        let t = series.joint(self.joint);
        if self.quantile(|k| t[k], 1.0) - self.quantile(|k| t[k], 0.0) < WARMING_K {
            return Vec::new();
        }
        let middle = self.quantile(|k| t[k], 0.5);
        vec![self.of("cold", |k| t[k] < middle), self.of("warm", |k| t[k] > middle)]
    }

    /// Conditions for the thirds of the joint's range of angles.
    fn angles(&self) -> Vec<Condition> {
        let q = self.samples.q.joint(self.joint);
        let (low, high) = (self.quantile(|k| q[k], 0.0), self.quantile(|k| q[k], 1.0));
        if high - low < RANGE_RAD {
            return Vec::new();
        }
        self.thirds(["angle_low", "angle_mid", "angle_high"], |k| (q[k] - low) / (high - low))
    }

    /// Conditions for the thirds of the recording in time.
    fn times(&self) -> Vec<Condition> {
        let n = self.mask.len() as f64;
        self.thirds(["time_begin", "time_middle", "time_end"], |k| k as f64 / n)
    }

    fn thirds(&self, names: [&'static str; 3], share: impl Fn(usize) -> f64) -> Vec<Condition> {
        let third = |k: usize| (3.0 * share(k)) as usize;
        let of = |(i, name)| self.of(name, |k| third(k).min(2) == i);
        names.into_iter().enumerate().map(of).collect()
    }

    /// The residual's parts in bands; standstill is bridged by straight lines before it is cut.
    fn bands(&self, residual: &[f64]) -> Vec<Condition> {
        let rate = self.samples.rate_hz();
        let filters = BANDS_HZ.map(|hz| LowPass::new(hz, rate, BAND_ORDER));
        let [Ok(low), Ok(mid)] = &filters else { return Vec::new() };
        let whole = bridged(residual, self.mask);
        let below = |filter: &LowPass, x: &[f64]| {
            let mut below = x.to_vec();
            filter.apply(&mut below);
            below
        };
        let less =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let cut = |x: &[f64]| {
            let (slow, slower) = (below(mid, x), below(low, x));
            [slower.clone(), less(&slow, &slower), less(x, &slow)]
        };
        let filter = self.samples.torque_filter().ok().flatten();
        let all = noise_gain(filter.as_ref(), |x| x);
        let gains = [0, 1, 2].map(|band| noise_gain(filter.as_ref(), |x| cut(&x)[band].clone()));
        let names = ["low_frequency", "mid_frequency", "high_frequency"];
        let parts = names.into_iter().zip(cut(&whole)).zip(gains);
        let of = |((name, part), gain): ((&'static str, Vec<f64>), f64)| Condition {
            part: Some(part),
            floor_nm: self.floor_nm * (gain / all).sqrt(),
            ..self.of(name, |_| true)
        };
        parts.map(of).collect()
    }

    /// Quantile of `value` at `share`, within the mask; 0 without samples.
    fn quantile(&self, value: impl Fn(usize) -> f64, share: f64) -> f64 {
        let used = (0..self.mask.len()).filter(|&k| self.mask[k]);
        let mut values: Vec<f64> = used.map(value).collect();
        values.sort_by(f64::total_cmp);
        let place = share * values.len().saturating_sub(1) as f64;
        values.get(place.round() as usize).copied().unwrap_or(0.0)
    }
}

/// Straight lines where `mask` is false; the nearest value beyond the ends.
fn bridged(x: &[f64], mask: &[bool]) -> Vec<f64> {
    let mut out = x.to_vec();
    let known = runs(mask);
    let (Some(first), Some(last)) = (known.first(), known.last()) else {
        return vec![0.0; x.len()];
    };
    out[..first.start].fill(x[first.start]);
    out[last.end..].fill(x[last.end - 1]);
    for pair in known.windows(2) {
        let (from, to) = (pair[0].end - 1, pair[1].start);
        let step = (x[to] - x[from]) / (to - from) as f64;
        for (k, between) in out[from..to].iter_mut().enumerate() {
            *between = x[from] + k as f64 * step;
        }
    }
    out
}
