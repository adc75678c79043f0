//! An arm of position servos, stepped: few joints, dry friction as a constraint, transmissions that may give way.
//!
//! ```text
//! (M(q_k) + h D/2) v_{k+1/2} + p = (M - h D/2) v_{k-1/2} + h (tau(q_k) - c - g - loads),  q_{k+1} = q_k + h v_{k+1/2}
//! ```
//!
//! Velocities lie between positions (leapfrog), which is of second order in h but for what sticks and what speeds ask other
//! than damping (Coriolis, Stribeck), taken half a step early; the first step from a given state changes velocities by half as
//! much. D is all damping, the servos' own included, and p the impulses of dry friction ([`super::stick`]). The effects of the
//! catalogue act as they do in rapier, which remains the reference. Where a transmission gives way, its wind-up is a coordinate
//! beside the motor's angle ([`super::wound`]).

use nalgebra::{DMatrix, DVector};

use super::arm::{Arm, Asked, State};
use super::replay::Led;
use super::wound::{self, Wound};
use super::{ServoError, Track, stick};
use crate::robot::{Servo, Workspace, equation_of_motion, gravity_torque, inverse_dynamics};
use crate::twin::Twin;

/// Faster than this no servo turns, rad/s.
const RUNAWAY_RAD_S: f64 = 1e3;

/// The arm of a twin with all that the twin knows of it.
#[derive(Clone)]
pub struct Plant {
    pub(super) arm: Arm,
    workspace: Workspace,
    pub(super) state: State,
    /// Links, rad and rad/s: those of the motors where nothing gives way.
    link_q: Vec<f64>,
    link_v: Vec<f64>,
    wound: Vec<Wound>,
    asked: Vec<Asked>,
    impulses: Vec<f64>,
    bias: Vec<f64>,
    still: Vec<f64>,
    yields: Vec<Yield>,
    /// Do velocities lie where positions do, as where a state was given?
    begins: bool,
    /// For how long torque changed velocities in the last step, s.
    pub(super) kick: f64,
    pub(super) step: Step,
}

/// Scratch memory of a step: motors first, then wind-ups.
#[derive(Clone)]
pub(super) struct Step {
    /// Mass matrix of the links, kg.m2.
    pub links: DMatrix<f64>,
    /// The equation of the step, before transmissions carry anything: A, b, and the largest impulses of dry friction.
    pub a: DMatrix<f64>,
    b: DVector<f64>,
    limit: Vec<f64>,
    /// The inverse of A, and b, with what transmissions carry.
    pub inverse: DMatrix<f64>,
    coupled: DVector<f64>,
    /// Speeds before, then after it, rad/s.
    v: Vec<f64>,
    /// Those of the links before it, rad/s.
    link_v: Vec<f64>,
}

impl Step {
    fn new(dof: usize, wound: usize) -> Self {
        let (n, square) = (dof + wound, |n| DMatrix::zeros(n, n));
        Self {
            links: square(dof),
            a: square(n),
            b: DVector::zeros(n),
            limit: vec![0.0; n],
            inverse: square(n),
            coupled: DVector::zeros(n),
            v: vec![0.0; n],
            link_v: vec![0.0; dof],
        }
    }
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
    /// If the twin has no servos, or a motor without a rotor drives a joint that gives way.
    pub fn new(twin: &Twin, start_s: f64) -> Result<Self, ServoError> {
        let arm = Arm::new(twin, start_s)?;
        let wound = arm.wound()?;
        let dof = twin.robot.dof();
        let zeros = || vec![0.0; dof];
        Ok(Self {
            workspace: Workspace::new(arm.robot()),
            arm,
            state: State::new(dof),
            link_q: zeros(),
            link_v: zeros(),
            asked: vec![Asked::default(); dof],
            impulses: vec![0.0; dof + wound.len()],
            step: Step::new(dof, wound.len()),
            wound,
            bias: zeros(),
            still: zeros(),
            yields: vec![Yield::default(); dof],
            begins: true,
            kick: 0.0,
        })
    }

    /// The servos as they are.
    pub fn servo(&self) -> &Servo {
        &self.arm.servo
    }

    /// Puts the joints at `q` (rad, as the encoders show it) moving at `v` (rad/s), `time` s after the start; what
    /// gives way hangs at rest under the links' weight.
    pub fn set_state(&mut self, time: f64, q: &[f64], v: &[f64]) {
        self.state.time = time;
        for (j, zero) in self.arm.mechanism.encoder_zero.iter().enumerate() {
            self.state.q[j] = q[j] - zero;
        }
        self.state.v.copy_from_slice(v);
        self.begins = true;
        self.impulses.fill(0.0);
        self.arm.forget();
        let robot = self.arm.robot();
        gravity_torque(robot, &mut self.workspace, &self.state.q, &mut self.state.transmitted);
        self.wound.iter_mut().for_each(|w| w.hang(self.state.transmitted[w.joint]));
        self.place_links();
        let (robot, q, v) = (self.arm.robot(), &self.link_q, &self.link_v);
        inverse_dynamics(
            robot,
            &mut self.workspace,
            q,
            v,
            &self.still,
            &mut self.state.transmitted,
        );
    }

    fn place_links(&mut self) {
        self.link_q.copy_from_slice(&self.state.q);
        self.link_v.copy_from_slice(&self.state.v);
        for wound in &self.wound {
            self.link_q[wound.joint] -= wound.angle;
            self.link_v[wound.joint] -= wound.rate;
        }
    }

