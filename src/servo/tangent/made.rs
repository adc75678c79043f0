//! A step that an arm made, and how the torque along it changes with where it began.

use nalgebra::DMatrix;

use crate::robot::{Robot, Workspace, inverse_dynamics};
use crate::servo::Plant;
use crate::servo::arm::{Arm, Asked, State};

/// Steps of differences by positions, velocities and torques, rad, rad/s and N.m.
const MOVE: f64 = 1e-6;
/// Sides that differences are taken to. What begins where the arm touches something is no slope, and on one side only.
const AHEAD: [f64; 1] = [MOVE];
const BOTH: [f64; 2] = [MOVE, -MOVE];

/// From where to where, and scratch memory.
#[derive(Clone)]
pub struct Made {
    pub begin: State,
    /// s
    pub h: f64,
    /// rad/s after it, and rad/s2 on the way.
    pub after: Vec<f64>,
    pub acceleration: Vec<f64>,
    asked: Vec<Asked>,
    workspace: Workspace,
    /// N.m, the torque that was differentiated last: along the step, and from a state a little otherwise.
    own: Vec<f64>,
    other: Vec<f64>,
    slopes: Vec<f64>,
    /// Positions or velocities where the step begins, rad or rad/s.
    before: Vec<f64>,
}

/// Derivatives of torque along a step by what it began with, N.m per rad, rad/s and N.m.
#[derive(Clone)]
pub struct ByState {
    pub q: DMatrix<f64>,
    pub v: DMatrix<f64>,
    /// Joint by joint: gears do not feel each other's load.
    pub transmitted: Vec<f64>,
}

impl ByState {
    pub fn new(dof: usize) -> Self {
        let square = || DMatrix::zeros(dof, dof);
        Self { q: square(), v: square(), transmitted: vec![0.0; dof] }
    }

    fn clear(&mut self) {
        self.q.fill(0.0);
        self.v.fill(0.0);
        self.transmitted.fill(0.0);
    }

    pub fn copy_from(&mut self, other: &Self) {
        self.q.copy_from(&other.q);
        self.v.copy_from(&other.v);
        self.transmitted.copy_from_slice(&other.transmitted);
    }
}

impl Made {
    pub fn new(plant: &Plant) -> Self {
        let dof = plant.state.q.len();
        let zeros = || vec![0.0; dof];
        Self {
            begin: plant.state.clone(),
            h: 1.0,
            after: zeros(),
            acceleration: zeros(),
            asked: vec![Asked::default(); dof],
            workspace: Workspace::new(plant.arm.robot()),
            own: zeros(),
            other: zeros(),
            slopes: zeros(),
            before: zeros(),
        }
    }

    /// The plant stands still where it is.
    pub fn rest(&mut self, plant: &Plant) {
        self.begin.clone_from(&plant.state);
        self.after.copy_from_slice(&plant.state.v);
        self.acceleration.fill(0.0);
    }

    /// The plant has made a step of `h` s from where this begins.
    pub fn end(&mut self, plant: &Plant, h: f64) {
        self.h = h;
        self.after.copy_from_slice(&plant.state.v);
        let both = self.after.iter().zip(&self.begin.v);
        let both = self.acceleration.iter_mut().zip(both);
        both.for_each(|(a, (after, before))| *a = (after - before) / plant.kick);
    }

    /// What servos and effects of an arm ask along it, N.m.
    pub fn asked_of(&mut self, arm: &mut Arm, torque: &mut [f64]) {
        arm.ask(&self.begin, self.h, &mut self.asked);
        self.along(torque);
    }

    /// The part of that which effects ask.
    pub fn asked_of_effects(&mut self, arm: &mut Arm, torque: &mut [f64]) {
        arm.ask_effects(&self.begin, self.h, &mut self.asked);
        self.along(torque);
    }

    fn along(&self, torque: &mut [f64]) {
        let speeds = self.begin.v.iter().zip(&self.after);
        for (torque, (asked, (before, after))) in
            torque.iter_mut().zip(self.asked.iter().zip(speeds))
        {
            *torque = asked.along([*before, *after], after.signum());
        }
    }

    /// What bodies take along it, N.m.
    pub fn taken_by(&mut self, robot: &Robot, torque: &mut [f64]) {
        let State { q, v, .. } = &self.begin;
        inverse_dynamics(robot, &mut self.workspace, q, v, &self.acceleration, torque);
    }

