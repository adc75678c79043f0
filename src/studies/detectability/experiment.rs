//! One effect at one strength: simulated once, recorded with many seeds.

use super::StudyError;
use super::regression::{Known, Side, Trial, compare};
use crate::effects::{Effect, Seen};
use crate::signals::{Conditioning, Derivatives, condition};
use crate::simulation::{Experiment, Injection, Run, Simulation};
use crate::twin::Twin;

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
    pub(super) fn new(effect: &'static dyn Effect, made: &Experiment) -> Result<Self, StudyError> {
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
    pub(super) fn trial(&self, seed: u64) -> Result<Trial, StudyError> {
        let [fit, check] = [0, 1].map(|number| self.side(seed, number));
        Ok(compare(&fit?, &check?))
    }

    fn side(&self, seed: u64, number: usize) -> Result<Side, StudyError> {
        let run = self.simulation.sensed_again(&self.runs[number], seed, number as u64);
        let drive = &self.known.twin.drive;
        let samples = condition(&run.recording, drive, self.known.twin.robot.dof(), &self.how)?;
        let ampere = |(j, a): (usize, &f64)| a * drive.torque_per_ampere(j);
        let noise: Vec<f64> = run.current_noise_a.iter().enumerate().map(ampere).collect();
        Ok(self.known.side(&samples, &noise)?)
    }
}
