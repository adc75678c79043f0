//! What a residual is made of, as a model that switches.
//!
//! At every step and joint r = s u - (J^T F) + v: u, of unit variance, is what the twin leaves
//! without a contact (an Ornstein-Uhlenbeck process that stays about `Noise::lasting_s`, scaled by s
//! to N.m), F the force on the arm at a place (three such processes, in base axes, that stay about
//! `Criteria::force_s`; none where nothing touches), v white.

use nalgebra::DVector;

use super::Criteria;
use super::kalman::Belief;
use super::left::Friction;
use super::places::Levers;

/// Place that is touched, by its index; `None` where nothing touches.
pub type Mode = Option<usize>;

/// Components of a force.
pub const AXES: usize = 3;

/// A residual on the steps of the filter. Rows hold one value per joint, one row per step.
#[derive(Debug, Clone)]
pub struct Steps {
    /// s
    pub dt: f64,
    pub joints: usize,
    /// Residual torque less its level, N.m.
    pub residual: Vec<Vec<f64>>,
    /// Standard deviation of what the twin leaves there, N.m.
    pub spread: Vec<Vec<f64>>,
    pub friction: Vec<Vec<Friction>>,
    /// Variance of what is new at every step, (N.m)^2.
    pub white: Vec<Vec<f64>>,
    /// What is left of u after one step.
    pub kept: Vec<Vec<f64>>,
    /// Levers by place, then by step.
    pub levers: Vec<Vec<Levers>>,
    /// Standard deviation of every component of a force, N.
    pub force_n: f64,
    /// What is left of a force after one step.
    pub force_kept: f64,
    /// Most that is left of u after one step where friction holds, while something touches.
    pub yielding: f64,
}

impl Steps {
    pub fn len(&self) -> usize {
        self.residual.len()
    }

    pub fn states(&self) -> usize {
        self.joints + AXES
    }

    /// Before the first step: nothing touches.
    pub fn start(&self) -> Belief {
        let variance: Vec<f64> =
            (0..self.states()).map(|i| f64::from(u8::from(i < self.joints))).collect();
        Belief::new(&variance)
    }

    /// Decay and growth of all states from step `k - 1` to `k` where `mode` holds at `k`.
    ///
    /// A joint that comes to rest or leaves it has another friction than before. While something
    /// touches, friction that holds a joint gives way.
    pub fn transition(&self, k: usize, mode: Mode) -> (Vec<f64>, Vec<f64>) {
        let same = |j: usize| k == 0 || self.friction[k - 1][j].goes_on_as(self.friction[k][j]);
        let kept = |j: usize| match (same(j), mode) {
            (false, _) => 0.0,
            (true, Some(_)) if self.friction[k][j].holds() => self.kept[k][j].min(self.yielding),
            _ => self.kept[k][j],
        };
        let mut decay: Vec<f64> = (0..self.joints).map(kept).collect();
        let mut grow: Vec<f64> = decay.iter().map(|a| 1.0 - a * a).collect();
        let touched = f64::from(u8::from(mode.is_some()));
        let force = touched * self.force_n.powi(2) * (1.0 - self.force_kept.powi(2));
        decay.extend([touched * self.force_kept; AXES]);
        grow.extend([force; AXES]);
        (decay, grow)
    }

    /// What joint `j` measures of the states at step `k`.
    pub fn measures(&self, k: usize, j: usize, mode: Mode) -> DVector<f64> {
        let mut h = DVector::zeros(self.states());
        h[j] = self.spread[k][j];
        if let Some(place) = mode {
            let lever = &self.levers[place][k][j];
            (0..AXES).for_each(|axis| h[self.joints + axis] = -lever[axis]);
        }
        h
    }

    /// One step on, all joints heard; the log-likelihood of what they say.
    pub fn step(&self, belief: &mut Belief, k: usize, mode: Mode) -> f64 {
        let (decay, grow) = self.transition(k, mode);
        belief.predict(&decay, &grow);
        self.hear(belief, k, mode)
    }

    pub fn hear(&self, belief: &mut Belief, k: usize, mode: Mode) -> f64 {
        let one = |j: usize| {
            belief.update(&self.measures(k, j, mode), self.residual[k][j], self.white[k][j])
        };
        (0..self.joints).map(one).sum()
    }
}

/// Log-probabilities per step that a contact begins at a given place, that none begins, that one
/// ends, that it goes on.
#[derive(Debug, Clone, Copy)]
pub struct Switching {
    pub begins: f64,
    pub none: f64,
    pub ends: f64,
    pub goes_on: f64,
}

impl Switching {
    pub fn new(criteria: &Criteria, dt: f64, places: usize) -> Self {
        let (begins, ends) = ((dt / criteria.apart_s).min(0.5), (dt / criteria.lasts_s).min(0.5));
        Self {
            begins: (begins / places.max(1) as f64).ln(),
            none: (1.0 - begins).ln(),
            ends: ends.ln(),
            goes_on: (1.0 - ends).ln(),
        }
    }

    /// Log-odds of a contact at a given place that lasts so many steps, over none in that time.
    pub fn contact(&self, steps: usize) -> f64 {
        let on = steps.saturating_sub(1) as f64;
        self.begins + self.ends + on * self.goes_on - (on + 2.0) * self.none
    }
}
