//! The arm of a block, moved once, seen through the sensors once per cell.

use super::grid::Cell;
use super::study::{NO_EFFECT, Question, Study};
use crate::effects;
use crate::recording::Recording;
use crate::simulation::{Experiment, Quantisation, Run, Scenario, Setup, Simulation};
use crate::studies::StudyError;
use crate::studies::recovery::blank_twin;
use crate::studies::strength::scaled;
use crate::twin::Twin;

/// Effects every twin has open.
const KNOWN: [&str; 2] = ["coulomb", "viscous"];

pub struct Bench {
    pub made: Experiment,
    seed: u64,
    runs: Vec<Run>,
    pub simulated_s: f64,
    pub steps: u64,
}

impl Bench {
    /// # Errors
    /// If the scenario does not work out or the arm runs away.
    pub fn new(study: &Study, cell: &Cell) -> Result<Self, StudyError> {
        let made = scenario(study, cell)?.work_out("[arm]")?;
        let mut simulation = Simulation::new(&made.setup)?;
        let mut runs = vec![simulation.run(&made.fit, made.seed, 0, &mut |_| true)?];
        let mut simulated_s = made.fit.duration();
        if study.diagnoses() {
            runs.push(simulation.run(&made.check, made.seed, 1, &mut |_| true)?);
            simulated_s += made.check.duration();
        }
        let steps = (simulated_s / made.setup.clock.step_s) as u64;
        Ok(Self { seed: made.seed, made, runs, simulated_s, steps })
    }

    /// Fit, and check where it was moved for, with the noise and the rounding of `cell`.
    ///
    /// # Errors
    /// If rapier cannot represent the arm.
    pub fn recordings(&self, cell: &Cell) -> Result<Vec<Recording>, StudyError> {
        let mut setup: Setup = self.made.setup.clone();
        if let Some(snr) = cell.snr_db {
            setup.noise.snr_db = Some(snr.db()).filter(|db| db.is_finite());
        }
        let Quantisation { position_rad, velocity_rad_s, current_a } = &mut setup.quantisation;
        for step in [position_rad, velocity_rad_s, current_a] {
            *step *= cell.quantisation;
        }
        let eyes = Simulation::new(&setup)?;
        let seen = |(number, run)| eyes.sensed_again(run, self.seed, number as u64).recording;
        Ok(self.runs.iter().enumerate().map(seen).collect())
    }

    /// s
    pub fn recording_interval(&self) -> f64 {
        let clock = &self.made.setup.clock;
        clock.step_s * clock.steps_per_sample as f64
    }

    /// The arm as its owner knows it: `rotors` known or not, friction open.
    pub fn twin(&self, rotors: bool) -> Twin {
        let mut twin = blank_twin(&self.made);
        if rotors {
            twin.drive.rotor_inertia.clone_from(&self.made.setup.drive.rotor_inertia);
        }
        twin
    }
}

/// `[arm]` at the point of `cell`. Every seed has another motion and other noise. In a study of
/// diagnosis the arm has friction that the twin knows of, and of the other effects the cell's alone.
fn scenario(study: &Study, cell: &Cell) -> Result<Scenario, StudyError> {
    let mut scenario = study.arm.clone();
    scenario.seed = cell.seed;
    scenario.motion.seed = cell.seed;
    scenario.check.clear();
    if study.question == Question::Diagnosis {
        // Fit and check of one seed, none of them another's.
        scenario.motion.seed = cell.seed.wrapping_mul(2);
        let kept =
            |name: &String| KNOWN.contains(&name.as_str()) || cell.effect.as_ref() == Some(name);
        scenario.effects.retain(|name, _| kept(name));
        scenario.beyond_range.retain(kept);
    }
    if let Some(kind) = cell.trajectory {
        scenario.motion.kind = kind;
    }
    if let Some(duration_s) = cell.duration_s {
        scenario.motion.duration_s = duration_s;
    }
    if let Some(rate_hz) = cell.rate_hz {
        scenario.rate_hz = rate_hz;
    }
    match cell.effect.as_deref().filter(|name| *name != NO_EFFECT) {
        None => Ok(scenario),
        Some(name) => {
            let effect = effects::find(name).ok_or_else(|| StudyError::Absent(name.into()))?;
            scaled(effect, &scenario, cell.strength)
        }
    }
}
