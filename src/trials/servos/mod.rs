//! Cases of an arm of position servos: a command goes in, a position comes out, no torque is recorded.
//!
//! The strength of what is hidden is measured where it is seen, in the position: the arm is simulated with it and
//! without it along the same command.

mod arm;
mod hiding;
mod position;
mod write;

use std::path::Path;

use rand_chacha::ChaCha8Rng;

use self::hiding::Hiding;
use super::TrialError;
use super::asked::Draw;
use super::case::case_name;
use super::drawn::attempts;
use super::plan::Plan;

/// Draws a case into its folder, anew where the effect hardly shows or the arm runs away.
///
/// # Errors
/// If a file cannot be written, or the arm cannot be simulated.
pub fn case(how: &Draw, number: usize, plan: &Plan, out: &Path) -> Result<(), TrialError> {
    let name = case_name(number);
    let draw = |rng: &mut ChaCha8Rng| Hiding::draw(how, plan, rng, &name);
    let ran_away = |source| TrialError::Simulation { case: name.clone(), source };
    let runs = |hiding: Hiding| {
        let runs = hiding.simulate().map_err(ran_away)?;
        Ok((hiding, runs))
    };
    let (attempt, (hiding, runs)) = attempts(how, number, draw, Hiding::shows, runs)?;
    write::write(how, plan, &name, attempt, &hiding, &runs, out)
}
