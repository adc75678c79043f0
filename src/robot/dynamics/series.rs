//! Inverse dynamics along a whole motion.

use rayon::prelude::*;

use super::{Workspace, inverse_dynamics};
use crate::robot::Robot;
use crate::series::JointSeries;

const CHUNK: usize = 512;

/// [`inverse_dynamics`] at every sample, chunks in parallel; N.m.
pub fn inverse_dynamics_series(
    robot: &Robot,
    q: &JointSeries,
    qd: &JointSeries,
    qdd: &JointSeries,
) -> JointSeries {
    let samples = q.samples();
    let starts: Vec<usize> = (0..samples).step_by(CHUNK).collect();
    let chunks: Vec<Vec<f64>> = starts
        .par_iter()
        .map(|&start| chunk(robot, [q, qd, qdd], start..samples.min(start + CHUNK)))
        .collect();
    let mut tau = JointSeries::zeros(robot.dof(), samples);
    for (k, values) in chunks.iter().flat_map(|c| c.chunks_exact(robot.dof())).enumerate() {
        tau.set_sample(k, values);
    }
    tau
}

/// Torques of the samples in `range`, one sample after the other.
fn chunk(robot: &Robot, motion: [&JointSeries; 3], range: std::ops::Range<usize>) -> Vec<f64> {
    let n = robot.dof();
    let mut ws = Workspace::new(robot);
    let mut state = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    let mut tau = vec![0.0; n * range.len()];
    for (k, out) in range.zip(tau.chunks_exact_mut(n)) {
        for (values, series) in state.iter_mut().zip(motion) {
            series.sample_into(k, values);
        }
        inverse_dynamics(robot, &mut ws, &state[0], &state[1], &state[2], out);
    }
    tau
}
