//! One effect at one strength: simulated once, recorded with many seeds.

use super::regression::{Known, Side, Trial, compare};
use super::{DetectabilityError, Settings};
use crate::effects::{Effect, Role, Seen};
use crate::signals::{Conditioning, Derivatives, condition};
use crate::simulation::{Experiment, Injection, Run, Scenario, Simulation};
use crate::twin::{PerJoint, Twin};

/// The scenario with everything that is linear in `effect`, or the whole of a delay or lag, times
/// `strength`; references follow.
pub(super) fn scaled(
    effect: &dyn Effect,
    scenario: &Scenario,
    strength: f64,
    settings: &Settings,
) -> Result<Scenario, DetectabilityError> {
    let name = effect.about().name;
    let mut scenario = scenario.clone();
    scenario.shorten(settings.duration_s);
    scenario.noise.snr_db = Some(settings.snr_db);
    let table = scenario.effects.get_mut(name);
    let table = table.ok_or_else(|| DetectabilityError::Absent(name.into()))?;
    for p in effect.about().parameters {
        if p.is_reference() {
            table.remove(p.name);
        } else if p.role == Role::Linear || effect.seen() == Seen::Channels {
            table.entry(p.name.into()).and_modify(|value| *value = times(value, strength));
        }
    }
    if !scenario.beyond_range.iter().any(|b| b == name) {
        scenario.beyond_range.push(name.into());
    }
    Ok(scenario)
}

fn times(value: &PerJoint, factor: f64) -> PerJoint {
    match value {
        PerJoint::All(x) => PerJoint::All(factor * x),
        PerJoint::Each(all) => PerJoint::Each(all.iter().map(|x| factor * x).collect()),
    }
}

/// Lags show in the recorded velocity alone.
pub(super) fn conditioning(effect: &dyn Effect) -> Conditioning {
    let derivatives = match effect.seen() {
        Seen::Channels => Derivatives::Recorded,
        _ => Derivatives::Position,
    };
    Conditioning { derivatives, ..Conditioning::default() }
}

/// The arm with the effect, moved along both trajectories.
pub(super) struct Bench {
    simulation: Simulation,
    runs: [Run; 2],
    known: Known,
    how: Conditioning,
}

impl Bench {
    pub(super) fn new(
        effect: &'static dyn Effect,
        made: &Experiment,
    ) -> Result<Self, DetectabilityError> {
        let mut simulation = Simulation::new(&made.setup)?;
        let fit = simulation.run(&made.fit, made.seed, 0, &mut |_| true)?;
        let check = simulation.run(&made.check, made.seed, 1, &mut |_| true)?;
        let ours = |i: &&Injection| i.effect.about().name == effect.about().name;
        let (sought, fitted) = made.setup.effects.iter().cloned().partition(|i| ours(&i));
        let twin = Twin {
            robot: made.setup.robot.clone(),
            drive: made.setup.drive.clone(),
            effects: Vec::new(),
            ..Twin::default()
        };
        let how = conditioning(effect);
        Ok(Self { simulation, runs: [fit, check], known: Known { twin, fitted, sought }, how })
    }

    /// Both recordings with the noise of `seed`: fitted on the first, held against the second.
    pub(super) fn trial(&self, seed: u64) -> Result<Trial, DetectabilityError> {
        let [fit, check] = [0, 1].map(|number| self.side(seed, number));
        Ok(compare(&fit?, &check?))
    }

    fn side(&self, seed: u64, number: usize) -> Result<Side, DetectabilityError> {
        let run = self.simulation.sensed_again(&self.runs[number], seed, number as u64);
        let drive = &self.known.twin.drive;
        let samples = condition(&run.recording, drive, self.known.twin.robot.dof(), &self.how)?;
        let ampere = |(j, a): (usize, &f64)| a * drive.torque_per_ampere(j);
        let noise: Vec<f64> = run.current_noise_a.iter().enumerate().map(ampere).collect();
        Ok(self.known.side(&samples, &noise)?)
    }
}
