//! How long the steps may be in which an arm of servos is simulated along a recording.

use crate::robot::{Told, mass_matrix_series};
use crate::twin::Twin;

/// The longest step, in time constants sqrt(I/K) of a servo: a spring swings faster by (h w)^2 / 24 in leapfrog steps (Hairer, Lubich
/// and Wanner, *Geometric Numerical Integration*, 2006, section VIII.1), here by 1 in 2400. Steps half as long move the load
/// and the gain that are fitted to a real SO-101 by a fiftieth, which is a tenth of their standard errors.
const TIME_CONSTANTS: f64 = 0.1;
/// No step is shorter, s: stiff servos of a large arm go within .2 mrad of where rapier goes with it.
const SHORTEST_S: f64 = 0.002;

/// Steps between two samples of a recording, for the stiffest servo in its lightest posture.
pub fn steps(twin: &Twin, told: &Told) -> usize {
    let mechanism = twin.mechanism(|_| true);
    let (dof, masses) = (told.q.joints(), mass_matrix_series(&mechanism.robot, &told.q));
    let shortest = |j: usize| {
        let links = masses.iter().skip(j * dof + j).step_by(dof * dof);
        let inertia = mechanism.armature[j] + links.copied().fold(f64::INFINITY, f64::min);
        let gain = told.gain.joint(j).iter().copied().fold(0.0, f64::max);
        (inertia / gain).sqrt()
    };
    let longest = (0..dof).map(shortest).fold(f64::INFINITY, f64::min) * TIME_CONSTANTS;
    (told.dt / longest.max(SHORTEST_S)).ceil().max(1.0) as usize
}
