//! An arm of position servos, stepped: few joints, rigid links, dry friction as a constraint.
//!
//! ```text
//! (M(q_k) + h D/2) v_{k+1/2} + p = (M - h D/2) v_{k-1/2} + h (tau(q_k) - c - g - loads),  q_{k+1} = q_k + h v_{k+1/2}
//! ```
//!
//! Velocities lie between positions (leapfrog), which is of second order in h where nothing sticks; D is all
//! damping, the servos' own included, and p the impulses of dry friction ([`super::stick`]). The effects of
//! the catalogue act as they do in rapier, which remains the reference.

use nalgebra::{DMatrix, DVector};

use super::ServoError;
use super::stick;
use crate::effects::{ArmState, JointLoad, Mechanism};
use crate::resimulation::injections;
use crate::robot::{Servo, Workspace, inverse_dynamics, mass_matrix};
use crate::simulation::Injections;
use crate::twin::Twin;

/// Faster than this no servo turns, rad/s.
const RUNAWAY_RAD_S: f64 = 1e3;

/// The arm of a twin with all that the twin knows of it.
pub struct Plant {
    mechanism: Mechanism,
    servo: Servo,
    effects: Injections,
    workspace: Workspace,
    /// s since the start of the recording.
    time: f64,
    temperature: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    transmitted: Vec<f64>,
    loads: Vec<JointLoad>,
    impulses: Vec<f64>,
    bias: Vec<f64>,
    still: Vec<f64>,
    yields: Vec<Yield>,
}

/// How a joint gave way in the last step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Yield {
    /// kg.m2, rotor and links.
    pub inertia: f64,
    /// N.m.s/rad, servo and friction.
    pub damping: f64,
    /// N.m/rad of the servo.
    pub slope: f64,
    pub slides: bool,
}

impl Plant {
    /// Stands at zero to begin with; `start_s` is when the recording begins.
    ///
    /// # Errors
    /// If the twin has no servos, or an effect this simulation does not have.
    pub fn new(twin: &Twin, start_s: f64) -> Result<Self, ServoError> {
        let assumed = twin.drive.servo.as_ref().ok_or(ServoError::NoServo)?;
        let mechanism = twin.mechanism(|_| true);
        if let Some(effect) = elastic(twin, &mechanism) {
            return Err(ServoError::Elastic { effect });
        }
        let dof = twin.robot.dof();
        let zeros = || vec![0.0; dof];
        Ok(Self {
            servo: mechanism.servos(assumed),
            effects: Injections::new(&injections(twin, start_s)),
            workspace: Workspace::new(&mechanism.robot),
            mechanism,
            time: 0.0,
            temperature: vec![USUAL_C; dof],
            q: zeros(),
            v: zeros(),
            transmitted: zeros(),
            loads: vec![JointLoad::default(); dof],
            impulses: zeros(),
            bias: zeros(),
            still: zeros(),
            yields: vec![Yield::default(); dof],
        })
    }

    /// The servos as they are.
    pub fn servo(&self) -> &Servo {
        &self.servo
    }

    /// Puts the joints at `q` (rad, as the encoders show it) moving at `v` (rad/s), `time` s after the start.
    pub fn set_state(&mut self, time: f64, q: &[f64], v: &[f64]) {
        self.time = time;
        for (j, zero) in self.mechanism.encoder_zero.iter().enumerate() {
            self.q[j] = q[j] - zero;
        }
        self.v.copy_from_slice(v);
        self.impulses.fill(0.0);
        self.effects.forget();
        inverse_dynamics(
            &self.mechanism.robot,
            &mut self.workspace,
            &self.q,
            &self.v,
            &self.still,
            &mut self.transmitted,
        );
    }

    /// Joints are so warm from now on, deg C.
    pub fn set_temperature(&mut self, celsius: &[f64]) {
        self.temperature.copy_from_slice(celsius);
    }

    /// rad, as the encoder of joint `j` shows it.
    pub fn shown(&self, j: usize) -> f64 {
        self.q[j] + self.mechanism.encoder_zero[j]
    }

