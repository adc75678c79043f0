//! Ground truth: an arm moved in the simulation with effects that its twin does not know.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::WorkflowError;
use crate::effects::{self, Effect, Role};
use crate::follow::Watch;
use crate::motion;
use crate::resimulation;
use crate::simulation::{
    Experiment, Glimpse, Moved, Run, Scenario, ScenarioError, Simulation, SimulationError, Truth,
};
use crate::twin::{DriveTable, PerJoint, Twin};

/// What a scenario of `armtwin simulate` can say; the defaults are its.
///
/// ```
/// # use armtwin::workflow::Simulate;
/// # use armtwin::motion::{Kind, Settings};
/// let motion = Settings { kind: Kind::RandomFrequency, duration_s: 60.0, ..Settings::default() };
/// let how = Simulate::default().motion(motion).hide("payload", [("mass", 2.0)])?.seed(7);
/// assert_eq!(how.scenario.seed, 7);
/// # Ok::<(), armtwin::workflow::WorkflowError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Simulate {
    pub scenario: Scenario,
}

/// Two recordings and what is hidden in them.
pub struct Simulated {
    pub scenario: Scenario,
    pub experiment: Experiment,
    pub fit: Run,
    pub check: Run,
}

/// Moves the twin's arm, with all that the twin knows and what is hidden besides; sensors without noise.
///
/// # Errors
/// As [`Simulate::run`].
pub fn simulate(
    twin: &Twin,
    motion: &motion::Settings,
    hidden: &[(&str, &[(&str, f64)])],
) -> Result<Simulated, WorkflowError> {
    let mut how = Simulate::default().motion(motion.clone());
    for (effect, values) in hidden {
        how = how.hide(effect, values.iter().copied())?;
    }
    how.run(twin, &())
}

impl Simulate {
    /// As a file says.
    ///
    /// # Errors
    /// If it cannot be read or is no scenario.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        Ok(Self { scenario: Scenario::load(path)? })
    }

    /// What the arm does in the fit recording; in the check recording it does the same with the next seed.
    pub fn motion(mut self, motion: motion::Settings) -> Self {
        self.scenario.motion = motion;
        self
    }

    /// Seed of the sensors' noise.
    pub fn seed(mut self, seed: u64) -> Self {
        self.scenario.seed = seed;
        self
    }

    /// Hides an effect at all joints, or in the whole arm. Parameters are named in full (`payload_mass`) or
    /// without their effect's name (`mass`); linear ones that are left out are at their null value.
    ///
    /// # Errors
    /// If there is no such effect or parameter, or nothing of the effect is left.
    pub fn hide<'k>(
        self,
        effect: &str,
        values: impl IntoIterator<Item = (&'k str, f64)>,
    ) -> Result<Self, WorkflowError> {
        let all = values.into_iter().map(|(key, value)| (key.to_string(), PerJoint::All(value)));
        self.hide_each(effect, all.collect())
    }

    /// Hides like [`Simulate::hide`], with values per joint, and with `joints` (from 1) that it acts on.
    ///
    /// # Errors
    /// As [`Simulate::hide`].
    pub fn hide_each(
        mut self,
        effect: &str,
        values: BTreeMap<String, PerJoint>,
    ) -> Result<Self, WorkflowError> {
        let found = effects::find(effect).ok_or_else(|| {
            let known = effects::names();
            WorkflowError::Asked(format!("effects: no effect {effect}; choose from {known}"))
        })?;
        let mut table: BTreeMap<String, PerJoint> =
            values.into_iter().map(|(key, value)| (full_name(found, &key), value)).collect();
        let linear = || found.about().parameters.iter().filter(|p| p.role == Role::Linear);
        if linear().next().is_some() && !linear().any(|p| table.contains_key(p.name)) {
            let names: Vec<_> = linear().map(|p| p.name).collect();
            let names = names.join(", ");
            return Err(WorkflowError::Asked(format!(
                "effects: {effect} without any of {names} is nothing: give a value"
            )));
        }
        for p in linear().filter(|p| p.null.is_finite() && p.left_out().is_none()) {
            table.entry(p.name.into()).or_insert(PerJoint::All(p.null));
        }
        self.scenario.effects.insert(effect.into(), table);
        Ok(self)
    }

    /// Moves the arm of `twin`.
    ///
    /// # Errors
    /// Values that are not possible, an arm that runs away, or an end by `watch`.
    pub fn run(&self, twin: &Twin, watch: &dyn Watch) -> Result<Simulated, WorkflowError> {
        let moved = Moved {
            robot: twin.robot.clone(),
            drive: twin.whole_drive(),
            known: resimulation::injections(twin, 0.0),
            notes: twin.notes.clone(),
        };
        let mut scenario = self.scenario.clone();
        scenario.robot.clone_from(&twin.source);
        scenario.drive = DriveTable::of(&moved.drive);
        let experiment = scenario.on(moved).map_err(WorkflowError::Asked)?;
        moved_along(scenario, experiment, watch)
    }

    /// Moves the arm that the scenario names; `file` is the scenario in messages, and a URDF's path counts from
    /// its folder.
    ///
    /// # Errors
    /// As [`Simulate::run`].
    pub fn run_as_written(
        &self,
        file: &str,
        watch: &dyn Watch,
    ) -> Result<Simulated, WorkflowError> {
        let experiment = self.scenario.work_out(file)?;
        moved_along(self.scenario.clone(), experiment, watch)
    }
}

/// `mass` of `payload` is `payload_mass`.
fn full_name(effect: &dyn Effect, key: &str) -> String {
    let about = effect.about();
    let named = |name: &str| about.parameters.iter().any(|p| p.name == name);
    let long = format!("{}_{key}", about.name);
    if !named(key) && named(&long) { long } else { key.into() }
}

fn moved_along(
    scenario: Scenario,
    experiment: Experiment,
    watch: &dyn Watch,
) -> Result<Simulated, WorkflowError> {
    let nobody = [|_: &Glimpse<'_>| {}; 2];
    let [fit, check] = move_along(&experiment, watch, nobody)?;
    Ok(Simulated { scenario, experiment, fit, check })
}

/// The recordings of both [`motions`](Experiment::motions) of `experiment`, made side by side; each of `see`
/// is shown the arm of one while it moves.
///
/// # Errors
/// If an arm runs away or `watch` ends it.
pub fn move_along<S: FnMut(&Glimpse<'_>) + Send>(
    experiment: &Experiment,
    watch: &dyn Watch,
    see: [S; 2],
) -> Result<[Run; 2], SimulationError> {
    let ms = |seconds: f64| (1000.0 * seconds) as u64;
    let motions = experiment.motions();
    let of = ms(motions.iter().map(|m| m.2.duration()).sum());
    let done = [AtomicU64::new(0), AtomicU64::new(0)];
    let run = |which: usize, mut see: S| {
        let (_, number, motion) = motions[which];
        let mut simulation = Simulation::new(&experiment.setup)?;
        simulation.run(motion, experiment.seed, number, &mut |now| {
            done[which].store(ms(now.time_s), Relaxed);
            watch.tell("simulating", done.iter().map(|d| d.load(Relaxed)).sum(), of);
            see(now);
            !watch.stops()
        })
    };
    let [of_fit, of_check] = see;
    let (fit, check) = rayon::join(|| run(0, of_fit), || run(1, of_check));
    Ok([fit?, check?])
}

impl Simulated {
    /// What `truth.json` holds.
    pub fn truth(&self) -> Truth<'_> {
        Truth::new(&self.scenario, &self.experiment, &self.fit, &self.check)
    }
}
