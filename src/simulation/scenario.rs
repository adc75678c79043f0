//! `SCENARIO.toml`: an experiment on a simulated arm, and its translation into a [`Setup`].

use std::collections::BTreeMap;
use std::path::Path;

use super::inject::injections;
use super::setup::{Clock, Setup};
use super::{ControllerSettings, Injection, Noise, Quantisation, Thermal};
use crate::limits::read_settings;
use crate::motion::{Settings, Trajectory};
use crate::robot::{Chain, Drive, Robot};
use crate::twin::{DriveTable, PerJoint, ServoTable, read_robot};

/// The file as written. Tables and keys that are left out take their defaults; unknown ones are
/// errors.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Scenario {
    /// A built-in name or the path of a URDF.
    pub robot: String,
    /// Links of the URDF between which the arm is, if the robot is more than an arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tip: Option<String>,
    /// Link that loads are bolted to, if more of the arm moves beyond that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flange: Option<String>,
    /// Random seed for the sensors' noise; the motions have their own.
    pub seed: u64,
    /// Sample rate of the recording, Hz.
    pub rate_hz: f64,
    /// Step of the simulation, s. With an odd number of steps per controller period, recorded samples lie
    /// exactly in the middle of a hold; with an even one half a step beside it.
    pub step_s: f64,
    pub drive: DriveTable,
    /// Position servos lead the arm, and command and position are all that is recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo: Option<ServoTable>,
    /// What the arm does in `fit.csv`.
    pub motion: Settings,
    /// What it does in `check.csv`: keys that differ from `motion`; left out, the next seed.
    pub check: toml::Table,
    pub controller: ControllerSettings,
    pub noise: Noise,
    pub quantisation: Quantisation,
    /// How the joints warm up.
    pub thermal: Thermal,
    /// Names of effects whose values may leave the catalogue's range, on purpose.
    pub beyond_range: Vec<String>,
    /// Effects by name of the catalogue, each with its parameters and, if not all, the `joints` (from 1).
    pub effects: BTreeMap<String, BTreeMap<String, PerJoint>>,
}

impl Default for Scenario {
    fn default() -> Self {
        Self {
            robot: "ur5".into(),
            base: None,
            tip: None,
            flange: None,
            seed: 1,
            rate_hz: 125.0,
            step_s: 0.0004,
            drive: DriveTable::default(),
            servo: None,
            motion: Settings::default(),
            check: toml::Table::new(),
            controller: ControllerSettings::default(),
            noise: Noise::default(),
            quantisation: Quantisation::default(),
            thermal: Thermal::default(),
            beyond_range: Vec::new(),
            effects: BTreeMap::new(),
        }
    }
}

/// `{file}: {what is wrong, with the key, and what to do}`.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct ScenarioError {
    pub file: String,
    pub problem: String,
}

/// A scenario worked out: what to simulate and along which two trajectories.
#[derive(Clone)]
pub struct Experiment {
    pub setup: Setup,
    pub seed: u64,
    pub fit: Trajectory,
    pub check: Trajectory,
    /// The settings that made `check`.
    pub check_motion: Settings,
    /// What was assumed where the URDF does not say.
    pub notes: Vec<String>,
}

/// An arm as it is moved, but for what is hidden in it.
pub struct Moved {
    pub robot: Robot,
    pub drive: Drive,
    /// Effects that its owner knows of.
    pub known: Vec<Injection>,
    /// What was assumed about it.
    pub notes: Vec<String>,
}

impl Experiment {
    /// Both motions with their names and numbers: the sensors' noise differs by number.
    pub fn motions(&self) -> [(&'static str, u64, &Trajectory); 2] {
        [("fit", 0, &self.fit), ("check", 1, &self.check)]
    }
}

impl Scenario {
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let file = path.display().to_string();
        let text = read_settings(path).map_err(|e| ScenarioError {
            file: file.clone(),
            problem: format!("cannot read it: {e}; give the path of a scenario file (TOML)"),
        })?;
        Self::parse(&text, &file)
    }

    /// `file` names the text in messages.
    pub fn parse(text: &str, file: &str) -> Result<Self, ScenarioError> {
        toml::from_str(text).map_err(|e| ScenarioError {
            file: file.into(),
            problem: format!("not a valid scenario: {}", e.to_string().trim_end()),
        })
    }

    /// Cuts both motions to `duration_s`.
    pub fn shorten(&mut self, duration_s: f64) {
        self.motion.duration_s = duration_s;
        self.check.remove("duration_s");
    }

    /// Checks every value and builds what the simulation needs; `file` names the scenario in
    /// messages, and a URDF's path counts from its folder.
    pub fn work_out(&self, file: &str) -> Result<Experiment, ScenarioError> {
        self.resolve(Path::new(file))
            .map_err(|problem| ScenarioError { file: file.into(), problem })
    }

    fn resolve(&self, file: &Path) -> Result<Experiment, String> {
        let (base, tip, flange) = (self.base.clone(), self.tip.clone(), self.flange.clone());
        let chain = Chain { base, tip, flange };
        let loaded = read_robot(&self.robot, &chain, file).map_err(|e| format!("robot: {e}"))?.1;
        let drive = self
            .drive
            .on(&self.robot, loaded.robot.dof(), self.servo.as_ref())
            .map_err(|e| e.to_string())?;
        self.on(Moved { robot: loaded.robot, drive, known: Vec::new(), notes: loaded.notes })
    }

    /// The experiment on an arm that is at hand, in place of `robot` and `drive`; effects of the same name
    /// as one that is `known` of it take its place.
    ///
    /// # Errors
    /// What is wrong, with the key.
    pub fn on(&self, arm: Moved) -> Result<Experiment, String> {
        let Moved { robot, drive, known, notes } = arm;
        self.noise.check()?;
        self.quantisation.check()?;
        self.controller.check()?;
        self.thermal.check()?;
        let clock = Clock::new(self.step_s, self.controller.rate_hz, self.rate_hz);
        let clock = clock.map_err(|e| e.to_string())?;
        let mut effects = injections(&self.effects, &self.beyond_range, robot.dof())?;
        let hidden = |i: &Injection| self.effects.contains_key(i.effect.about().name);
        effects.extend(known.into_iter().filter(|i| !hidden(i)));
        let fit = self.motion.trajectory(&robot).map_err(|e| e.to_string())?;
        let check_motion = self.check_motion()?;
        let check = check_motion.trajectory(&robot).map_err(|e| format!("in [check], {e}"))?;
        let setup = Setup {
            robot,
            drive,
            effects,
            controller: self.controller.clone(),
            noise: self.noise,
            quantisation: self.quantisation,
            thermal: self.thermal,
            clock,
        };
        Ok(Experiment { setup, seed: self.seed, fit, check, check_motion, notes })
    }

    /// `[motion]` with the keys of `[check]` written over it.
    fn check_motion(&self) -> Result<Settings, String> {
        let next = Settings { seed: self.motion.seed.wrapping_add(1), ..self.motion.clone() };
        let mut table = toml::Table::try_from(&next).map_err(|e| format!("[check]: {e}"))?;
        table.extend(self.check.clone());
        table.try_into().map_err(|e: toml::de::Error| format!("[check]: {}", e.message()))
    }
}
