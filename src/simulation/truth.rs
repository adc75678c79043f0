//! `truth.json`: what a simulated recording hides, and all that made it.

use serde::Serialize;

use super::{
    ControllerSettings, Experiment, Injection, Noise, Quantisation, Run, Scenario, Thermal,
};
use crate::effects::{Parameter, Scope};
use crate::motion::Settings;
use crate::robot::Drive;

pub const SCHEMA: &str = "armtwin.truth/1";

#[derive(Debug, Serialize)]
pub struct Truth<'a> {
    pub schema: &'static str,
    pub program: Program,
    /// Random seed for the sensors' noise.
    pub seed: u64,
    pub robot: &'a str,
    pub joints: usize,
    pub step_s: f64,
    pub rate_hz: f64,
    pub drive: &'a Drive,
    pub effects: Vec<Hidden>,
    pub controller: &'a ControllerSettings,
    pub noise: &'a Noise,
    pub quantisation: &'a Quantisation,
    pub thermal: &'a Thermal,
    pub recordings: Vec<Recorded<'a>>,
    /// The scenario as read, defaults filled in.
    pub scenario: &'a Scenario,
}

#[derive(Debug, Serialize)]
pub struct Program {
    pub name: &'static str,
    pub version: &'static str,
    pub rapier: &'static str,
}

/// An injected effect.
#[derive(Debug, Serialize)]
pub struct Hidden {
    pub effect: &'static str,
    /// Joints that it acts on, from 1 at the base; empty: the whole arm.
    pub joints: Vec<usize>,
    pub parameters: Vec<Value>,
}

#[derive(Debug, Serialize)]
pub struct Value {
    pub name: &'static str,
    pub unit: &'static str,
    /// One per entry of `joints`, one in all for the whole arm.
    pub values: Vec<f64>,
}

#[derive(Debug, Serialize)]
pub struct Recorded<'a> {
    pub file: &'static str,
    pub motion: &'a Settings,
    pub samples: usize,
    /// Standard deviation of the white noise on each joint's current, A, and the same at the
    /// joint, N.m.
    pub current_noise_a: Vec<f64>,
    pub torque_noise_nm: Vec<f64>,
}

impl<'a> Truth<'a> {
    /// Truth of a fit and a check recording.
    pub fn new(scenario: &'a Scenario, made: &'a Experiment, fit: &Run, check: &Run) -> Self {
        let setup = &made.setup;
        let recorded = |file, motion, run: &Run| Recorded {
            file,
            motion,
            samples: run.recording.time.len(),
            torque_noise_nm: (run.current_noise_a.iter().enumerate())
                .map(|(j, sigma)| sigma * setup.drive.torque_per_ampere(j))
                .collect(),
            current_noise_a: run.current_noise_a.clone(),
        };
        Self {
            schema: SCHEMA,
            program: program(),
            seed: made.seed,
            robot: &scenario.robot,
            joints: setup.robot.dof(),
            step_s: scenario.step_s,
            rate_hz: scenario.rate_hz,
            drive: &setup.drive,
            effects: setup.effects.iter().map(hidden).collect(),
            controller: &setup.controller,
            noise: &setup.noise,
            quantisation: &setup.quantisation,
            thermal: &setup.thermal,
            recordings: vec![
                recorded("fit.csv", &scenario.motion, fit),
                recorded("check.csv", &made.check_motion, check),
            ],
            scenario,
        }
    }
}

pub fn program() -> Program {
    Program {
        name: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        rapier: rapier_version(include_str!("../../Cargo.lock")),
    }
}

/// The version that was built in, from the lock file.
fn rapier_version(lock: &'static str) -> &'static str {
    let mut lines = lock.lines().skip_while(|l| *l != "name = \"rapier3d-f64\"").skip(1);
    lines.next().and_then(|l| l.split('"').nth(1)).unwrap_or("unknown")
}

fn hidden(injection: &Injection) -> Hidden {
    let about = injection.effect.about();
    let value = |(i, p): (usize, &Parameter)| Value {
        name: p.name,
        unit: p.unit,
        values: injection.values.iter().map(|row| row[i]).collect(),
    };
    Hidden {
        effect: about.name,
        joints: match about.scope {
            Scope::Joint | Scope::Link => injection.joints.iter().map(|j| j + 1).collect(),
            Scope::Arm => Vec::new(),
        },
        parameters: about.parameters.iter().enumerate().map(value).collect(),
    }
}