    /// How what bodies take changes.
    pub fn differentiate_taken(&mut self, robot: &Robot, by: &mut ByState) {
        by.clear();
        self.add_derivatives(by, (&AHEAD, false), |made, torque| made.taken_by(robot, torque));
    }

    /// Adds how what servos and effects ask changes; with what gears transmit where that matters.
    pub fn add_asked(&mut self, arm: &mut Arm, is_loaded: bool, by: &mut ByState) {
        let sides = if arm.has_contacts() { &BOTH[..] } else { &AHEAD };
        let at_once = !arm.feels_other_joints();
        self.add_derivatives(by, (sides, at_once), |made, torque| made.asked_of(arm, torque));
        if !is_loaded {
            return;
        }
        let mut other = std::mem::take(&mut self.other);
        self.begin.transmitted.iter_mut().for_each(|t| *t += MOVE);
        self.asked_of(arm, &mut other);
        self.begin.transmitted.iter_mut().for_each(|t| *t -= MOVE);
        for (by, (other, own)) in by.transmitted.iter_mut().zip(other.iter().zip(&self.own)) {
            *by = (other - own) / MOVE;
        }
        self.other = other;
    }

    /// Differences of a torque by positions and velocities; of several sides the smallest. All joints are moved `at_once` where that
    /// of none depends on another, else one after the other.
    fn add_derivatives(
        &mut self,
        by: &mut ByState,
        (sides, at_once): (&[f64], bool),
        mut torque: impl FnMut(&mut Self, &mut [f64]),
    ) {
        let [mut own, mut other, mut slopes, mut before] =
            [&mut self.own, &mut self.other, &mut self.slopes, &mut self.before]
                .map(std::mem::take);
        torque(self, &mut own);
        let width = if at_once { own.len() } else { 1 };
        for first in (0..own.len()).step_by(width) {
            for (part, by) in [((|s| &mut s.q) as Part, &mut by.q), (|s| &mut s.v, &mut by.v)] {
                before.copy_from_slice(part(&mut self.begin));
                slopes.fill(f64::INFINITY);
                for side in sides {
                    part(&mut self.begin)[first..first + width].iter_mut().for_each(|x| *x += side);
                    torque(self, &mut other);
                    part(&mut self.begin).copy_from_slice(&before);
                    for (slope, (other, own)) in slopes.iter_mut().zip(other.iter().zip(&own)) {
                        let here = (other - own) / side;
                        *slope = if here.abs() < slope.abs() { here } else { *slope };
                    }
                }
                for (j, slope) in slopes.iter().enumerate() {
                    by[(j, if at_once { j } else { first })] += slope;
                }
            }
        }
        (self.own, self.other, self.slopes, self.before) = (own, other, slopes, before);
    }
}

/// One value per joint of a state.
type Part = fn(&mut State) -> &mut Vec<f64>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::flange_placement;
    use crate::simulation::Scenario;
    use crate::twin::Twin;

    /// The flange is a hundredth of a difference's step above the height below which something pushes.
    #[test]
    fn where_a_contact_begins_is_no_slope() {
        let scenario = Scenario::parse("[servo]\ngain = 900\ndamping = 40\n", "test").unwrap();
        let drive = scenario.work_out("test").unwrap().setup.drive;
        let mut twin = Twin { drive, effects: vec!["external_contact".into()], ..Twin::default() };
        let q = [0.0, -0.8, 1.2, 0.3, 0.0, 0.0];
        let height = flange_placement(&twin.robot, &q).translation.z - 1e-8;
        let gate = [("start", 0.0), ("duration", 100.0), ("height", height)];
        let force = [("x", 20.0), ("y", 0.0), ("z", 40.0)];
        let named = |(name, value)| (format!("contact_{name}"), vec![value]);
        twin.values.extend(gate.into_iter().chain(force).map(named));
        let mut plant = Plant::new(&twin, 0.0).unwrap();
        plant.set_state(0.0, &q, &[0.0; 6]);
        let (mut made, mut by) = (Made::new(&plant), ByState::new(6));
        // The one side alone has the jump.
        let mut one = ByState::new(6);
        made.add_derivatives(&mut one, (&AHEAD, false), |m, torque| {
            m.asked_of(&mut plant.arm, torque)
        });
        made.add_asked(&mut plant.arm, false, &mut by);
        assert!(one.q.amax() > 1e6 && by.q.amax() < 1e-6, "{} {}", one.q.amax(), by.q.amax());
    }
}
