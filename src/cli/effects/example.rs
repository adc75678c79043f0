//! What a recording of one joint reads before and after an effect, along a short motion: worked out, never typed.

use super::typical::typical;
use crate::effects::{Channels, Effect, Motion};
use crate::robot::inverse_dynamics_series;
use crate::series::JointSeries;
use crate::twin::Twin;

const DT: f64 = 0.005;
/// The arm moves for so long before the example begins, s: what has memory has filled it.
const BEFORE_S: f64 = 1.0;
/// The example is shown every so often, s, so many times.
const EVERY_S: f64 = 0.25;
const SHOWN: usize = 8;
/// Every joint turns around once; swing, rad, and frequency, rad/s.
const SWING_RAD: f64 = 0.3;
const RATE_RAD_S: f64 = std::f64::consts::FRAC_PI_2;
/// Warm enough for what goes with temperature.
const WARM_C: f64 = 45.0;
/// The shoulder, from 0: it carries the most, and everything that acts shows there.
const JOINT: usize = 1;
/// A smaller share of a channel is no change.
const LEAST: f64 = 1e-6;

/// The channel of a UR5's shoulder (joint 2) on which the effect shows most.
pub struct Example {
    /// With its unit.
    pub channel: &'static str,
    /// s
    pub times: Vec<f64>,
    /// rad/s
    pub speed: Vec<f64>,
    pub before: Vec<f64>,
    pub after: Vec<f64>,
}

impl Example {
    /// Time, speed, and the channel before and after, for a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let row = |label: String, values: &[f64], places: usize| {
            let cells = values.iter().map(|x| rounded(*x, places));
            std::iter::once(label).chain(cells).collect::<Vec<_>>()
        };
        vec![
            row("time, s".into(), &self.times, 2),
            row("moves at, rad/s".into(), &self.speed, 2),
            row(format!("before: {}", self.channel), &self.before, 3),
            row(format!("after: {}", self.channel), &self.after, 3),
        ]
    }
}

/// Never minus nothing.
pub fn rounded(x: f64, places: usize) -> String {
    let text = format!("{x:.places$}");
    let nothing = text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.'));
    if nothing { text.trim_start_matches('-').into() } else { text }
}

/// A UR5 whose joints turn around, without the effect and with it at typical values; `None` where recorded
/// motion and torque stay the same.
pub fn example(effect: &dyn Effect) -> Option<Example> {
    let twin = typical(effect.about());
    let moved = Turn::new(twin.robot.dof());
    let before = inverse_dynamics_series(&twin.robot, &moved.q, &moved.qd, &moved.qdd);
    let after = twin.torque(&moved.motion(&twin));
    let limits = twin.mechanism(|_| true).torque_limit;
    let clear = moved.channels(JOINT, before.joint(JOINT).to_vec());
    let clipped = after.joint(JOINT).iter().map(|t| t.clamp(-limits[JOINT], limits[JOINT]));
    let mut seen = moved.channels(JOINT, clipped.collect());
    if let Some(values) = twin.values_at(effect, JOINT) {
        effect.measure(&values, &mut seen);
    }
    let channels = [
        ("torque, N.m", clear.torque, seen.torque),
        ("speed, rad/s", clear.qd, seen.qd),
        ("angle, rad", clear.q, seen.q),
    ];
    let most =
        channels.into_iter().max_by(|a, b| change(&a.1, &a.2).total_cmp(&change(&b.1, &b.2)));
    let (channel, before, after) = most.filter(|s| change(&s.1, &s.2) > LEAST)?;
    let at = |x: &[f64]| moved.rows().map(|k| x[k]).collect();
    Some(Example {
        channel,
        times: moved.rows().map(|k| k as f64 * DT - BEFORE_S).collect(),
        speed: at(moved.qd.joint(JOINT)),
        before: at(&before),
        after: at(&after),
    })
}

/// RMS of what changes over that of what was there.
fn change(before: &[f64], after: &[f64]) -> f64 {
    let squares = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>();
    let apart = squares(&mut before.iter().zip(after).map(|(b, a)| a - b));
    (apart / squares(&mut before.iter().copied()).max(1e-12)).sqrt()
}

/// All joints turn around, one shortly after the other.
struct Turn {
    q: JointSeries,
    qd: JointSeries,
    qdd: JointSeries,
    temperature: JointSeries,
}

impl Turn {
    fn new(joints: usize) -> Self {
        let pose = [0.0, -1.4, 1.0, -0.8, -1.5, 0.0];
        let samples = ((BEFORE_S + EVERY_S * SHOWN as f64) / DT) as usize;
        let series = |f: &dyn Fn(usize, f64) -> f64| {
            let phase = |j: usize, k: usize| {
                let turns = BEFORE_S + 1.1 + 0.05 * j as f64;
                RATE_RAD_S * (k as f64 * DT - turns)
            };
            let row = |j: usize| (0..samples).map(|k| f(j, phase(j, k))).collect();
            JointSeries::from_joints(&(0..joints).map(row).collect::<Vec<Vec<f64>>>())
        };
        let (swing, rate) = (SWING_RAD, RATE_RAD_S);
        Self {
            q: series(&|j, x| pose[j % pose.len()] + swing * x.cos()),
            qd: series(&|_, x| -swing * rate * x.sin()),
            qdd: series(&|_, x| -swing * rate * rate * x.cos()),
            temperature: series(&|_, _| WARM_C),
        }
    }

    fn motion<'a>(&'a self, twin: &'a Twin) -> Motion<'a> {
        let motion = Motion::new(&twin.robot, DT, &self.q, &self.qd, &self.qdd);
        Motion { temperature: Some(&self.temperature), ..motion }
    }

    fn channels(&self, joint: usize, torque: Vec<f64>) -> Channels {
        let of = |series: &JointSeries| series.joint(joint).to_vec();
        let (q, qd, qdd) = (of(&self.q), of(&self.qd), of(&self.qdd));
        Channels { dt: DT, q, qd, qdd, torque, velocity_is_recorded: true }
    }

    /// The samples that are shown.
    fn rows(&self) -> impl Iterator<Item = usize> {
        let at = |i: usize| ((BEFORE_S + EVERY_S * i as f64) / DT).round() as usize;
        (0..SHOWN).map(at)
    }
}
