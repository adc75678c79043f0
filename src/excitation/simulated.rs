//! A designed motion in the project's simulation, before anybody may have it.

use super::limits::{Held, Limits};
use crate::simulation::{Experiment, Simulation, SimulationError};

/// What the simulated arm makes of the limits.
pub fn simulated(made: &Experiment, limits: &Limits<'_>) -> Result<Held, SimulationError> {
    let mut simulation = Simulation::new(&made.setup)?;
    let run = simulation.run(&made.fit, made.seed, 0, &mut |_| true)?;
    Ok(limits.held_by(&run.exact.q, &run.exact.qd, &run.exact.tau))
}
