//! How each joint moves: what there is to identify from.

use crate::recording::Recording;
use crate::series::JointSeries;

/// Slower is not sliding.
pub const SLIDING_RAD_S: f64 = 0.02;
/// Slower is rest, if it lasts.
const REST_RAD_S: f64 = 0.01;
/// Rest begins this long after a motion and ends as long before the next.
const SETTLE_S: f64 = 0.2;
/// Half width of the difference for velocity where none is recorded, and for acceleration, s.
const DIFFERENCE_S: f64 = 0.03;
/// A joint that stays within less shakes, whatever its velocity says.
const TRAVEL_RAD: f64 = 0.01;
/// Fewer sliding samples say nothing about correlation.
const FEWEST_SLIDING: usize = 20;

#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct JointMotion {
    /// From 1 at the base.
    pub joint: usize,
    pub low_rad: f64,
    pub high_rad: f64,
    /// Largest velocity against and along the axis, rad/s.
    pub speed_low: f64,
    pub speed_high: f64,
    /// Largest |acceleration|, from velocity by differences over 60 ms, rad/s^2.
    pub acceleration: f64,
    /// Share of the samples with |qd| above [`SLIDING_RAD_S`].
    pub moving_share: f64,
    /// Changes between sliding along and sliding against the axis, vibration smoothed over 60 ms.
    pub reversals: usize,
    /// Correlation of the recorded velocity with the differentiated position, while sliding.
    pub velocity_correlation: Option<f64>,
    /// Slope of the recorded velocity over the differentiated position, while sliding.
    pub velocity_slope: Option<f64>,
}

impl JointMotion {
    /// Whether it goes anywhere, rather than standing or shaking.
    pub fn travels(&self) -> bool {
        self.high_rad - self.low_rad > TRAVEL_RAD && self.moving_share > 0.0
    }

    pub fn top_speed(&self) -> f64 {
        self.speed_high.max(-self.speed_low)
    }
}

/// As recorded, else from the position.
pub fn velocity(recording: &Recording, joints: usize) -> JointSeries {
    let time = &recording.time;
    let recorded = recording.joints("actual_qd");
    let derived = || recording.joints("actual_q").map(|q| q.map_joints(|_, x| slope(time, x)));
    recorded.or_else(derived).unwrap_or_else(|| JointSeries::zeros(joints, time.len()))
}

/// (x(t + h) - x(t - h)) / 2h with h about [`DIFFERENCE_S`], one-sided at the ends.
fn slope(time: &[f64], x: &[f64]) -> Vec<f64> {
    let n = time.len();
    let step = (time[n - 1] - time[0]) / (n - 1) as f64;
    let h = ((DIFFERENCE_S / step).round() as usize).clamp(1, n / 2);
    difference(time, x, h)
}

fn difference(time: &[f64], x: &[f64], h: usize) -> Vec<f64> {
    let at = |k: usize| {
        let (a, b) = (k.saturating_sub(h), (k + h).min(time.len() - 1));
        (x[b] - x[a]) / (time[b] - time[a])
    };
    (0..time.len()).map(at).collect()
}

/// Samples further than [`SETTLE_S`] from any motion; none where nothing is known of motion.
pub fn rest(velocity: &JointSeries, time: &[f64]) -> Vec<bool> {
    let moves = |k: usize| (0..velocity.joints()).any(|j| velocity.joint(j)[k].abs() > REST_RAD_S);
    let mut rest = vec![velocity.joints() > 0; time.len()];
    let mut last_motion = f64::NEG_INFINITY;
    for k in 0..time.len() {
        if moves(k) {
            last_motion = time[k];
        }
        rest[k] &= time[k] - last_motion > SETTLE_S;
    }
    let mut next_motion = f64::INFINITY;
    for k in (0..time.len()).rev() {
        if moves(k) {
            next_motion = time[k];
        }
        rest[k] &= next_motion - time[k] > SETTLE_S;
    }
    rest
}

pub fn moving_s(velocity: &JointSeries, time: &[f64]) -> f64 {
    let slides =
        |k: usize| (0..velocity.joints()).any(|j| velocity.joint(j)[k].abs() > SLIDING_RAD_S);
    (1..time.len()).filter(|k| slides(*k)).fold(0.0, |sum, k| sum + time[k] - time[k - 1])
}

pub fn all(recording: &Recording, velocity: &JointSeries) -> Vec<JointMotion> {
    let Some(position) = recording.joints("actual_q") else { return Vec::new() };
    let recorded = recording.joint_count("actual_qd") > 0;
    let joints = position.joints().min(velocity.joints());
    let of = |j| joint(j, &recording.time, position.joint(j), velocity.joint(j), recorded);
    (0..joints).map(of).collect()
}

fn joint(j: usize, time: &[f64], q: &[f64], qd: &[f64], recorded: bool) -> JointMotion {
    let (low_rad, high_rad) = extent(q);
    let (speed_low, speed_high) = extent(qd);
    let (low, high) = extent(&slope(time, qd));
    let sliding = qd.iter().filter(|v| v.abs() > SLIDING_RAD_S).count();
    let travels = high_rad - low_rad > TRAVEL_RAD;
    let agreement = if recorded && travels { agreement(&difference(time, q, 1), qd) } else { None };
    JointMotion {
        joint: j + 1,
        low_rad,
        high_rad,
        speed_low,
        speed_high,
        acceleration: high.max(-low),
        moving_share: sliding as f64 / qd.len() as f64,
        reversals: reversals(&slope(time, q)),
        velocity_correlation: agreement.map(|(r, _)| r),
        velocity_slope: agreement.map(|(_, slope)| slope),
    }
}

fn extent(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    (low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

fn reversals(qd: &[f64]) -> usize {
    let signs: Vec<bool> =
        qd.iter().filter(|v| v.abs() > SLIDING_RAD_S).map(|v| *v > 0.0).collect();
    signs.windows(2).filter(|w| w[0] != w[1]).count()
}

/// Correlation and slope of `y` over `x` where `y` slides.
fn agreement(x: &[f64], y: &[f64]) -> Option<(f64, f64)> {
    let pairs: Vec<(f64, f64)> =
        x.iter().copied().zip(y.iter().copied()).filter(|(_, y)| y.abs() > SLIDING_RAD_S).collect();
    if pairs.len() < FEWEST_SLIDING {
        return None;
    }
    let n = pairs.len() as f64;
    let (mx, my) = pairs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        xx += (x - mx) * (x - mx);
        yy += (y - my) * (y - my);
        xy += (x - mx) * (y - my);
    }
    (xx > 0.0 && yy > 0.0).then(|| (xy / (xx * yy).sqrt(), xy / xx))
}
