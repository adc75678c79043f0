//! A program for the controller of a UR arm: `movej` to the first pose, then `servoj`.
//!
//! The motion stands in it as one line per knot with angles and speeds; between knots the program
//! follows the cubic with these values and slopes (Hermite), one `servoj` per controller step.

use super::list;
use crate::excitation::Design;

/// Between knots, s.
pub const KNOT_S: f64 = 0.04;

pub fn text(design: &Design) -> String {
    let s = design.trajectory.sampled(KNOT_S);
    let sample = |series: &crate::series::JointSeries, k: usize| {
        let mut now = vec![0.0; series.joints()];
        series.sample_into(k, &mut now);
        list(&now)
    };
    let (start, still) = (sample(&s.q, 0), sample(&s.qd, 0));
    let mut text = format!(
        "# Designed by armtwin excite, seed {seed}: {seconds} s.\n\
         # Nobody checked the way to the start (movej): bring the arm near it first, and run the program\n\
         # slowly (speed slider).\n\
         def excite():\n\
         \x20 global q0 = {start}\n\
         \x20 global v0 = {still}\n\
         \x20 # Along the cubic from (q0, v0) to (q1, v1) within {KNOT_S} s.\n\
         \x20 def to(q1, v1):\n\
         \x20   local dt = get_steptime()\n\
         \x20   local h = {KNOT_S}\n\
         \x20   local t = dt\n\
         \x20   while t < h + 0.5 * dt:\n\
         \x20     local u = t / h\n\
         \x20     local a = (1 + 2 * u) * (1 - u) * (1 - u)\n\
         \x20     local b = h * u * (1 - u) * (1 - u)\n\
         \x20     local c = u * u * (3 - 2 * u)\n\
         \x20     local d = h * u * u * (u - 1)\n\
         \x20     local q = q0\n\
         \x20     local i = 0\n\
         \x20     while i < 6:\n\
         \x20       q[i] = a * q0[i] + b * v0[i] + c * q1[i] + d * v1[i]\n\
         \x20       i = i + 1\n\
         \x20     end\n\
         \x20     servoj(q, t=dt, lookahead_time=0.03, gain=500)\n\
         \x20     t = t + dt\n\
         \x20   end\n\
         \x20   q0 = q1\n\
         \x20   v0 = v1\n\
         \x20 end\n\
         \x20 movej({start}, a=0.5, v=0.3)\n",
        seed = design.report.seed,
        seconds = design.report.seconds,
    );
    for k in 1..s.q.samples() {
        text += &format!("  to({}, {})\n", sample(&s.q, k), sample(&s.qd, k));
    }
    text + "  stopj(2.0)\nend\n"
}