    /// Joints are so warm from now on, deg C.
    pub fn set_temperature(&mut self, celsius: &[f64]) {
        self.state.temperature.copy_from_slice(celsius);
    }

    /// rad, as the encoder of joint `j` shows it.
    pub fn shown(&self, j: usize) -> f64 {
        self.state.q[j] + self.arm.mechanism.encoder_zero[j]
    }

    /// rad/s of joint `j`
    pub fn speed(&self, j: usize) -> f64 {
        self.state.v[j]
    }

    /// How joint `j` gave way in the last step.
    pub fn yields(&self, j: usize) -> Yield {
        self.yields[j]
    }

    /// What was asked of every joint in the last step.
    pub(super) fn asked(&self) -> &[Asked] {
        &self.asked
    }

    /// Nothing gives way, and nothing that acts depends on what happened before: the state is positions and velocities.
    pub(super) fn is_plain(&self) -> bool {
        self.wound.is_empty() && !self.arm.remembers()
    }

    /// One step of `h` s: servos of `gain` N.m/rad (0 while one is off) are told `command` (rad).
    pub fn step(&mut self, h: f64, command: &[f64], gain: &[f64]) {
        self.arm.tell(command, gain);
        self.go_on(h);
    }

    /// One step of `h` s with what the servos have heard.
    fn go_on(&mut self, h: f64) {
        self.kick = if std::mem::take(&mut self.begins) { 0.5 * h } else { h };
        self.arm.ask(&self.state, h, &mut self.asked);
        self.pose();
        self.find_speeds(h);
        self.advance(h);
    }

    /// The equation of the step.
    fn pose(&mut self) {
        let (dof, kick) = (self.state.q.len(), self.kick);
        let Step { links, a, b, limit, v, .. } = &mut self.step;
        let state = [&self.link_q[..], &self.link_v];
        equation_of_motion(self.arm.robot(), &mut self.workspace, state, links, &mut self.bias);
        wound::with_wind_ups(links, &self.wound, a);
        (0..dof).for_each(|j| a[(j, j)] += self.arm.mechanism.armature[j]);
        v[..dof].copy_from_slice(&self.state.v);
        v[dof..].iter_mut().zip(&self.wound).for_each(|(v, w)| *v = w.rate);
        stick::product(a, v, b.as_mut_slice());
        for (i, asked) in self.asked.iter().enumerate() {
            let Asked { torque, damping, dry, slope } = *asked;
            limit[i] = kick * dry.max(0.0);
            self.yields[i] = Yield { inertia: a[(i, i)], damping, slope, slides: true };
            b[i] -= kick * (self.bias[i] + torque) + 0.5 * kick * damping * self.state.v[i];
            a[(i, i)] += 0.5 * kick * damping;
        }
        for (i, wound) in self.wound.iter().enumerate() {
            b[dof + i] += kick * self.bias[wound.joint];
        }
    }

    /// Speeds of motors and wind-ups after a step, with whichever teeth touch in it.
    fn find_speeds(&mut self, h: f64) {
        let dof = self.state.q.len();
        let Step { a, b, limit, inverse, coupled, v, .. } = &mut self.step;
        for _ in 0..wound::TRIES {
            inverse.copy_from(a);
            coupled.copy_from(b);
            wound::couple(&self.wound, [self.kick, h], inverse, coupled);
            stick::invert(inverse);
            stick::solve(inverse, coupled, limit, &mut self.impulses, v);
            // All of them: each notes where its teeth touch.
            let wound = self.wound.iter_mut().zip(&v[dof..]);
            if wound.fold(true, |settled, (w, rate)| w.is_settled(h, *rate) && settled) {
                break;
            }
        }
    }

    fn advance(&mut self, h: f64) {
        let dof = self.state.q.len();
        self.step.link_v.copy_from_slice(&self.link_v);
        for (wound, rate) in self.wound.iter_mut().zip(&self.step.v[dof..]) {
            wound.advance(h, *rate);
        }
        for (j, v) in self.step.v[..dof].iter().enumerate() {
            self.state.v[j] = *v;
            self.state.q[j] += h * v;
            self.yields[j].slides = *v != 0.0;
        }
        self.place_links();
        let Step { links, link_v: gained, .. } = &mut self.step;
        gained.iter_mut().zip(&self.link_v).for_each(|(before, now)| *before = now - *before);
        stick::product(links, gained, &mut self.state.transmitted);
        for (carried, bias) in self.state.transmitted.iter_mut().zip(&self.bias) {
            *carried = bias + *carried / self.kick;
        }
        self.state.time += h;
    }

    /// # Errors
    /// Names the joint that has left what arms do.
    pub fn check(&self) -> Result<(), ServoError> {
        let mut states = self.link_q.iter().zip(&self.link_v);
        let wild = states.position(|(q, v)| !(q.is_finite() && v.abs() < RUNAWAY_RAD_S));
        let time_s = self.state.time;
        wild.map_or(Ok(()), |j| Err(ServoError::Diverged { joint: j + 1, time_s }))
    }
}

impl Led for Plant {
    fn plant(&mut self) -> &mut Plant {
        self
    }

    fn follow(&mut self, h: f64, track: &Track, k: usize, place: f64) {
        self.arm.hear(track, k, place);
        self.go_on(h);
    }
}
