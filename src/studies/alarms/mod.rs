//! How often watching cries wolf, how soon it notices, and whether it names what changed.
//!
//! Hours of work are made cheaply: every motion is simulated once in rapier and taken through sensors and
//! conditioning [`PASSES`] times with position and velocity noise of their own; each time the arm does it
//! again, one of these is drawn, and fresh noise is added to the torque, sample by sample. The detector sees
//! what it would see of the recordings themselves, because torque is not filtered on the way to it. The twin
//! is fitted on a recording of its own, as a user's is.

mod work;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Serialize;

use self::work::Work;
use super::StudyError;
use super::strength::scaled;
use crate::diagnosis::Settings as Diagnosing;
use crate::effects::Effect;
use crate::simulation::Scenario;
use crate::twin::Twin;
use crate::watch::{Alarm, Detector, Stretch, answer, usual};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Work without a change, h.
    pub hours: f64,
    /// Stated mean times between false alarms, h; all are held against the same work.
    pub every_h: Vec<f64>,
    /// Length of each of the two motions, s.
    pub motion_s: f64,
    pub strengths: Vec<f64>,
    /// Work before an effect is switched on, and longest wait for an alarm, s.
    pub before_s: f64,
    pub wait_s: f64,
    /// Draws of noise per effect and strength.
    pub draws: u64,
    /// With which the delays are measured: the usual one of `watch`, h.
    pub delays_every_h: f64,
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            hours: 100.0,
            every_h: vec![1.0, 10.0, 168.0],
            motion_s: 60.0,
            strengths: vec![1.0, 2.0],
            before_s: 900.0,
            wait_s: 1800.0,
            draws: 10,
            delays_every_h: 168.0,
            seed: 1,
        }
    }
}

/// Passes of a motion whose position and velocity noise differ.
pub const PASSES: u64 = 16;

/// What work without a change came to.
#[derive(Debug, Clone, Serialize)]
pub struct Quiet {
    pub stated_every_h: f64,
    pub limit: f64,
    pub alarms: usize,
    pub hours: f64,
    /// Mean over the joints of the share of the time in which they slide: charts advance then.
    pub sliding: f64,
}

impl Quiet {
    /// Alarms that are stated for so much motion.
    pub fn expected(&self) -> f64 {
        self.hours * self.sliding / self.stated_every_h
    }
}

/// What came of an effect that was switched on.
#[derive(Debug, Clone, Serialize)]
pub struct Noticed {
    pub effect: String,
    pub strength: f64,
    /// Root mean square of what it adds to the gap, in multiples of the noise, at the joint where that is most.
    pub over_noise: f64,
    /// Draw by draw, s; `None` where it was not noticed in time.
    pub delays_s: Vec<Option<f64>>,
    /// Causes named by the diagnosis of a minute after it, the strongest first, with what looks the same.
    pub named: Vec<String>,
    pub equivalent: Vec<String>,
    pub says: String,
}

impl Noticed {
    /// How well it was named.
    pub fn verdict(&self) -> &'static str {
        let is = |name: &String| *name == self.effect;
        match (&self.named[..], &self.equivalent[..]) {
            ([], _) => "nothing named",
            ([first, ..], _) if is(first) => "named first",
            (_, same) if same.iter().any(is) => "as its equal",
            (named, _) if named.iter().any(is) => "among others",
            _ => "another name",
        }
    }
}

/// An arm without the effects that are switched on, and its twin.
pub struct Base {
    twin: Twin,
    /// The twin with what it lacks of that arm, if anything.
    usual: Twin,
    work: Work,
}

impl Base {
    /// # Errors
    /// If the scenario does not work out.
    pub fn new(scenario: &Scenario, file: &str, settings: &Settings) -> Result<Self, StudyError> {
        let twin = work::twin(scenario, file, settings)?;
        let work = Work::new(scenario, file, &twin, settings)?;
        let usual = usual(&twin, &work.recording, &Diagnosing::default());
        Ok(Self { twin, usual, work })
    }

