//! Both twins moved again along the check recording.

use super::load::Recorded;
use crate::diagnosis::{Diagnosis, SimulationShrink, mend};
use crate::resimulation::{Errors, ResimulationError, WINDOW_S, command, errors};
use crate::simulation::ControllerSettings;
use crate::twin::Twin;

/// Adds what the causes bring in the simulation to `diagnosis`; a note where that cannot be said.
pub fn add(diagnosis: &mut Diagnosis, twin: &Twin, mended: &Twin, check: &Recorded) {
    let before = mend(twin, &diagnosis.fitted_before, &[]);
    let samples = &check.samples;
    let command = match command(&check.recording, samples) {
        Ok(Some(q)) => q,
        Ok(None) => {
            let note = "no command (target_q) is recorded: in the simulation the recorded motion \
                        stands for it";
            diagnosis.notes.push(note.into());
            samples.q.clone()
        }
        Err(error) => return diagnosis.notes.push(format!("not simulated: {error}")),
    };
    let controller = ControllerSettings::default();
    let of = |twin: &Twin| errors(twin, &command, samples, &controller, &mut |_| true);
    let both = match diagnosis.causes.is_empty() {
        true => of(&before).map(|e| (e, e)),
        false => both_ok(rayon::join(|| of(&before), || of(mended))),
    };
    match both {
        Ok((before, after)) => diagnosis.shrink.simulation = Some(shrink(&before, &after)),
        Err(error) => diagnosis.notes.push(format!("not simulated: {error}")),
    }
}

type Result<T> = std::result::Result<T, ResimulationError>;

fn both_ok((before, after): (Result<Errors>, Result<Errors>)) -> Result<(Errors, Errors)> {
    Ok((before?, after?))
}

fn shrink(before: &Errors, after: &Errors) -> SimulationShrink {
    let fraction = match before.position_rad > 0.0 {
        true => 1.0 - (after.position_rad / before.position_rad).powi(2),
        false => 0.0,
    };
    SimulationShrink {
        before_rad: before.position_rad,
        after_rad: after.position_rad,
        fraction,
        torque_before_nm: before.torque_nm,
        torque_after_nm: after.torque_nm,
        open_loop_before_rad: before.open_loop_rad,
        open_loop_after_rad: after.open_loop_rad,
        window_s: WINDOW_S,
    }
}
