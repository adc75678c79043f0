//! How accurate the simulated ground truth is, measured: what docs/accuracy.md is made from.

mod consistency;
mod energy;
mod open_loop;
mod stiction;
mod study;

pub use consistency::{Consistency, consistency};
pub use energy::{Balance, balance};
pub use open_loop::{Deviation, deviations};
pub use stiction::creep;
pub use study::{Costs, Creep, Study};

use super::{PlantError, SimulationError};
use crate::effects::{JointLoad, Mechanism};
use crate::motion::MotionError;
use crate::robot::Robot;

#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    #[error(transparent)]
    Plant(#[from] PlantError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Motion(#[from] MotionError),
}

/// The arm on which accuracy is measured, with friction that depends on the velocity alone.
#[derive(Debug, Clone)]
pub struct Bench {
    pub mechanism: Mechanism,
    pub friction: Friction,
}

/// Share of the UR5-class friction below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    pub dry: f64,
    pub viscous: f64,
}

const ROTOR_INERTIA: [f64; 6] = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14];
const COULOMB: [f64; 6] = [6.0, 7.0, 5.0, 1.5, 1.2, 1.0];
const EXCESS: [f64; 6] = [2.0, 2.5, 1.5, 0.5, 0.4, 0.3];
const VISCOUS: [f64; 6] = [8.0, 10.0, 7.0, 1.5, 1.2, 1.0];
const STRIBECK_RAD_S: f64 = 0.05;

impl Bench {
    /// A UR5-class arm of six joints, which gets rotor inertia.
    pub fn new(robot: Robot, friction: Friction) -> Self {
        let mechanism = Mechanism::with_armature(robot, ROTOR_INERTIA.to_vec());
        Self { mechanism, friction }
    }

    pub fn load(&self, joint: usize, v: f64) -> JointLoad {
        let dry = COULOMB[joint] + EXCESS[joint] * (-(v / STRIBECK_RAD_S).abs()).exp();
        JointLoad {
            dry: self.friction.dry * dry,
            damping: self.friction.viscous * VISCOUS[joint],
            torque: 0.0,
        }
    }

    pub fn loads(&self, v: &[f64], loads: &mut [JointLoad]) {
        for (j, load) in loads.iter_mut().enumerate() {
            *load = self.load(j, v[j]);
        }
    }
}
