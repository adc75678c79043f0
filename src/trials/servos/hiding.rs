//! What is hidden in a case: drawn, and brought to its strength by simulating.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::arm::{RATE_HZ, SCALE, URDF, arm};
use super::position::{Plain, sharp};
use crate::effects;
use crate::motion::Trajectory;
use crate::recording::{Channel, Recording};
use crate::robot::{Chain, inverse_dynamics_series, urdf};
use crate::simulation::{
    Command, Experiment, Injection, Moved, Run, Scenario, Setup, Simulation, SimulationError,
};
use crate::trials::asked::Draw;
use crate::trials::drawn::inject;
use crate::trials::plan::Plan;
use crate::trials::shapes::{Ground, Shape, Size, shape};
use crate::trials::{Strength, TrialError, third};

/// A case before it is simulated.
pub struct Hiding {
    pub scenario: Scenario,
    pub made: Experiment,
    pub effects: Vec<Effect>,
    /// How much later than noted commands of the check recording are sent, s: loggers differ by up to a row.
    pub time_offset_s: f64,
    third: Trajectory,
    /// The arm with the effects.
    hides: Setup,
}

/// One of the hidden effects, with its strength when it is alone.
pub struct Effect {
    pub injection: Injection,
    pub strength: Strength,
    replaces_coulomb: bool,
}

/// Simulations in which the size of an effect is looked for; it is taken as it is within a third.
const SEARCHED: usize = 6;
const WITHIN: std::ops::Range<f64> = 0.75..1.33;

impl Hiding {
    /// # Errors
    /// If the plan names no known effect or the arm runs away.
    pub fn draw(
        how: &Draw,
        plan: &Plan,
        rng: &mut ChaCha8Rng,
        case: &str,
    ) -> Result<Self, TrialError> {
        let scenario = arm(how.duration_s, rng);
        let made = on_desk(&scenario).map_err(|e| TrialError::Usage(format!("{case}: {e}")))?;
        let plain = match plan.effects.is_empty() {
            true => None,
            false => Some(Plain::new(case, &made)?),
        };
        let third = third::motion(&scenario.motion, how.duration_s, &made.setup.robot)
            .map_err(|e| TrialError::Usage(format!("{case}: {e}")))?;
        let hides = made.setup.clone();
        let (effects, time_offset_s) = (Vec::new(), 0.0);
        let mut hiding = Self { scenario, made, effects, time_offset_s, third, hides };
        for (name, wanted) in &plan.effects {
            let shape = hiding.shape(name, rng)?;
            let Some(plain) = &plain else { continue };
            let effect = hiding.sized(&shape, *wanted, plain)?;
            inject(&mut hiding.hides, &effect.injection, effect.replaces_coulomb);
            hiding.effects.push(effect);
        }
        hiding.time_offset_s = rng.random_range(-1.0..1.0) / RATE_HZ;
        Ok(hiding)
    }

    fn shape(&self, name: &str, rng: &mut ChaCha8Rng) -> Result<Shape, TrialError> {
        let Experiment { setup, fit, .. } = &self.made;
        let planned = fit.sampled(1.0 / self.scenario.rate_hz);
        let torque = inverse_dynamics_series(&setup.robot, &planned.q, &planned.qd, &planned.qdd);
        let is_coulomb = |i: &&Injection| i.effect.about().name == "coulomb";
        let coulomb = setup.effects.iter().find(is_coulomb);
        let coulomb: Vec<f64> =
            coulomb.map_or(vec![], |i| i.values.iter().map(|row| row[0]).collect());
        let ground = Ground {
            q: &planned.q,
            torque: &torque,
            coulomb: &coulomb,
            duration_s: self.scenario.motion.duration_s,
            scale: SCALE,
        };
        let local = self.effects.iter().map(|e| &e.injection.joints);
        let local = local.filter(|j| j.len() < setup.robot.dof());
        let taken: Vec<usize> = local.flatten().copied().collect();
        let missing = || TrialError::Usage(format!("no effect `{name}` can be drawn"));
        shape(name, &ground, &taken, rng).ok_or_else(missing)
    }

    /// With values that such an effect can have on an arm of this size: others are no truth that could be found.
    fn in_range(&self, mut injection: Injection) -> Injection {
        let size = effects::Size::of(&self.made.setup.robot);
        let ranges = injection.effect.about().parameters.iter().map(|p| p.on(&size));
        let ranges: Vec<effects::Parameter> = ranges.collect();
        for row in &mut injection.values {
            row.iter_mut().zip(&ranges).for_each(|(value, range)| *value = range.clamp(*value));
        }
        injection
    }

