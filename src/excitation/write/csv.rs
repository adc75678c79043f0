//! CSV with RTDE's names for a commanded motion, at the rate of a controller.

use std::fmt::Write;

use crate::excitation::Design;
use crate::excitation::limits::torque_along;
use crate::series::JointSeries;

/// s
const DT: f64 = 0.008;

/// Time, then angle (rad), speed, acceleration and the twin's torque (N.m) of every joint.
pub fn text(design: &Design) -> String {
    let s = design.trajectory.sampled(DT);
    let moment = torque_along(&design.twin, &s, DT);
    let stems: [(&str, &JointSeries); 4] =
        [("q", &s.q), ("qd", &s.qd), ("qdd", &s.qdd), ("moment", &moment)];
    let joints = design.trajectory.dof();
    let mut text = "timestamp".to_string();
    for (stem, _) in &stems {
        (0..joints).for_each(|j| text += &format!(",target_{stem}_{j}"));
    }
    for k in 0..s.q.samples() {
        let _ = write!(text, "\n{}", (k as f64 * DT * 1e6).round() / 1e6);
        for (_, series) in &stems {
            for j in 0..joints {
                let _ = write!(text, ",{}", series.joint(j)[k]);
            }
        }
    }
    text + "\n"
}
