//! How far a simulated twin stays from a recording.

use super::{Replayed, ResimulationError, open_loop};
use crate::signals::{Conditioning, LowPass, Samples};
use crate::twin::Twin;

/// Root mean squares over all joints, simulated less recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Closed loop, rad.
    pub position_rad: f64,
    /// Closed loop, of the drive, low-passed, where the joint slides, N.m.
    pub torque_nm: f64,
    /// Open loop at the end of a window, rad.
    pub open_loop_rad: f64,
}

/// Errors of what the twin did when led along the command, and of the twin driven by the recorded torque.
///
/// # Errors
/// If the twin cannot be simulated.
pub fn errors(
    twin: &Twin,
    replayed: &Replayed,
    samples: &Samples,
) -> Result<Errors, ResimulationError> {
    let filter = torque_filter(samples)?;
    let low_passed = |x: &[f64]| {
        let mut x = x.to_vec();
        filter.apply(&mut x);
        x
    };
    let [mut position, mut torque] = [Squares::default(); 2];
    for j in 0..samples.joints() {
        position.add(samples.q.joint(j), replayed.shown_q.joint(j), &samples.usable);
        let [recorded, simulated] =
            [&samples.torque, &replayed.torque].map(|s| low_passed(s.joint(j)));
        torque.add(&recorded, &simulated, &samples.mask(j));
    }
    Ok(Errors {
        position_rad: position.root_mean(),
        torque_nm: torque.root_mean(),
        open_loop_rad: open_loop(twin, samples)?,
    })
}

/// The conditioning's; where that has none, as slow as it usually is: else the recorded noise would
/// hide what the motion needs.
fn torque_filter(samples: &Samples) -> Result<LowPass, ResimulationError> {
    if let Some(filter) = samples.torque_filter()? {
        return Ok(filter);
    }
    let Conditioning { torque_cutoff_hz, filter_order, .. } = Conditioning::default();
    let cutoff = torque_cutoff_hz.min(0.4 * samples.rate_hz());
    Ok(LowPass::new(cutoff, samples.rate_hz(), filter_order)?)
}

#[derive(Clone, Copy, Default)]
struct Squares {
    sum: f64,
    count: usize,
}

impl Squares {
    fn add(&mut self, a: &[f64], b: &[f64], used: &[bool]) {
        for ((a, b), _) in a.iter().zip(b).zip(used).filter(|(_, used)| **used) {
            self.sum += (a - b).powi(2);
            self.count += 1;
        }
    }

    fn root_mean(&self) -> f64 {
        (self.sum / self.count.max(1) as f64).sqrt()
    }
}
