//! The force at the flange that would explain what the twin leaves, while the arm works.
//!
//! A force F on the flange adds -J^T F to the torque of the drives. Least squares over the joints that
//! slide in a stretch, each weighted by its own level; a quick look beside the gap, where `armtwin
//! contacts` weighs the whole course of it.

use nalgebra::{Matrix3, Vector3};

use super::Stretch;
use crate::robot::{Robot, point_jacobian};

/// Instants of a stretch that are looked at.
const INSTANTS: usize = 10;

#[derive(Debug, Clone)]
pub struct Flange {
    robot: Robot,
    /// Mean square of what the twin left of each joint, N2.m2, and how many samples that is of.
    squares: Vec<(f64, f64)>,
    force: Option<Vector3<f64>>,
    /// Sum of squared forces where nothing had changed, N2, and how many.
    usual: (f64, f64),
}

/// Stretches that the usual force is learned from.
const LEARNED: f64 = 60.0;

impl Flange {
    pub fn new(robot: Robot) -> Self {
        let squares = vec![(0.0, 0.0); robot.dof()];
        Self { robot, squares, force: None, usual: (0.0, 0.0) }
    }

    pub fn learn(&mut self, stretch: &Stretch) {
        for (j, (sum, count)) in self.squares.iter_mut().enumerate() {
            for k in (0..stretch.len()).filter(|&k| stretch.counts[j][k]) {
                *sum += stretch.left(j, k).powi(2);
                *count += 1.0;
            }
        }
    }

    pub fn add(&mut self, stretch: &Stretch) {
        if self.usual.1 < LEARNED {
            self.learn(stretch);
        }
        self.force = self.solve(stretch);
        if let Some(force) = self.force.filter(|_| self.usual.1 < LEARNED) {
            self.usual = (self.usual.0 + force.norm_squared(), self.usual.1 + 1.0);
        }
    }

    /// N, base axes; `None` where too few joints slide to tell.
    pub fn force(&self) -> Option<Vector3<f64>> {
        self.force
    }

    /// Size that it had in the first minutes, N rms.
    pub fn usual_n(&self) -> Option<f64> {
        (self.usual.1 >= 10.0).then(|| (self.usual.0 / self.usual.1).sqrt())
    }

    fn solve(&self, stretch: &Stretch) -> Option<Vector3<f64>> {
        let carrier = self.robot.carrier()?;
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        let mut q = vec![0.0; stretch.joints()];
        for k in (0..stretch.len()).step_by((stretch.len() / INSTANTS).max(1)) {
            stretch.q.sample_into(k, &mut q);
            let at = &self.robot.flange.translation;
            let jacobian = point_jacobian(&self.robot, &q, carrier, at);
            for j in (0..stretch.joints()).filter(|&j| stretch.counts[j][k]) {
                let (sum, count) = self.squares[j];
                let weight = if sum > 0.0 { count / sum } else { continue };
                let lever = jacobian.fixed_view::<3, 1>(0, j).into_owned();
                normal += weight * lever * lever.transpose();
                right -= weight * lever * stretch.left(j, k);
            }
        }
        let eigenvalues = normal.symmetric_eigenvalues();
        // In a direction that no sliding joint feels a force could be anything.
        if eigenvalues.min() <= 1e-3 * eigenvalues.max() {
            return None;
        }
        normal.cholesky().map(|c| c.solve(&right))
    }
}
