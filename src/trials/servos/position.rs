//! How much of an effect can be seen: what it changes in the position, over the position's noise.
//!
//! What other friction would change as well cannot be seen: a servo that does nothing about small errors lags as one with more
//! friction does, where no weight hangs on its joint. So friction is fitted by simulation, as an answerer does.

use super::arm::{position_noise, settled, twin};
use crate::diagnosis::conditioning;
use crate::recording::Recording;
use crate::series::JointSeries;
use crate::servo::{ServoError, Track, open_fitted, replay};
use crate::signals::condition;
use crate::simulation::{Experiment, Noise, Quantisation, Setup, Simulation};
use crate::trials::strength::rms;
use crate::trials::{Strength, TrialError};
use crate::twin::Twin;

/// Positions of the arm along its fit motion without what is hidden, as encoders without noise and steps would show them.
pub struct Plain {
    case: String,
    twin: Twin,
    seen: Seen,
}

/// Positions, and what a twin with friction fitted to them is off, rad.
struct Seen {
    q: JointSeries,
    left: JointSeries,
}

impl Plain {
    /// # Errors
    /// If the arm runs away.
    pub fn new(case: &str, made: &Experiment) -> Result<Self, TrialError> {
        let twin = twin(&made.setup);
        let seen = Seen::new(&twin, &run(case, &made.setup, made)?)?;
        Ok(Self { case: case.into(), twin, seen })
    }

    /// Strength of what changes the arm to `setup`.
    ///
    /// # Errors
    /// If the arm runs away.
    pub fn strength(&self, setup: &Setup, made: &Experiment) -> Result<Strength, TrialError> {
        let seen = Seen::new(&self.twin, &run(&self.case, setup, made)?)?;
        let own = over_noise(&seen.q, &self.seen.q);
        Ok(Strength { drawn: None, own, gap: over_noise(&seen.left, &self.seen.left) })
    }
}

impl Seen {
    fn new(twin: &Twin, recording: &Recording) -> Result<Self, TrialError> {
        let dof = twin.robot.dof();
        let samples = condition(recording, &twin.drive, dof, &conditioning(recording, dof))?;
        let track = Track::new(&samples, twin)?;
        let follows = |twin: &Twin| replay(twin, &track, &track.stretches(f64::INFINITY));
        let simulated = match open_fitted(twin, &track, &()).and_then(|fitted| follows(&fitted)) {
            // No friction takes that up.
            Err(ServoError::Diverged { .. }) => follows(twin),
            fitted => fitted,
        }?;
        Ok(Self { left: difference(&simulated, &track.q), q: track.q })
    }
}

fn run(case: &str, setup: &Setup, made: &Experiment) -> Result<Recording, TrialError> {
    let ran_away = |source| TrialError::Simulation { case: case.into(), source };
    let sharp = sharp(setup);
    let mut simulation = Simulation::new(&sharp).map_err(ran_away)?;
    let run = simulation.run(&made.fit, made.seed, 0, &mut |_| true).map_err(ran_away)?;
    Ok(settled(&run))
}

/// With encoders without noise and steps.
pub fn sharp(setup: &Setup) -> Setup {
    Setup { noise: Noise::default(), quantisation: Quantisation::default(), ..setup.clone() }
}

/// Root mean square of a difference, joint by joint, over the noise of positions.
fn over_noise(a: &JointSeries, b: &JointSeries) -> Vec<f64> {
    let differ = difference(a, b);
    (0..differ.joints()).map(|j| rms(differ.joint(j)) / position_noise()).collect()
}

fn difference(a: &JointSeries, b: &JointSeries) -> JointSeries {
    a.map_joints(|j, a| a.iter().zip(b.joint(j)).map(|(a, b)| a - b).collect())
}