    /// rad/s of joint `j`
    pub fn speed(&self, j: usize) -> f64 {
        self.v[j]
    }

    /// How joint `j` gave way in the last step.
    pub fn yields(&self, j: usize) -> Yield {
        self.yields[j]
    }

    /// One step of `h` s: servos of `gain` N.m/rad (0 while one is off) are told `command` (rad).
    pub fn step(&mut self, h: f64, command: &[f64], gain: &[f64]) {
        let dof = self.q.len();
        let robot = &self.mechanism.robot;
        let state = ArmState {
            robot,
            time: self.time,
            dt: h,
            q: &self.q,
            qd: &self.v,
            transmitted: &self.transmitted,
            temperature: &self.temperature,
        };
        self.effects.loads(&state, &mut self.loads);
        inverse_dynamics(robot, &mut self.workspace, &self.q, &self.v, &self.still, &mut self.bias);
        let mut m = mass_matrix(robot, &mut self.workspace, &self.q);
        let links = m.clone();
        let mut b = DVector::zeros(dof);
        let mut limit = vec![0.0; dof];
        let mut damping = vec![0.0; dof];
        for j in 0..dof {
            m[(j, j)] += self.mechanism.armature[j];
            let on = if gain[j] > 0.0 { 1.0 } else { 0.0 };
            damping[j] = self.loads[j].damping + on * self.servo.damping[j];
        }
        for i in 0..dof {
            let shown = self.q[i] + self.mechanism.encoder_zero[i];
            let [pull, slope] = self.servo.pull(i, gain[i], command[i] - shown);
            let dry = self.loads[i].dry + self.servo.friction[i] * pull.abs();
            limit[i] = h * dry.max(0.0);
            let inertia = m[(i, i)];
            self.yields[i] = Yield { inertia, damping: damping[i], slope, slides: true };
            let carried: f64 = (0..dof).map(|j| m[(i, j)] * self.v[j]).sum();
            let torque = pull - self.bias[i] - self.loads[i].torque;
            b[i] = carried - 0.5 * h * damping[i] * self.v[i] + h * torque;
        }
        (0..dof).for_each(|j| m[(j, j)] += 0.5 * h * damping[j]);
        let mut v = vec![0.0; dof];
        stick::solve(&inverse(m), &b, &limit, &mut self.impulses, &mut v);
        for i in 0..dof {
            let accelerated: f64 =
                (0..dof).map(|j| links[(i, j)] * (v[j] - self.v[j])).sum::<f64>() / h;
            self.transmitted[i] = self.bias[i] + accelerated;
        }
        for (j, v) in v.into_iter().enumerate() {
            self.v[j] = v;
            self.q[j] += h * v;
            self.yields[j].slides = v != 0.0;
        }
        self.time += h;
    }

    /// # Errors
    /// Names the joint that has left what arms do.
    pub fn check(&self) -> Result<(), ServoError> {
        let mut states = self.q.iter().zip(&self.v);
        let wild = states.position(|(q, v)| !(q.is_finite() && v.abs() < RUNAWAY_RAD_S));
        let time_s = self.time;
        wild.map_or(Ok(()), |j| Err(ServoError::Diverged { joint: j + 1, time_s }))
    }
}

/// Temperature at which friction holds as it stands, where none is recorded, deg C.
const USUAL_C: f64 = 25.0;

/// Of a symmetric positive definite matrix; of one that is none because a value ran away, zeros.
fn inverse(m: DMatrix<f64>) -> DMatrix<f64> {
    if m.nrows() == 1 {
        return DMatrix::from_element(1, 1, 1.0 / m[(0, 0)]);
    }
    let n = m.nrows();
    m.cholesky().map_or_else(|| DMatrix::zeros(n, n), |c| c.inverse())
}

/// The effect that gives way between motor and link.
fn elastic(twin: &Twin, mechanism: &Mechanism) -> Option<String> {
    if mechanism.transmission.iter().all(Option::is_none) {
        return None;
    }
    let name = twin.catalogued().find(|e| e.gives_way()).map(|e| e.about().name);
    Some(name.unwrap_or("an elastic transmission").into())
}