    /// False alarms of all limits over the same work. `watch` returns false to stop.
    pub fn quiet(&self, settings: &Settings, watch: &(dyn Fn(f64) -> bool + Sync)) -> Vec<Quiet> {
        let (work, sliding) = (&self.work, self.work.sliding());
        let one = |every_h: &f64| -> Quiet {
            let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
            let mut detector = Detector::new(work.joints(), 3600.0 * every_h);
            let (mut alarms, mut time) = (0, 0.0);
            while time < 3600.0 * settings.hours && watch(time) {
                let stretch = work.next(time, &mut rng);
                time += work.length_s();
                alarms += usize::from(detector.add(&stretch).is_some());
            }
            let limit = detector.expected().limit;
            Quiet { stated_every_h: *every_h, limit, alarms, hours: time / 3600.0, sliding }
        };
        settings.every_h.par_iter().map(one).collect()
    }

    /// What comes of switching `effect` on, at `strength` times what `scenario` has of it.
    ///
    /// # Errors
    /// If the scenario does not work out.
    pub fn noticed(
        &self,
        effect: &'static dyn Effect,
        (scenario, file): (&Scenario, &str),
        strength: f64,
        settings: &Settings,
    ) -> Result<Noticed, StudyError> {
        let changed = scaled(effect, scenario, strength)?;
        let after = Work::new(&changed, file, &self.twin, settings)?;
        let draw = |draw| notice(&self.work, &after, settings, draw);
        let delays: Vec<Option<Alarm>> = (0..settings.draws).map(draw).collect();
        let nowhere = Alarm { joint: 0, feature: 0, more: true, since: 0.0, noticed: 0.0 };
        let alarm = delays.first().copied().flatten().unwrap_or(nowhere);
        let told = answer(&self.usual, &after.recording, alarm, &Diagnosing::default())?;
        let equivalent = told.causes.first().map_or(&[][..], |c| &c.equivalent);
        Ok(Noticed {
            effect: effect.about().name.into(),
            strength,
            over_noise: after.over_noise(&self.work),
            delays_s: delays.iter().map(|a| a.map(|a| a.noticed - settings.before_s)).collect(),
            named: told.causes.iter().map(|c| c.effect.clone()).collect(),
            equivalent: equivalent.iter().map(|e| e.effect.clone()).collect(),
            says: told.says,
        })
    }
}

/// The first alarm after the change; those before it are false ones, which [`Base::quiet`] counts.
fn notice(before: &Work, after: &Work, settings: &Settings, draw: u64) -> Option<Alarm> {
    let mut rng = ChaCha8Rng::seed_from_u64(settings.seed + 1000 * (draw + 1));
    let every_s = 3600.0 * settings.delays_every_h;
    let mut detector = Detector::new(before.joints(), every_s);
    let mut time = 0.0;
    while time < settings.before_s + settings.wait_s {
        let work = if time < settings.before_s { before } else { after };
        let stretch = work.next(time, &mut rng);
        time += work.length_s();
        let alarm = detector.add(&stretch);
        if let Some(alarm) = alarm.filter(|a| a.noticed >= settings.before_s) {
            return Some(alarm);
        }
    }
    None
}

/// Passes of all motions, ready to be drawn from.
fn drawn<'w>(all: &'w [Vec<Stretch>], turn: usize, rng: &mut ChaCha8Rng) -> &'w Stretch {
    use rand::RngExt;
    let passes = &all[turn % all.len()];
    &passes[rng.random_range(0..passes.len())]
}

/// The twin that a scenario's owner has: the drive, and friction to be fitted.
fn bare(scenario: &Scenario, file: &str) -> Result<Twin, StudyError> {
    let made = scenario.work_out(file)?;
    let effects = vec!["coulomb".to_string(), "viscous".into()];
    Ok(Twin {
        source: scenario.robot.clone(),
        robot: made.setup.robot,
        drive: made.setup.drive,
        effects,
        ..Twin::default()
    })
}
