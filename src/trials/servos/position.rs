//! How much of an effect can be seen: what it changes in the position, over the position's noise.

use super::arm::position_noise;
use crate::regression::qr::{Qr, unexplained};
use crate::series::JointSeries;
use crate::simulation::{Experiment, Setup, Simulation, SimulationError};
use crate::trials::Strength;
use crate::trials::strength::rms;

/// Friction that an answerer fits, and by how much it is varied to see what it does.
const FITTED: [&str; 2] = ["coulomb", "viscous"];
const VARIED_BY: f64 = 0.1;

/// Positions of the arm along its fit motion without what is hidden, and what more friction changes in them.
pub struct Plain {
    q: JointSeries,
    by_friction: Vec<JointSeries>,
}

impl Plain {
    /// # Errors
    /// If the arm runs away.
    pub fn new(made: &Experiment) -> Result<Self, SimulationError> {
        let q = positions(&made.setup, made)?;
        let varied = |name: &&str| {
            let mut setup = made.setup.clone();
            let own = setup.effects.iter_mut().filter(|i| i.effect.about().name == *name);
            own.flat_map(|i| &mut i.values).for_each(|row| row[0] *= 1.0 + VARIED_BY);
            Ok::<_, SimulationError>(difference(&positions(&setup, made)?, &q))
        };
        let by_friction = FITTED.iter().map(varied).collect::<Result<_, _>>()?;
        Ok(Self { q, by_friction })
    }

    /// Strength of what changes the arm to `setup`.
    ///
    /// # Errors
    /// If the arm runs away.
    pub fn strength(&self, setup: &Setup, made: &Experiment) -> Result<Strength, SimulationError> {
        let own = difference(&positions(setup, made)?, &self.q);
        let per_joint = |of: &dyn Fn(usize, &[f64]) -> f64| {
            (0..own.joints()).map(|j| of(j, own.joint(j)) / position_noise()).collect()
        };
        let gap = |j: usize, own: &[f64]| {
            let columns = self.by_friction.iter().map(|s| s.joint(j).to_vec()).collect();
            rms(&unexplained(&Qr::new(columns).q, own.to_vec()))
        };
        Ok(Strength { drawn: None, own: per_joint(&|_, own| rms(own)), gap: per_joint(&gap) })
    }
}

/// rad, as encoders without noise and steps would show them.
fn positions(setup: &Setup, made: &Experiment) -> Result<JointSeries, SimulationError> {
    let run = Simulation::new(setup)?.run(&made.fit, made.seed, 0, &mut |_| true)?;
    Ok(run.shown.q)
}

fn difference(a: &JointSeries, b: &JointSeries) -> JointSeries {
    a.map_joints(|j, a| a.iter().zip(b.joint(j)).map(|(a, b)| a - b).collect())
}