    /// The effect at the size where the position shows it as strongly as is wanted.
    fn sized(
        &self,
        shape: &Shape,
        wanted: Option<f64>,
        plain: &Plain,
    ) -> Result<Effect, TrialError> {
        let with = |x: f64| {
            let injection = self.in_range(shape.sized(x));
            let mut setup = self.made.setup.clone();
            inject(&mut setup, &injection, shape.replaces_coulomb);
            let strength = plain.strength(&setup, &self.made)?;
            let strength = Strength { drawn: wanted, ..strength };
            Ok(Effect { injection, strength, replaces_coulomb: shape.replaces_coulomb })
        };
        let [low, high] = match &shape.size {
            Size::Factor { parameters, limit } => {
                let first = shape.injection.values[0][parameters[0]].abs().max(1e-12);
                [1e-4 * limit / first, limit / first]
            }
            Size::Knob { low, high, .. } => [*low, *high],
            Size::Fixed => return with(1.0),
        };
        let mut x = (0.01 * high).clamp(low, high);
        let mut effect = with(x)?;
        // The largest that was too weak and the smallest that was too strong.
        let mut between = [None, None];
        for _ in 0..SEARCHED {
            let ratio = wanted.unwrap_or(1.0) / effect.strength.reached().max(1e-6);
            between[usize::from(ratio < 1.0)] = Some(x);
            let next = next(between, x * ratio.clamp(0.02, 50.0)).clamp(low, high);
            if WITHIN.contains(&ratio) || next == x {
                break;
            }
            x = next;
            effect = with(x)?;
        }
        Ok(effect)
    }

    /// Is every effect about as strong as it should be? What sets in all at once can be much stronger or weaker.
    pub fn shows(&self) -> bool {
        let about = |d: f64| 0.5 * d..2.0 * d;
        let fair =
            |e: &Effect| e.strength.drawn.is_none_or(|d| about(d).contains(&e.strength.reached()));
        self.effects.iter().all(fair)
    }

    /// Fit recording, check recording with the command as it is noted, and a third one along another motion that encoders without
    /// noise and steps would show.
    ///
    /// # Errors
    /// If the arm runs away.
    pub fn simulate(&self) -> Result<[Run; 3], SimulationError> {
        let sharp = sharp(&self.hides);
        let run = |setup: &Setup, command: &dyn Command, number: u64| {
            Simulation::new(setup)?.run(command, self.made.seed, number, &mut |_| true)
        };
        let Experiment { fit, check, .. } = &self.made;
        let mut decides = run(&self.hides, check, 1)?;
        note(&mut decides.recording, check, self.time_offset_s);
        Ok([run(&self.hides, fit, 0)?, decides, run(&sharp, &self.third, 2)?])
    }
}

/// In each row the command that is sent so much later, s.
fn note(recording: &mut Recording, command: &dyn Command, late_s: f64) {
    let Recording { time, channels, .. } = recording;
    let told: Vec<&mut Channel> =
        channels.iter_mut().filter(|c| c.name.starts_with("target_q_")).collect();
    let [mut q, mut qd, mut qdd] = [(); 3].map(|()| vec![0.0; told.len()]);
    let rows: Vec<Vec<f64>> = (time.iter())
        .map(|t| {
            command.at((t + late_s).clamp(0.0, command.duration()), &mut q, &mut qd, &mut qdd);
            q.clone()
        })
        .collect();
    for (j, channel) in told.into_iter().enumerate() {
        channel.values = rows.iter().map(|row| row[j]).collect();
    }
}

/// `wanted`, or halfway (by factors) between what was too weak and too strong, where it lies beyond these: what sets in all at once.
fn next(between: [Option<f64>; 2], wanted: f64) -> f64 {
    match between {
        [Some(weak), Some(strong)] if !(weak < wanted && wanted < strong) => (weak * strong).sqrt(),
        _ => wanted,
    }
}

fn on_desk(scenario: &Scenario) -> Result<Experiment, String> {
    let words = |e: crate::robot::RobotError| e.to_string();
    let loaded = urdf::read(URDF, &scenario.robot, &Chain::default()).map_err(words)?;
    let dof = loaded.robot.dof();
    let drive = scenario.drive.on(&scenario.robot, dof, scenario.servo.as_ref()).map_err(words)?;
    scenario.on(Moved { robot: loaded.robot, drive, known: Vec::new(), notes: loaded.notes })
}
