//! The energy books of a simulated motion: work of the motors = change of energy + friction heat.

use super::open_loop::Blind;
use super::{AccuracyError, Bench};
use crate::effects::JointLoad;
use crate::robot::{Workspace, energy};
use crate::simulation::Plant;

/// J
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Balance {
    pub step_s: f64,
    /// Work of the motors.
    pub work: f64,
    /// Kinetic (rotors included) and potential energy, end against start.
    pub stored: f64,
    /// Heat by dry and viscous friction.
    pub heat: f64,
}

impl Balance {
    /// What the books leave open, as a share of the energy that was turned over.
    pub fn open_share(&self) -> f64 {
        (self.work - self.stored - self.heat).abs() / (self.stored.abs() + self.heat.abs())
    }
}

/// Energy books over `duration_s` of blindly driven motion with friction.
pub fn balance(bench: &Bench, duration_s: f64, step_s: f64) -> Result<Balance, AccuracyError> {
    let blind = Blind::new(bench, duration_s)?;
    let mut arm = Plant::new(&bench.mechanism, step_s)?;
    let still = vec![0.0; arm.dof()];
    arm.set_state(&blind.start(), &still);
    let mut torque = blind.torque();
    let (mut tau, mut loads) = (still, vec![JointLoad::default(); arm.dof()]);
    let mut books = Balance { step_s, work: 0.0, stored: 0.0, heat: 0.0 };
    let mut first = None;
    let mut last = 0.0;
    for k in 0..blind.steps(step_s) {
        torque(k as f64 * step_s, &mut tau);
        bench.loads(arm.v(), &mut loads);
        let q = arm.q().to_vec();
        arm.step(&tau, &loads);
        last = stored(bench, &q, arm.v_mid());
        first.get_or_insert(last);
        for (j, &v) in arm.v_mid().iter().enumerate() {
            books.work += tau[j] * v * step_s;
            books.heat += (loads[j].dry * v.abs() + loads[j].damping * v * v) * step_s;
        }
    }
    books.stored = last - first.unwrap_or(last);
    Ok(books)
}

fn stored(bench: &Bench, q: &[f64], v: &[f64]) -> f64 {
    let mechanism = &bench.mechanism;
    let mut workspace = Workspace::new(&mechanism.robot);
    let rotors: f64 = mechanism.armature.iter().zip(v).map(|(i, v)| 0.5 * i * v * v).sum();
    energy(&mechanism.robot, &mut workspace, q, v).total() + rotors
}
