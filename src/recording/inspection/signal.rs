//! Range, noise and step of every signal.

use super::quantile;
use crate::recording::Recording;
use crate::recording::check::split_index;

/// Fewer samples at rest say nothing about noise.
const FEWEST_AT_REST: usize = 30;
/// sqrt(1 + 4 + 1): noise gain of a second difference.
const SECOND_DIFFERENCE_GAIN: f64 = 2.449_489_742_783_178;
/// Median of |x| over its standard deviation, Gaussian, inverted.
const MAD_TO_SIGMA: f64 = 1.4826;
/// A gap between values counts as a multiple of the step within this share of it.
const STEP_TOLERANCE: f64 = 0.1;

/// A signal of all joints, or a single column.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Signal {
    /// Without the joint's index.
    pub name: String,
    /// "" where unknown.
    pub unit: &'static str,
    pub columns: Vec<JointSignal>,
}

#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct JointSignal {
    pub low: f64,
    pub high: f64,
    pub rms: f64,
    /// Standard deviation of the white noise, from second differences.
    pub noise: f64,
    /// Whether `noise` was taken at rest; from samples in motion it is an upper bound.
    pub noise_at_rest: bool,
    /// Smallest step between values, where all values lie on one ladder.
    pub step: Option<f64>,
}

impl Signal {
    pub fn low(&self) -> f64 {
        self.columns.iter().map(|c| c.low).fold(f64::INFINITY, f64::min)
    }

    pub fn high(&self) -> f64 {
        self.columns.iter().map(|c| c.high).fold(f64::NEG_INFINITY, f64::max)
    }

    pub fn largest(&self) -> f64 {
        self.low().abs().max(self.high().abs())
    }
}

pub fn all(recording: &Recording, rest: &[bool]) -> Vec<Signal> {
    let columns = |stem: &str| {
        let belongs = |name: &str| split_index(name).map_or(name, |(s, _)| s) == stem;
        let channels = recording.channels.iter().filter(|c| belongs(&c.name));
        channels.map(|c| JointSignal::of(&c.values, rest)).collect()
    };
    let stems = recording.stems().into_iter();
    stems.map(|s| Signal { unit: unit(&s), columns: columns(&s), name: s }).collect()
}

impl JointSignal {
    fn of(values: &[f64], rest: &[bool]) -> Self {
        let (noise, noise_at_rest) = noise(values, rest);
        let square: f64 = values.iter().map(|v| v * v).sum();
        Self {
            low: values.iter().copied().fold(f64::INFINITY, f64::min),
            high: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            rms: (square / values.len() as f64).sqrt(),
            noise,
            noise_at_rest,
            step: step(values),
        }
    }
}

/// sigma^2 = E[(x_{k-1} - 2 x_k + x_{k+1})^2] / 6 for white noise on a slow signal (von Neumann);
/// at rest where there is enough of it, else by the median over all samples.
fn noise(values: &[f64], rest: &[bool]) -> (f64, bool) {
    let second = |w: &[f64]| (w[0] - 2.0 * w[1] + w[2]) / SECOND_DIFFERENCE_GAIN;
    let differences: Vec<f64> = values.windows(3).map(second).collect();
    let inner = &rest[1..rest.len() - 1];
    let at_rest: Vec<f64> =
        differences.iter().zip(inner).filter(|(_, r)| **r).map(|(d, _)| d * d).collect();
    if at_rest.len() >= FEWEST_AT_REST {
        return ((at_rest.iter().sum::<f64>() / at_rest.len() as f64).sqrt(), true);
    }
    let sizes: Vec<f64> = differences.iter().map(|d| d.abs()).collect();
    (MAD_TO_SIGMA * quantile(&sizes, 0.5), false)
}

/// The step of an analogue-to-digital converter or encoder if the values show one, else that of
/// rounding to decimals.
fn step(values: &[f64]) -> Option<f64> {
    let mut distinct = values.to_vec();
    distinct.sort_unstable_by(f64::total_cmp);
    distinct.dedup();
    if distinct.len() < 2 {
        return None;
    }
    let decimal = decimal_step(&distinct);
    converter_step(&distinct, decimal.unwrap_or(0.0)).or(decimal)
}

fn decimal_step(values: &[f64]) -> Option<f64> {
    let fits = |scale: f64| {
        values.iter().all(|v| {
            let scaled = v * scale;
            (scaled - scaled.round()).abs() <= 1e-9 * scaled.abs() && scaled.abs() < 1e9
        })
    };
    (0..=8).map(|k| 10f64.powi(k)).find(|scale| fits(*scale)).map(f64::recip)
}

/// Every gap between neighbouring values is a multiple of the step; `decimal` is the rounding of
/// the values, which blurs them.
fn converter_step(distinct: &[f64], decimal: f64) -> Option<f64> {
    let gaps: Vec<f64> = distinct.windows(2).map(|w| w[1] - w[0]).collect();
    let first = quantile(&gaps, 0.05);
    let near: Vec<f64> = gaps.iter().copied().filter(|g| *g < 1.5 * first).collect();
    let guess = near.iter().sum::<f64>() / near.len() as f64;
    let short: Vec<f64> = gaps.iter().copied().filter(|g| *g < 20.5 * guess).collect();
    if guess < 5.0 * decimal || short.len() < 16 {
        return None;
    }
    let multiples: f64 = short.iter().map(|g| (g / guess).round()).sum();
    let step = short.iter().sum::<f64>() / multiples;
    let off = |g: &&f64| ((**g / step) - (**g / step).round()).abs() > STEP_TOLERANCE;
    let misfits = short.iter().filter(off).count();
    (misfits * 50 < short.len()).then_some(step)
}

/// By RTDE name.
pub fn unit(stem: &str) -> &'static str {
    match stem {
        "actual_q" | "target_q" => "rad",
        "actual_qd" | "target_qd" => "rad/s",
        "actual_qdd" | "target_qdd" => "rad/s2",
        "joint_torque" | "target_moment" | "actual_moment" => "N.m",
        "joint_control_output" | "actual_robot_current" => "A",
        "actual_TCP_force" => "N, N.m",
        "actual_TCP_pose" | "target_TCP_pose" => "m, rad",
        "actual_TCP_speed" | "target_TCP_speed" => "m/s, rad/s",
        "actual_tool_accelerometer" => "m/s2",
        "payload" => "kg",
        _ if stem.contains("current") => "A",
        _ if stem.contains("voltage") => "V",
        _ if stem.contains("temperature") => "deg C",
        _ => "",
    }
}
