//! A ROS 2 message `trajectory_msgs/msg/JointTrajectory` as YAML.

use super::list;
use crate::excitation::Design;

/// Between points, s: a controller joins them by polynomials of fifth degree, since positions,
/// velocities and accelerations are given.
pub const DT: f64 = 0.04;
const NANOSECONDS: f64 = 1e9;

pub fn text(design: &Design) -> String {
    let s = design.trajectory.sampled(DT);
    let names = design.twin.robot.bodies.iter().map(|b| format!("\"{}\"", b.joint.name));
    let names: Vec<String> = names.collect();
    let mut text = format!(
        "# Designed by armtwin excite, seed {}: {} s. Move to the first point before.\n\
         joint_names: [{}]\npoints:\n",
        design.report.seed,
        design.report.seconds,
        names.join(", ")
    );
    let mut now = vec![0.0; s.q.joints()];
    for k in 0..s.q.samples() {
        let mut sample = |series: &crate::series::JointSeries| {
            series.sample_into(k, &mut now);
            list(&now)
        };
        let (q, qd, qdd) = (sample(&s.q), sample(&s.qd), sample(&s.qdd));
        let nanoseconds = (k as f64 * DT * NANOSECONDS).round() as u64;
        let (sec, nanosec) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
        text += &format!(
            "- positions: {q}\n  velocities: {qd}\n  accelerations: {qdd}\n  \
             time_from_start: {{sec: {sec}, nanosec: {nanosec}}}\n"
        );
    }
    text
}
