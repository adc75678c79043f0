//! Cases made in rapier, their labels sealed.

use std::path::Path;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::asked::{Draw, Family};
use super::case::{CHECK, FIT, TWIN, case_name, new_folder, write_settings, write_text};
use super::drawn::{attempts, told, truth};
use super::hide::Hiding;
use super::nuisance::replace;
use super::plan::{Plan, plans};
use super::third;
use super::{Seals, TrialError, Truth, seal, servos};
use crate::recording::{Recording, write_csv};
use crate::simulation::{Command, Run, Simulation, SimulationError};
use crate::twin::Twin;

/// Draws all cases into `out` in parallel and seals them; `done` is told of each.
///
/// # Errors
/// If a file cannot be written, or an arm cannot be simulated.
pub fn draw(how: &Draw, out: &Path, done: &(dyn Fn() + Sync)) -> Result<Seals, TrialError> {
    let plans = plans(how.cases, &how.only, how.family, &mut ChaCha8Rng::seed_from_u64(how.seed))?;
    seal::make_folder(out)?;
    plans.par_iter().enumerate().try_for_each(|(number, plan)| {
        match how.family {
            Family::Servos => servos::case(how, number, plan, out)?,
            Family::Standard | Family::Nuisance => case(how, number, plan, out)?,
        }
        done();
        Ok::<_, TrialError>(())
    })?;
    let family = match how.family {
        Family::Standard => String::new(),
        other => format!(" --{}", other.name()),
    };
    let made = format!(
        "`armtwin trial draw --cases {} --seed {} --duration {}{family}`, armtwin {}",
        how.cases,
        how.seed,
        how.duration_s,
        env!("CARGO_PKG_VERSION")
    );
    seal::seal(out, made)
}

fn case(how: &Draw, number: usize, plan: &Plan, out: &Path) -> Result<(), TrialError> {
    let name = case_name(number);
    let draw = |rng: &mut ChaCha8Rng| Hiding::draw(how, plan, rng, &name);
    let ran_away = |source| TrialError::Simulation { case: name.clone(), source };
    let runs = |hiding| simulate(hiding).map_err(ran_away);
    let (attempt, (hiding, runs)) = attempts(how, number, draw, Hiding::shows, runs)?;
    write(how, plan, &name, attempt, &hiding, &runs, out)
}

/// Fit, check and third recording; the strength put right once where the plan was far off.
fn simulate(mut hiding: Hiding) -> Result<(Hiding, [Run; 3]), SimulationError> {
    let mut simulation = Simulation::new(&hiding.made.setup)?;
    let mut fit = follow(&mut simulation, &hiding, &hiding.made.fit, 0)?;
    hiding.measure(&fit);
    if hiding.correct() {
        simulation = Simulation::new(&hiding.made.setup)?;
        fit = follow(&mut simulation, &hiding, &hiding.made.fit, 0)?;
        hiding.measure(&fit);
    }
    let check = follow(&mut simulation, &hiding, &hiding.made.check, 1)?;
    let third = follow(&mut simulation, &hiding, &hiding.third, 2)?;
    Ok((hiding, [fit, check, third]))
}

fn follow(
    simulation: &mut Simulation,
    hiding: &Hiding,
    command: &dyn Command,
    number: u64,
) -> Result<Run, SimulationError> {
    simulation.run(command, hiding.made.seed, number, &mut |_| true)
}

fn write(
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
    for (run, file, number) in [(fit, FIT, 0), (check, CHECK, 1)] {
        write_csv(&shown(run, hiding, number), &folder.join(file))?;
    }
    let setup = &hiding.made.setup;
    let twin = Twin { drive: setup.drive.clone(), ..Twin::default() };
    write_text(&folder.join(TWIN), &twin.to_toml())?;
    write_settings(&folder, &told(how, plan))?;
    third::write(hiding.third_recording(third), out, name)?;
    let effects = hiding.effects.iter().map(|e| (&e.injection, &e.strength));
    let made = serde_json::json!({
        "draw": how,
        "attempt": attempt,
        "scenario": hiding.scenario,
        "nuisance": hiding.nuisance,
    });
    let truth = truth(how, plan, name, effects, setup.robot.dof(), made);
    seal::write_truth(out, &Truth { noise_nm: hiding.noise(fit), third: true, ..truth })
}

/// Channels a controller's log has; what the twin can work out itself is left away.
fn shown(run: &Run, hiding: &Hiding, number: u64) -> Recording {
    let mut recording = run.recording.clone();
    let known = ["target_current", "target_moment"];
    recording.channels.retain(|c| !known.iter().any(|k| c.name.starts_with(k)));
    if let Some(nuisance) = &hiding.nuisance {
        let dt = run.recording.time[1] - run.recording.time[0];
        let mut rng = ChaCha8Rng::seed_from_u64(hiding.made.seed);
        rng.set_stream((1 << 40) + number);
        let current = nuisance.record_current(run, &hiding.made.setup, dt, &mut rng);
        replace(&mut recording, "actual_current", &current);
    }
    for channel in &mut recording.channels {
        let steps = if channel.name.starts_with("joint_temp") { 10.0 } else { 1e7 };
        channel.values.iter_mut().for_each(|x| *x = (*x * steps).round() / steps);
    }
    recording
}
