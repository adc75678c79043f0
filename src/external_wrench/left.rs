//! What a twin leaves of the recorded torque over all samples, standing ones too.

use crate::effects::Motion;
use crate::series::JointSeries;
use crate::signals::{Samples, SignalError, erode};
use crate::twin::Twin;

/// What a recording shows beside what the twin predicts, on the recording's grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// Recorded torque less the twin's, N.m, low-passed as a regression uses it. While a joint
    /// stands its friction is not taken off: it is anything between plus and minus `holds`.
    pub torque: JointSeries,
    /// Torque that friction can hold at rest in this pose, N.m.
    pub holds: JointSeries,
    /// State of the friction of every joint at every sample.
    pub friction: Vec<Vec<Friction>>,
}

/// What the friction of a joint is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Friction {
    Slides,
    /// Holds whatever is asked of it, up to a limit, while other joints move.
    Holds,
    /// Holds while the whole arm is at rest.
    Rests,
    /// Just now it held, or soon it will: within `CHANGE_S` of the speed's crossing the threshold of
    /// standstill. Where a filter smears one over the other, and where friction differs most from what
    /// any law says.
    Changes,
}

impl Friction {
    /// Does the joint stand?
    pub fn holds(self) -> bool {
        matches!(self, Self::Holds | Self::Rests)
    }

    /// Is it the same friction still, one sample on?
    pub fn goes_on_as(self, next: Self) -> bool {
        self == next || self.holds() && next.holds()
    }
}

/// s
const CHANGE_S: f64 = 0.2;

/// `twin` has values for all its effects: what is open is not in its torque.
///
/// # Errors
/// If the torque cannot be low-passed as the conditioning says.
pub fn left(twin: &Twin, samples: &Samples) -> Result<Left, SignalError> {
    let joints = 0..samples.joints();
    let mut friction: Vec<Vec<Friction>> = joints.clone().map(|j| friction(samples, j)).collect();
    for k in 0..samples.len() {
        if friction.iter().all(|joint| joint[k] == Friction::Holds) {
            friction.iter_mut().for_each(|joint| joint[k] = Friction::Rests);
        }
    }
    let at_rest = samples.conditioning.standstill_rad_s;
    // Friction at rest has no sign of its own: that of velocity noise is not taken for it.
    let slides = |qd: &f64| if qd.abs() > at_rest { *qd } else { 0.0 };
    let qd = samples.qd.map_joints(|_, qd| qd.iter().map(slides).collect());
    let predicted = twin.torque(&Motion { qd: &qd, ..twin.motion(samples) });
    let mut torque: Vec<Vec<f64>> =
        joints.map(|j| less(samples.torque.joint(j), predicted.joint(j))).collect();
    if let Some(filter) = samples.torque_filter()? {
        filter.apply_many(&mut torque);
    }
    let holds = holds(twin, samples);
    Ok(Left { torque: JointSeries::from_joints(&torque), holds, friction })
}

/// Slow sliding both ways at once less none: half of what friction changes by at a reversal.
fn holds(twin: &Twin, samples: &Samples) -> JointSeries {
    let still = samples.q.map_joints(|_, q| vec![0.0; q.len()]);
    let creeping = |speed: f64| {
        let qd = samples.q.map_joints(|_, q| vec![speed; q.len()]);
        twin.torque(&Motion { qd: &qd, qdd: &still, ..twin.motion(samples) })
    };
    let speed = samples.conditioning.standstill_rad_s.max(f64::MIN_POSITIVE);
    let [up, down] = [creeping(speed), creeping(-speed)];
    let half = |j: usize, up: &[f64]| {
        up.iter().zip(down.joint(j)).map(|(up, down)| 0.5 * (up - down).abs()).collect()
    };
    up.map_joints(half)
}

fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn friction(samples: &Samples, joint: usize) -> Vec<Friction> {
    let qd = samples.qd.joint(joint);
    let fast: Vec<bool> =
        qd.iter().map(|v| v.abs() > samples.conditioning.standstill_rad_s).collect();
    let slow: Vec<bool> = fast.iter().map(|f| !f).collect();
    let reach = (CHANGE_S / samples.dt) as usize;
    let [slides, holds] = [fast, slow].map(|mask| erode(&mask, reach));
    let one = |(slides, holds): (&bool, &bool)| match (slides, holds) {
        (true, _) => Friction::Slides,
        (_, true) => Friction::Holds,
        _ => Friction::Changes,
    };
    slides.iter().zip(&holds).map(one).collect()
}
