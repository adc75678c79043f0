//! The folder of a case, and its truth.

use std::path::Path;

use super::arm::{URDF, position_noise, settled, twin};
use super::hiding::Hiding;
use crate::recording::write_csv;
use crate::simulation::Run;
use crate::trials::asked::Draw;
use crate::trials::case::{CHECK, FIT, ROBOT, TWIN, new_folder, write_settings, write_text};
use crate::trials::drawn::{told, truth};
use crate::trials::plan::Plan;
use crate::trials::{TrialError, Truth, seal, third};

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
        "time_offset_s": hiding.time_offset_s,
    });
    let truth = truth(how, plan, name, effects, setup.robot.dof(), made);
    seal::write_truth(out, &Truth { third: true, ..truth })
}
