//! Inverse dynamics, mass matrices and regressors along a whole motion.

use rayon::prelude::*;

use super::{Workspace, inverse_dynamics, mass_matrix, regressor};
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

/// [`mass_matrix`] at every sample, chunks in parallel: `dof` x `dof` values per sample, kg.m2.
pub fn mass_matrix_series(robot: &Robot, q: &JointSeries) -> Vec<f64> {
    let each = |ws: &mut Workspace, [q, _, _]: [&[f64]; 3], out: &mut [f64]| {
        // Symmetric: columns are rows.
        out.copy_from_slice(mass_matrix(robot, ws, q).as_slice());
    };
    at_samples(robot, [q, q, q], robot.dof() * robot.dof(), each)
}

/// [`regressor`] at every sample, chunks in parallel: `dof` rows of 10 `dof` values per sample.
pub fn regressor_series(
    robot: &Robot,
    q: &JointSeries,
    qd: &JointSeries,
    qdd: &JointSeries,
) -> Vec<f64> {
    let columns = 10 * robot.dof();
    let each = |ws: &mut Workspace, [q, qd, qdd]: [&[f64]; 3], out: &mut [f64]| {
        let y = regressor(robot, ws, q, qd, qdd);
        for (row, out) in y.row_iter().zip(out.chunks_exact_mut(columns)) {
            row.iter().zip(out).for_each(|(value, out)| *out = *value);
        }
    };
    at_samples(robot, [q, qd, qdd], robot.dof() * columns, each)
}

/// `width` values per sample, as `each` writes them.
fn at_samples(
    robot: &Robot,
    motion: [&JointSeries; 3],
    width: usize,
    each: impl Fn(&mut Workspace, [&[f64]; 3], &mut [f64]) + Sync,
) -> Vec<f64> {
    let mut all = vec![0.0; width * motion[0].samples()];
    if all.is_empty() {
        return all;
    }
    all.par_chunks_mut(width * CHUNK).enumerate().for_each(|(chunk, out)| {
        let mut ws = Workspace::new(robot);
        let mut state = [(); 3].map(|()| vec![0.0; robot.dof()]);
        for (k, out) in out.chunks_exact_mut(width).enumerate() {
            for (values, series) in state.iter_mut().zip(motion) {
                series.sample_into(chunk * CHUNK + k, values);
            }
            each(&mut ws, [&state[0], &state[1], &state[2]], out);
        }
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::builtin;

    #[test]
    fn matrices_along_a_motion_give_its_torque() {
        let robot = builtin("ur5").unwrap();
        let joint = |j: usize, rate: f64| -> Vec<f64> {
            (0..1100).map(|k| (rate * k as f64 + j as f64).sin()).collect()
        };
        let series =
            |rate| JointSeries::from_joints(&(0..6).map(|j| joint(j, rate)).collect::<Vec<_>>());
        let [q, qd, qdd] = [0.01, 0.02, 0.05].map(series);
        let tau = inverse_dynamics_series(&robot, &q, &qd, &qdd);
        let y = regressor_series(&robot, &q, &qd, &qdd);
        let parameters: Vec<f64> =
            robot.bodies.iter().flat_map(|b| b.inertia.parameters()).collect();
        let mass = mass_matrix_series(&robot, &q);
        for k in [0, 511, 512, 1099] {
            for j in 0..6 {
                let row = &y[(6 * k + j) * 60..][..60];
                let by_row: f64 = row.iter().zip(&parameters).map(|(y, p)| y * p).sum();
                assert!((by_row - tau.joint(j)[k]).abs() < 1e-9, "{k} {j}");
                assert_eq!(mass[36 * k + 6 * j], mass[36 * k + j]);
            }
        }
    }
}
