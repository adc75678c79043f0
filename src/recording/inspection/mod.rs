//! What a recording holds, how good it is, and what is wrong with it.

mod findings;
mod motion;
#[cfg(test)]
mod real;
mod sampling;
mod signal;
#[cfg(test)]
mod tests;

pub use findings::plausible_step;
pub use motion::{JointMotion, SLIDING_RAD_S};
pub use sampling::{Gap, Sampling, step};
pub use signal::{JointSignal, Signal};

use super::{JOINT_SIGNALS, Recording};

#[derive(Debug, Clone, serde::Serialize)]
pub struct Inspection {
    pub schema: &'static str,
    pub version: &'static str,
    pub source: String,
    pub format: String,
    pub samples: usize,
    pub joints: usize,
    pub sampling: Sampling,
    /// Share of the samples in which no joint moves, neither shortly before nor after.
    pub rest_share: f64,
    /// Time with at least one joint above [`SLIDING_RAD_S`], s.
    pub moving_s: f64,
    pub signals: Vec<Signal>,
    pub motion: Vec<JointMotion>,
    /// What reading dropped or mended.
    pub notes: Vec<String>,
    /// What is wrong with it, in plain words.
    pub findings: Vec<String>,
}

pub fn inspect(recording: &Recording) -> Inspection {
    let joints = JOINT_SIGNALS.iter().map(|s| recording.joint_count(s)).max().unwrap_or(0);
    let sampling = Sampling::of(&recording.time);
    let velocity = motion::velocity(recording, joints);
    let rest = motion::rest(&velocity, &recording.time);
    let mut inspection = Inspection {
        schema: "armtwin.inspection/1",
        version: env!("CARGO_PKG_VERSION"),
        source: recording.provenance.source.clone(),
        format: recording.provenance.format.clone(),
        samples: recording.time.len(),
        joints,
        rest_share: share(&rest),
        moving_s: motion::moving_s(&velocity, &recording.time),
        signals: signal::all(recording, &rest),
        motion: motion::all(recording, &velocity),
        notes: recording.provenance.notes.clone(),
        sampling,
        findings: Vec::new(),
    };
    inspection.findings = findings::find(&inspection, recording);
    inspection
}

fn share(mask: &[bool]) -> f64 {
    mask.iter().filter(|m| **m).count() as f64 / mask.len().max(1) as f64
}

/// The value below which a share `p` of the values lies (nearest rank); `values` must not be empty.
fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * p).round() as usize]
}
