//! Cases of an arm of position servos: a command goes in, a position comes out, no torque is recorded.
//!
//! The strength of what is hidden is measured where it is seen, in the position: the arm is simulated with it and
//! without it along the same command.

mod arm;
mod hiding;
mod position;
mod write;

use std::path::Path;

use self::hiding::Hiding;
use super::TrialError;
use super::asked::Draw;
use super::case::case_name;
use super::drawn::{ATTEMPTS, stream};
use super::plan::Plan;

/// Draws a case into its folder, anew where the effect hardly shows or the arm runs away.
///
/// # Errors
/// If a file cannot be written, or the arm cannot be simulated.
pub fn case(how: &Draw, number: usize, plan: &Plan, out: &Path) -> Result<(), TrialError> {
    let name = case_name(number);
    let mut last = None;
    for attempt in 0..ATTEMPTS {
        let mut rng = stream(how.seed, number, attempt);
        let hiding = match Hiding::draw(how, plan, &mut rng, &name) {
            Ok(hiding) => hiding,
            Err(TrialError::Simulation { source, .. }) => {
                last = Some(source);
                continue;
            }
            Err(other) => return Err(other),
        };
        if !hiding.shows() && attempt + 1 < ATTEMPTS {
            continue;
        }
        match hiding.simulate() {
            Ok(runs) => return write::write(how, plan, &name, attempt, &hiding, &runs, out),
            Err(source) => last = Some(source),
        }
    }
    let source = last.unwrap_or(crate::simulation::SimulationError::Stopped { time_s: 0.0 });
    Err(TrialError::Simulation { case: name, source })
}
