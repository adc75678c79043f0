//! How the motion of an arm changes with what is fitted: forward sensitivities, by the tangent of each step beside the
//! simulation.
//!
//! A step from (q, v) to v' has T(q, v, v', x) = 0 at the joints that slide, v' = 0 at those that stand, where T is the
//! torque along it that bodies and rotors take, and that servos and effects ask. With M + A_r the mass matrix and
//! rotors, D all damping, and over the joints that slide only,
//!
//! ```text
//! (M + A_r + h D/2) dv' = (M + A_r) dv - h (dT/dv dv + dT/dq dq + dT/dx),   dq' = dq + h dv'
//! ```
//!
//! with the accelerations in T kept (Hairer, Norsett and Wanner, *Solving Ordinary Differential Equations I*, 1993,
//! section I.14). All values share the matrices, which is what a simulation costs; dT/dx is asked of an arm that has a
//! value a little otherwise. Derivatives of T are differences, those of what bodies take at every sample.

mod made;
mod moved;

use nalgebra::DMatrix;

use super::arm::{Arm, Asked, State};
use super::replay::Led;
use super::{Plant, Track, stick};
use made::{ByState, Made};
use moved::Moved;

/// An arm and how its state changes with some values.
#[derive(Clone)]
pub struct Tangent {
    pub(super) plant: Plant,
    moved: Vec<Moved>,
    /// Derivatives of motors' positions and velocities, and of what gears transmit: joint by joint, value by value.
    dq: Vec<f64>,
    dv: Vec<f64>,
    transmitted: Vec<f64>,
    /// Does it matter what gears transmit?
    is_loaded: bool,
    made: Made,
    /// Derivatives of torque by the state: of what bodies take, at the begin of sample `at`, and of all.
    taken: ByState,
    by_state: ByState,
    at: Option<usize>,
    /// By values: of what bodies take, and of all.
    by_bodies: Vec<f64>,
    by_values: Vec<f64>,
    solved: Solved,
}

/// Scratch memory of the tangent's own equation.
#[derive(Clone)]
struct Solved {
    /// N.m, what bodies take.
    torque: Vec<f64>,
    /// The inverse of the left side over the joints that slide; with the right one, what dv' has of dq and dv.
    inverse: DMatrix<f64>,
    to_q: DMatrix<f64>,
    to_v: DMatrix<f64>,
    dv: Vec<f64>,
}

impl Tangent {
    /// Of `plant`, by values of which each of `moved` has one otherwise, by so much; `None` where the state
    /// of an arm is more than its motors' positions and velocities.
    pub fn new(mut plant: Plant, moved: &[(Plant, f64)]) -> Option<Self> {
        if !(plant.is_plain() && moved.iter().all(|(plant, _)| plant.is_plain())) {
            return None;
        }
        let (dof, n) = (plant.state.q.len(), moved.len());
        let columns = || vec![0.0; dof * n];
        let square = || DMatrix::zeros(dof, dof);
        Some(Self {
            moved: moved.iter().map(|(m, by)| Moved::new(&plant.arm, &m.arm, *by)).collect(),
            dq: columns(),
            dv: columns(),
            transmitted: columns(),
            is_loaded: is_loaded(&mut plant.arm),
            made: Made::new(&plant),
            taken: ByState::new(dof),
            by_state: ByState::new(dof),
            at: None,
            by_bodies: columns(),
            by_values: columns(),
            solved: Solved {
                torque: vec![0.0; dof],
                inverse: square(),
                to_q: square(),
                to_v: square(),
                dv: columns(),
            },
            plant,
        })
    }

    /// rad per unit of value `i`: how much more the encoder of joint `j` shows.
    pub fn shown(&self, j: usize, i: usize) -> f64 {
        self.dq[j * self.moved.len() + i] + self.moved[i].shown[j]
    }

    /// By values, of what bodies take along the step.
    fn differentiate_bodies(&mut self) {
        let Self { plant, moved, made, by_bodies, solved, .. } = self;
        let n = moved.len();
        let mut others = moved.iter_mut().enumerate().filter(|(_, m)| m.has_bodies()).peekable();
        if others.peek().is_none() {
            return;
        }
        made.taken_by(plant.arm.robot(), &mut solved.torque);
        others.for_each(|(i, m)| {
            m.by_bodies(made, &solved.torque, |j, by| by_bodies[j * n + i] = by)
        });
    }

    /// By values, of all torque along the step.
    fn differentiate_all(&mut self, hear: impl Fn(&mut Arm)) {
        let Self { plant, moved, made, by_values, .. } = self;
        let n = moved.len();
        by_values.copy_from_slice(&self.by_bodies);
        for (i, m) in moved.iter_mut().enumerate() {
            m.by_rest(made, &plant.arm, &hear, |j, by| by_values[j * n + i] += by);
        }
        if self.is_loaded {
            let rows = by_values.chunks_exact_mut(n).zip(self.transmitted.chunks_exact(n));
            let rows = rows.zip(&self.by_state.transmitted);
            rows.for_each(|((by, transmitted), share)| stick::add(by, *share, transmitted));
        }
    }

