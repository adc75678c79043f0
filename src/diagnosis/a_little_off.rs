//! What of a gap goes with links and torque that are a little off, where that is most of it: the first thing to tell.

use super::answer::{Diagnosis, Unexplained};

/// Share of a gap that is most of it.
const MOST: f64 = 0.5;

/// Links and scales of torque, as far as the mended twin has others.
pub struct LittleOff {
    /// What they take of the gap above the noise, on the check recording.
    pub share: f64,
    /// The joint (from 1) whose torque is recorded most too large or too small, and by how much of it.
    pub most: Option<(usize, f64)>,
}

/// `None` where they take less than half of it, or a search explains more.
pub fn a_little_off(d: &Diagnosis) -> Option<LittleOff> {
    let Unexplained { rms_nm, beyond_tolerances_nm, .. } = d.unexplained;
    let taken = rms_nm.powi(2) - beyond_tolerances_nm?.powi(2);
    let joints = d.gap.joints.iter();
    let above = joints.map(|j| j.rms_nm.powi(2) - j.noise_floor_nm.powi(2)).sum::<f64>();
    let share = taken * d.gap.joints.len() as f64 / above;
    let explained = d.shrink.torque.above_noise().map_or(0.0, |[share, ..]| share);
    (above > 0.0 && share > explained.max(MOST))
        .then(|| LittleOff { share: share.min(1.0), most: most(d) })
}

/// Of those whose interval excludes that the torque is right.
fn most(d: &Diagnosis) -> Option<(usize, f64)> {
    let scales = d.adjustments.iter().filter(|a| a.effect == "torque_constant");
    let surely = scales.flat_map(|a| &a.parameters).filter(|v| v.low > 0.0 || v.high < 0.0);
    let most = surely.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))?;
    Some((most.joint?, most.value))
}
