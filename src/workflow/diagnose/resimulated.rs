//! Both twins moved again along the check recording.

use crate::diagnosis::{Diagnosis, SimulationShrink, mend};
use crate::follow::{Interrupted, Watch};
use crate::recording::Recording;
use crate::resimulation::{
    Errors, Replayed, ResimulationError, WINDOW_S, closed_loop, command, errors,
};
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::simulation::{ControllerSettings, Glimpse};
use crate::twin::Twin;

/// Adds what the causes bring in the simulation to `diagnosis`; a note where that cannot be said.
/// Positions, rad, of the twin as given and, where causes are named, of the mended one.
///
/// # Errors
/// If `watch` ends it.
pub fn add(
    diagnosis: &mut Diagnosis,
    [twin, mended]: [&Twin; 2],
    recording: &Recording,
    samples: &Samples,
    watch: &dyn Watch,
) -> Result<Vec<JointSeries>, Interrupted> {
    let before = mend(twin, &diagnosis.fitted_before, &[]);
    let command = match command(recording, samples) {
        Ok(Some(q)) => q,
        Ok(None) => {
            let note = "no command (target_q) is recorded: in the simulation the recorded motion \
                        stands for it";
            diagnosis.notes.push(note.into());
            samples.q.clone()
        }
        Err(error) => return Ok(not_simulated(diagnosis, &error)),
    };
    let controller = ControllerSettings::default();
    let whole = (1000.0 * samples.dt * samples.len() as f64) as u64;
    let of = |twin: &Twin| -> Result<(Errors, Replayed), ResimulationError> {
        let mut follow = |seen: &Glimpse<'_>| {
            watch.tell("simulating", (1000.0 * seen.time_s) as u64, whole);
            !watch.stops()
        };
        let replayed = closed_loop(twin, &command, samples, &controller, &mut follow)?;
        Ok((errors(twin, &replayed, samples)?, replayed))
    };
    let (before, after) = match diagnosis.causes.is_empty() {
        true => (of(&before), None),
        false => {
            let (before, after) = rayon::join(|| of(&before), || of(mended));
            (before, Some(after))
        }
    };
    if watch.stops() {
        return Err(Interrupted);
    }
    Ok(match (before, after.transpose()) {
        (Ok((before, moved)), Ok(after)) => {
            let (after, mended) = after.unzip();
            let after = after.unwrap_or(before);
            diagnosis.shrink.simulation = Some(shrink(&before, &after));
            std::iter::once(moved).chain(mended).map(|r| r.q).collect()
        }
        (Err(error), _) | (_, Err(error)) => not_simulated(diagnosis, &error),
    })
}

fn not_simulated(diagnosis: &mut Diagnosis, error: &ResimulationError) -> Vec<JointSeries> {
    diagnosis.notes.push(format!("not simulated: {error}"));
    Vec::new()
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
