//! The arm in rapier with an effect, pushed without feedback and stepped as a simulation does.

use super::*;
use crate::robot::{Workspace, inverse_dynamics};

pub struct Driven {
    pub mechanism: Mechanism,
    pub plant: Plant,
    injections: Injections,
    workspace: Workspace,
    temperature: [f64; 6],
    transmitted: [f64; 6],
    /// Share of the usual push that drives the arm.
    share: f64,
    steps: usize,
}

/// The arm at one instant: positions (rad), velocities (rad/s) and torques (N.m) that satisfy the
/// equation of motion together.
pub struct Instant {
    pub tau: [f64; 6],
    pub q: [f64; 6],
    pub v: [f64; 6],
    pub link_q: [f64; 6],
    pub link_v: [f64; 6],
    pub loads: [JointLoad; 6],
}

impl Driven {
    pub fn new(effect: Option<&'static dyn Effect>, step_s: f64) -> Self {
        Self::pushed(1.0, effect, step_s)
    }

    /// The arm driven by a `share` of the usual push.
    pub fn pushed(share: f64, effect: Option<&'static dyn Effect>, step_s: f64) -> Self {
        let (mechanism, injections) = injected(effect);
        let mut plant = Plant::new(&mechanism, step_s).unwrap();
        plant.set_state(&HANGING, &STILL);
        let workspace = Workspace::new(&mechanism.robot);
        let (temperature, transmitted) = ([THERMAL.start_c; 6], STILL);
        Self { mechanism, plant, injections, workspace, temperature, transmitted, share, steps: 0 }
    }

    /// Moves on by one step, from the instant that is returned.
    pub fn step(&mut self) -> Instant {
        let h = self.plant.step_s();
        let time = self.steps as f64 * h;
        let tau = push(time).map(|tau| self.share * tau);
        let [q, v, a] = [self.plant.q(), self.plant.v(), self.plant.a()].map(joints);
        let [link_q, link_before, _] = self.plant.link_motion().map(joints);
        let qd: [f64; 6] = std::array::from_fn(|j| v[j] + 0.5 * h * a[j]);
        let robot = &self.mechanism.robot;
        let (transmitted, temperature) = (&self.transmitted, &self.temperature);
        let state = ArmState { robot, time, dt: h, q: &q, qd: &qd, transmitted, temperature };
        let mut loads = [JointLoad::default(); 6];
        self.injections.loads(&state, &mut loads);
        add_friction(&mut loads);
        THERMAL.advance(&mut self.temperature, &loads, &qd, h);
        self.plant.step(&tau, &loads);
        let [ql, vl, al] = self.plant.link_motion();
        inverse_dynamics(robot, &mut self.workspace, ql, vl, al, &mut self.transmitted);
        let link_v = std::array::from_fn(|j| 0.5 * (link_before[j] + vl[j]));
        self.steps += 1;
        Instant { tau, q, v: joints(self.plant.v_mid()), link_q, link_v, loads }
    }
}

fn joints(all: &[f64]) -> [f64; 6] {
    std::array::from_fn(|j| all[j])
}
