//! The arm by classical Runge-Kutta, sharing nothing with rapier: the yardstick for accuracy.
//!
//! Dry friction is set-valued and the mode of each joint is explicit (Karnopp, J. Dynamic Systems,
//! Measurement, and Control 107(1), 1985, without its velocity band): a joint slides with
//! friction dry sign(v), or is stuck with v = 0 and whatever friction up to `dry` keeps it there.
//! Steps are cut by bisection where a sliding joint comes to rest or a stuck one breaks away, so
//! that the order is four between events.

use nalgebra::{DMatrix, DVector};

use crate::effects::{JointLoad, Mechanism};
use crate::robot::{Workspace, inverse_dynamics, mass_matrix};

/// More than this many changes of mode in one step are not resolved one by one.
const MAX_EVENTS: usize = 64;
const BISECTIONS: usize = 60;

/// Forces at (t, q, v): fills motor torques (N.m) and loads, both per joint. Must be a function of
/// its arguments alone during a step: what effects remember moves on when the step is done.
pub trait Forces: FnMut(f64, &[f64], &[f64], &mut [f64], &mut [JointLoad]) {}
impl<F: FnMut(f64, &[f64], &[f64], &mut [f64], &mut [JointLoad])> Forces for F {}

/// A mechanism integrated by fixed-step RK4 with located events.
pub struct Reference {
    mechanism: Mechanism,
    workspace: Workspace,
    state: State,
    modes: Vec<Mode>,
    tau: Vec<f64>,
    loads: Vec<JointLoad>,
    bias: Vec<f64>,
    still: Vec<f64>,
}

#[derive(Debug, Clone)]
struct State {
    time: f64,
    q: DVector<f64>,
    v: DVector<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Stuck,
    /// Slides in this direction, -1 or 1.
    Sliding(f64),
}

/// The equation of motion solved at one state.
struct Solution {
    a: DVector<f64>,
    /// Torque that friction holds at stuck joints, 0 at sliding ones.
    held: DVector<f64>,
}

impl Reference {
    /// The arm at rest at `q` (rad) and time 0.
    pub fn new(mechanism: Mechanism, q: &[f64]) -> Self {
        let n = mechanism.robot.dof();
        Self {
            workspace: Workspace::new(&mechanism.robot),
            state: State { time: 0.0, q: DVector::from_column_slice(q), v: DVector::zeros(n) },
            modes: vec![Mode::Stuck; n],
            tau: vec![0.0; n],
            loads: vec![JointLoad::default(); n],
            bias: vec![0.0; n],
            still: vec![0.0; n],
            mechanism,
        }
    }

    /// s
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// rad
    pub fn q(&self) -> &[f64] {
        self.state.q.as_slice()
    }

    /// rad/s
    pub fn v(&self) -> &[f64] {
        self.state.v.as_slice()
    }

    pub fn is_stuck(&self, joint: usize) -> bool {
        self.modes[joint] == Mode::Stuck
    }

    /// Advances by `step_s`.
    pub fn step(&mut self, step_s: f64, forces: &mut dyn Forces) {
        self.settle(forces);
        let mut left = step_s;
        for _ in 0..MAX_EVENTS {
            let start = self.state.clone();
            self.state = self.runge_kutta(&start, left, forces);
            if !self.at_odds(forces) {
                return;
            }
            left -= self.locate_event(&start, left, forces);
            self.settle(forces);
            if left <= 0.0 {
                return;
            }
        }
        self.state = self.runge_kutta(&self.state.clone(), left, forces);
    }

    /// Classical RK4: k1 to k4 of (q, v)' = (v, a(t, q, v)).
    fn runge_kutta(&mut self, s: &State, h: f64, forces: &mut dyn Forces) -> State {
        let shifted = |by: f64, v: &DVector<f64>, a: &DVector<f64>| State {
            time: s.time + by,
            q: &s.q + v * by,
            v: &s.v + a * by,
        };
        let a1 = self.solve(s, forces).a;
        let s2 = shifted(h / 2.0, &s.v, &a1);
        let a2 = self.solve(&s2, forces).a;
        let s3 = shifted(h / 2.0, &s2.v, &a2);
        let a3 = self.solve(&s3, forces).a;
        let s4 = shifted(h, &s3.v, &a3);
        let a4 = self.solve(&s4, forces).a;
        State {
            time: s.time + h,
            q: &s.q + (&s.v + (&s2.v + &s3.v) * 2.0 + &s4.v) * (h / 6.0),
            v: &s.v + (a1 + (a2 + a3) * 2.0 + a4) * (h / 6.0),
        }
    }

