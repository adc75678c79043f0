//! The folder of a case, and its truth.

use std::path::Path;

use super::arm::{URDF, position_noise};
use super::hiding::Hiding;
use crate::recording::write_csv;
use crate::simulation::{Run, Setup};
use crate::trials::asked::Draw;
use crate::trials::case::{CHECK, FIT, ROBOT, TWIN, new_folder, write_settings, write_text};
use crate::trials::drawn::{told, truth};
use crate::trials::plan::Plan;
use crate::trials::{TrialError, Truth, seal, third};
use crate::twin::Twin;

/// A simulation begins where its command does, and the arm sags from there to where its servos hold it, s.
const SETTLED_S: f64 = 0.3;

/// What the owner of the arm knows. Servos that look at their error now and then are late by half that time.
fn twin(setup: &Setup) -> Twin {
    let mut drive = setup.drive.clone();
    if let Some(servo) = &mut drive.servo {
        servo.delay.iter_mut().for_each(|d| *d += 0.5 / setup.controller.rate_hz);
    }
    Twin { source: ROBOT.into(), robot: setup.robot.clone(), drive, ..Twin::default() }
}

pub fn write(
    how: &Draw,
    plan: &Plan,
    name: &str,
    attempt: u64,
    hiding: &Hiding,
    [fit, check, third]: &[Run; 3],
    out: &Path,
) -> Result<(), TrialError> {
    let folder = out.join(name);
    new_folder(&folder)?;
    let settled = |run: &Run| run.recording.between(Some(SETTLED_S), None);
    for (run, file) in [(fit, FIT), (check, CHECK)] {
        write_csv(&settled(run), &folder.join(file))?;
    }
    third::write(settled(third), out, name)?;
    write_text(&folder.join(ROBOT), URDF)?;
    let setup = &hiding.made.setup;
    write_text(&folder.join(TWIN), &twin(setup).to_toml())?;
    write_settings(&folder, &told(how, plan))?;
    let effects = hiding.effects.iter().map(|e| (&e.injection, &e.strength));
    let made = serde_json::json!({
        "draw": how,
        "attempt": attempt,
        "scenario": hiding.scenario,
        "position_noise_rad": position_noise(),
    });
    let truth = truth(how, plan, name, effects, setup.robot.dof(), made);
    seal::write_truth(out, &Truth { third: true, ..truth })
}
