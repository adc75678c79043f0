//! rapier against the Runge-Kutta reference: both driven blindly by the same torque over time.

use super::{AccuracyError, Bench};
use crate::effects::JointLoad;
use crate::motion::{Kind, Settings, Trajectory};
use crate::robot::{Workspace, inverse_dynamics};
use crate::simulation::{Plant, PlantError, Reference, Target};

/// Largest distance from the reference at one step size.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Deviation {
    pub step_s: f64,
    pub position_rad: f64,
    /// log2 of the ratio to the row before, per halving of the step.
    pub order: Option<f64>,
}

/// Above the table an arm without feedback falls away from any path, and errors grow with it.
const HANGING_RAD: [f64; 6] = [0.0, 1.57, 0.0, 0.0, 0.0, 0.0];
/// The states are compared this often; every step size divides it.
const COMPARED_S: f64 = 0.004;
const REFERENCE_STEP_S: f64 = 0.0005;

/// Over `duration_s` of motion (3 s or more) at each step size, coarse to fine; the step sizes
/// divide 4 ms.
pub fn deviations(
    bench: &Bench,
    duration_s: f64,
    steps_s: &[f64],
) -> Result<Vec<Deviation>, AccuracyError> {
    let blind = Blind::new(bench, duration_s)?;
    let truth = blind.by_runge_kutta(REFERENCE_STEP_S);
    let mut rows: Vec<Deviation> = Vec::new();
    for &step_s in steps_s {
        let states = blind.by_rapier(step_s)?;
        let gaps = states.iter().zip(&truth).flat_map(|(a, b)| a.iter().zip(b));
        let position_rad = gaps.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let order = rows.last().map(|coarse| {
            (coarse.position_rad / position_rad).ln() / (coarse.step_s / step_s).ln()
        });
        rows.push(Deviation { step_s, position_rad, order });
    }
    Ok(rows)
}

/// Feed-forward of what the arm needs along a trajectory, never corrected.
pub(super) struct Blind<'a> {
    bench: &'a Bench,
    command: Trajectory,
}

impl<'a> Blind<'a> {
    pub fn new(bench: &'a Bench, duration_s: f64) -> Result<Self, AccuracyError> {
        let settings = Settings {
            kind: Kind::RandomFrequency,
            seed: 5,
            duration_s,
            rest_s: 0.2,
            home_rad: Some(HANGING_RAD.to_vec()),
            ..Settings::default()
        };
        let command = settings.trajectory(&bench.mechanism.robot)?;
        Ok(Self { bench, command })
    }

    /// rad
    pub fn start(&self) -> Vec<f64> {
        let mut target = Target::still(self.bench.mechanism.robot.dof());
        target.aim(&self.command, 0.0);
        target.q
    }

    pub fn steps(&self, step_s: f64) -> usize {
        (self.command.duration() / step_s) as usize
    }

    /// N.m at time t (s).
    pub fn torque(&self) -> impl FnMut(f64, &mut [f64]) {
        let mechanism = &self.bench.mechanism;
        let mut workspace = Workspace::new(&mechanism.robot);
        let mut target = Target::still(mechanism.robot.dof());
        move |t, tau| {
            target.aim(&self.command, t);
            let Target { q, qd, qdd } = &target;
            inverse_dynamics(&mechanism.robot, &mut workspace, q, qd, qdd, tau);
            for j in 0..tau.len() {
                let load = self.bench.load(j, qd[j]);
                tau[j] += mechanism.armature[j] * qdd[j]
                    + load.dry * (qd[j] / 0.05).tanh()
                    + load.damping * qd[j];
            }
        }
    }

    fn by_runge_kutta(&self, step_s: f64) -> Vec<Vec<f64>> {
        let mut arm = Reference::new(self.bench.mechanism.clone(), &self.start());
        let mut torque = self.torque();
        let per_row = (COMPARED_S / step_s).round() as usize;
        let mut rows = Vec::new();
        for k in 0..self.steps(step_s) {
            if k.is_multiple_of(per_row) {
                rows.push(arm.q().to_vec());
            }
            arm.step(step_s, &mut |t: f64,
                                   _: &[f64],
                                   v: &[f64],
                                   tau: &mut [f64],
                                   loads: &mut [JointLoad]| {
                torque(t, tau);
                self.bench.loads(v, loads);
            });
        }
        rows
    }

    fn by_rapier(&self, step_s: f64) -> Result<Vec<Vec<f64>>, PlantError> {
        let mut arm = Plant::new(&self.bench.mechanism, step_s)?;
        let still = vec![0.0; arm.dof()];
        arm.set_state(&self.start(), &still);
        let mut torque = self.torque();
        let (mut tau, mut loads) = (still, vec![JointLoad::default(); arm.dof()]);
        let per_row = (COMPARED_S / step_s).round() as usize;
        let mut rows = Vec::new();
        for k in 0..self.steps(step_s) {
            if k.is_multiple_of(per_row) {
                rows.push(arm.q().to_vec());
            }
            torque(k as f64 * step_s, &mut tau);
            self.bench.loads(arm.v(), &mut loads);
            arm.step(&tau, &loads);
        }
        Ok(rows)
    }
}