    /// dv' and dq' of a step of `h` s.
    fn advance(&mut self, h: f64) {
        let kick = self.plant.kick;
        self.pose(kick);
        let Self { moved, dq, dv, by_values, solved, .. } = self;
        let Solved { inverse, to_q, to_v, dv: next, .. } = solved;
        let n = moved.len();
        next.fill(0.0);
        for (j, next) in next.chunks_exact_mut(n).enumerate() {
            for k in 0..inverse.nrows() {
                let at = k * n..(k + 1) * n;
                stick::add(next, to_v[(j, k)], &dv[at.clone()]);
                stick::add(next, to_q[(j, k)], &dq[at.clone()]);
                stick::add(next, -kick * inverse[(j, k)], &by_values[at]);
            }
        }
        self.carry(kick);
        let Self { dq, dv, solved, .. } = self;
        stick::add(dq, h, &solved.dv);
        dv.copy_from_slice(&solved.dv);
    }

    /// What dv' has of dq and dv.
    fn pose(&mut self, h: f64) {
        let Self { plant, by_state, solved, .. } = self;
        let (a, asked) = (&plant.step.a, plant.asked());
        by_state.q *= -h;
        by_state.v *= -h;
        by_state.v += a;
        for (j, asked) in asked.iter().enumerate() {
            by_state.v[(j, j)] -= 0.5 * h * asked.damping;
        }
        inverse_of_sliding(plant, &mut solved.inverse);
        solved.inverse.mul_to(&by_state.q, &mut solved.to_q);
        solved.inverse.mul_to(&by_state.v, &mut solved.to_v);
    }

    /// What gears transmit, where that matters: what bodies take.
    fn carry(&mut self, h: f64) {
        if !self.is_loaded {
            return;
        }
        let Self { plant, moved, dq, dv, transmitted, taken, solved, .. } = self;
        let n = moved.len();
        transmitted.copy_from_slice(&self.by_bodies);
        for (j, transmitted) in transmitted.chunks_exact_mut(n).enumerate() {
            for k in 0..taken.q.nrows() {
                let (at, gained) = (k * n..(k + 1) * n, plant.step.links[(j, k)] / h);
                stick::add(transmitted, taken.q[(j, k)], &dq[at.clone()]);
                stick::add(transmitted, taken.v[(j, k)] - gained, &dv[at.clone()]);
                stick::add(transmitted, gained, &solved.dv[at]);
            }
        }
    }
}

impl Led for Tangent {
    fn plant(&mut self) -> &mut Plant {
        &mut self.plant
    }

    fn begin(&mut self) {
        let n = self.moved.len();
        self.dv.fill(0.0);
        self.solved.dv.fill(0.0);
        for (i, m) in self.moved.iter().enumerate() {
            m.shown.iter().enumerate().for_each(|(j, shown)| self.dq[j * n + i] = -shown);
        }
        self.at = None;
        // A step that takes for ever: nothing is accelerated.
        self.made.rest(&self.plant);
        self.made.differentiate_taken(self.plant.arm.robot(), &mut self.taken);
        self.differentiate_bodies();
        self.carry(f64::INFINITY);
    }

    fn follow(&mut self, h: f64, track: &Track, k: usize, place: f64) {
        self.made.begin.clone_from(&self.plant.state);
        self.plant.follow(h, track, k, place);
        let Self { plant, made, taken, by_state, .. } = self;
        made.end(plant, h);
        if self.at.replace(k) != Some(k) {
            made.differentiate_taken(plant.arm.robot(), taken);
        }
        by_state.copy_from(taken);
        made.add_asked(&mut plant.arm, self.is_loaded, by_state);
        self.differentiate_bodies();
        self.differentiate_all(|arm| arm.hear(track, k, place));
        self.advance(h);
    }
}

/// The inverse of the step's A over the joints that slide; zero at those that stand.
fn inverse_of_sliding(plant: &Plant, inverse: &mut DMatrix<f64>) {
    let dof = inverse.nrows();
    let stands = |j: usize| !plant.yields(j).slides;
    if !(0..dof).any(stands) {
        return inverse.copy_from(&plant.step.inverse);
    }
    inverse.copy_from(&plant.step.a);
    let decouple = |m: &mut DMatrix<f64>, diagonal: f64| {
        for j in (0..dof).filter(|j| stands(*j)) {
            m.row_mut(j).fill(0.0);
            m.column_mut(j).fill(0.0);
            m[(j, j)] = diagonal;
        }
    };
    decouple(inverse, 1.0);
    stick::invert(inverse);
    decouple(inverse, 0.0);
}

/// Does what is asked depend on what gears transmit?
fn is_loaded(arm: &mut Arm) -> bool {
    let dof = arm.robot().dof();
    let mut asked = |transmitted: f64| {
        let transmitted = vec![transmitted; dof];
        let state = State { v: vec![1.0; dof], transmitted, ..State::new(dof) };
        let mut asked = vec![Asked::default(); dof];
        arm.ask(&state, 1.0, &mut asked);
        asked
    };
    asked(1.0) != asked(2.0)
}