    /// M a + c + g = tau - loads, with a = 0 at stuck joints.
    fn solve(&mut self, s: &State, forces: &mut dyn Forces) -> Solution {
        let (q, v) = (s.q.as_slice(), s.v.as_slice());
        forces(s.time, q, v, &mut self.tau, &mut self.loads);
        let robot = &self.mechanism.robot;
        let mut m = mass_matrix(robot, &mut self.workspace, q);
        inverse_dynamics(robot, &mut self.workspace, q, v, &self.still, &mut self.bias);
        let mut f = DVector::zeros(v.len());
        for j in 0..v.len() {
            m[(j, j)] += self.mechanism.armature[j];
            let load = &self.loads[j];
            f[j] = self.tau[j] - load.torque - load.damping * v[j] - self.bias[j];
            if let Mode::Sliding(sign) = self.modes[j] {
                f[j] -= sign * load.dry;
            }
        }
        let a = self.solve_free(&m, &f);
        let mut held = f - &m * &a;
        for j in 0..v.len() {
            if self.modes[j] != Mode::Stuck {
                held[j] = 0.0;
            }
        }
        Solution { a, held }
    }

    /// M_ff a_f = f_f over the sliding joints, a = 0 elsewhere.
    fn solve_free(&self, m: &DMatrix<f64>, f: &DVector<f64>) -> DVector<f64> {
        let (mut m, mut f) = (m.clone(), f.clone());
        for (j, _) in self.modes.iter().enumerate().filter(|(_, m)| **m == Mode::Stuck) {
            m.row_mut(j).fill(0.0);
            m.column_mut(j).fill(0.0);
            m[(j, j)] = 1.0;
            f[j] = 0.0;
        }
        let zeros = DVector::zeros(f.len());
        m.cholesky().map_or(zeros, |factor| factor.solve(&f))
    }

    /// Does the state contradict the modes: sliding backwards, or held by more than friction can?
    fn at_odds(&mut self, forces: &mut dyn Forces) -> bool {
        let backwards = self.modes.iter().zip(self.state.v.iter()).any(|(m, v)| match m {
            Mode::Sliding(sign) => sign * v < 0.0,
            Mode::Stuck => false,
        });
        backwards || self.overloaded(forces).is_some()
    }

    /// The stuck joint that exceeds its level most, and the direction in which it breaks away.
    fn overloaded(&mut self, forces: &mut dyn Forces) -> Option<(usize, f64)> {
        let state = self.state.clone();
        let held = self.solve(&state, forces).held;
        let excess = |j: usize| held[j].abs() - self.loads[j].dry * (1.0 + 1e-12) - 1e-12;
        (0..held.len())
            .filter(|&j| self.modes[j] == Mode::Stuck && excess(j) > 0.0)
            .max_by(|&i, &j| excess(i).total_cmp(&excess(j)))
            .map(|j| (j, held[j].signum()))
    }

    /// Moves the state to the first contradiction within `h` after `start`; returns the time used.
    fn locate_event(&mut self, start: &State, h: f64, forces: &mut dyn Forces) -> f64 {
        let (mut before, mut after) = (0.0, h);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (before + after);
            self.state = self.runge_kutta(start, middle, forces);
            if self.at_odds(forces) {
                after = middle;
            } else {
                before = middle;
            }
        }
        self.state = self.runge_kutta(start, after, forces);
        after
    }

    /// Stops joints that came to rest and lets go of those that friction cannot hold.
    fn settle(&mut self, forces: &mut dyn Forces) {
        for (mode, v) in self.modes.iter_mut().zip(self.state.v.iter_mut()) {
            if matches!(mode, Mode::Sliding(sign) if *sign * *v < 0.0) {
                (*mode, *v) = (Mode::Stuck, 0.0);
            }
        }
        while let Some((joint, direction)) = self.overloaded(forces) {
            self.modes[joint] = Mode::Sliding(direction);
        }
    }
}
