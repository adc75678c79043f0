//! Force over time along a course of modes.
//!
//! The smoother of Rauch, Tung and Striebel (AIAA Journal 3(8), 1965): x(k|n) = x(k|k) + C (x(k+1|n)
//! - x(k+1|k)), C = P(k|k) A^T P(k+1|k)^-1.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::kalman::Belief;
use super::model::{Mode, Steps};

/// Per step.
pub struct Smoothed {
    /// Force on the arm, N, base axes, and its covariance; zero where nothing touches.
    pub force: Vec<(Vector3<f64>, Matrix3<f64>)>,
}

/// The log-evidence of a course over some steps, from a state that is not known.
pub fn log_evidence(steps: &Steps, modes: &[Mode]) -> f64 {
    let mut belief = steps.start();
    modes.iter().enumerate().map(|(k, mode)| steps.step(&mut belief, k, *mode)).sum()
}

pub fn smooth(steps: &Steps, modes: &[Mode]) -> Smoothed {
    let mut belief = steps.start();
    let (mut predicted, mut filtered) = (Vec::new(), Vec::new());
    for (k, mode) in modes.iter().enumerate() {
        let (decay, grow) = steps.transition(k, *mode);
        belief.predict(&decay, &grow);
        predicted.push((belief.clone(), decay));
        steps.hear(&mut belief, k, *mode);
        filtered.push(belief.clone());
    }
    for k in (0..filtered.len().saturating_sub(1)).rev() {
        let (ahead, decay) = &predicted[k + 1];
        filtered[k] = backward(&filtered[k], &filtered[k + 1], ahead, decay);
    }
    let joints = steps.joints;
    let force = |belief: &Belief| {
        let covariance = Matrix3::from_fn(|i, j| belief.p[(joints + i, joints + j)]);
        (Vector3::from_fn(|i, _| belief.x[joints + i]), covariance)
    };
    Smoothed { force: filtered.iter().map(force).collect() }
}

/// What is known at a step when all that follows is known. States that are nil for certain at the
/// next step (a force that has ended) have no variance there and say nothing.
fn backward(now: &Belief, next: &Belief, ahead: &Belief, decay: &[f64]) -> Belief {
    let decay = DVector::from_column_slice(decay);
    let carried = &now.p * DMatrix::from_diagonal(&decay);
    let mut inverse = ahead.p.clone();
    for i in 0..decay.len() {
        if inverse[(i, i)] <= 0.0 {
            inverse[(i, i)] = 1.0;
        }
    }
    let Some(inverse) = inverse.cholesky().map(|c| c.inverse()) else { return now.clone() };
    let c = carried * inverse;
    let x = &now.x + &c * (&next.x - &ahead.x);
    let p = &now.p + &c * (&next.p - &ahead.p) * c.transpose();
    Belief { x, p: (&p + p.transpose()) * 0.5 }
}
