//! From a request to a motion that was searched, simulated and compared.

use std::cmp::Ordering;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::ask::Ask;
use super::baseline::{DT, RandomSines, random_sines};
use super::candidate::{Candidate, Family};
use super::capsules::{Capsules, Surroundings};
use super::evolution::{self, search};
use super::limits::{Held, Limits, torque_along};
use super::question::{Answer, Question, Recorder};
use super::report::{Report, report};
use super::scenario::{filled, scenario};
use super::simulated::simulated;
use crate::motion::{Envelope, Kind, MotionError, Settings, Trajectory};
use crate::simulation::{Scenario, ScenarioError, SimulationError};
use crate::twin::Twin;

/// What is wanted and within which limits.
#[derive(Clone)]
pub struct Request {
    pub ask: Ask,
    /// Length of the motion with the rests, s.
    pub seconds: f64,
    /// Largest distance from the middle pose, speed and acceleration of any joint.
    pub range_rad: f64,
    pub speed_rad_s: f64,
    pub acceleration_rad_s2: f64,
    /// Middle pose; left out, as of other motions.
    pub home_rad: Option<Vec<f64>>,
    pub around: Surroundings,
    /// Radius of the capsules around the links, m; left out, a share of the arm's length.
    pub radius_m: Option<f64>,
    /// Length of a tool beyond the flange, along its z axis, m.
    pub tool_m: f64,
    /// Smallest distance of surfaces, m.
    pub clearance_m: f64,
    /// Standard deviation of the noise on each joint's torque, N.m; left out, a share of the largest torque.
    pub noise_nm: Option<Vec<f64>>,
    /// Sample rate of the recording the motion is made for, Hz.
    pub rate_hz: f64,
    pub seed: u64,
    /// Motions tried by the search.
    pub evaluations: usize,
}

/// A motion that may be run.
pub struct Design {
    /// The motion, as a scenario has it.
    pub motion: Settings,
    pub trajectory: Trajectory,
    /// The experiment that was simulated.
    pub scenario: Scenario,
    /// The twin with typical values where it has none.
    pub twin: Twin,
    pub report: Report,
}

#[derive(Debug, thiserror::Error)]
pub enum ExcitationError {
    #[error("{key} = {value}: give a number {condition}")]
    Number { key: &'static str, value: f64, condition: &'static str },
    #[error("--noise has {given} values, the arm has {joints} joints: give {joints}")]
    Noise { given: usize, joints: usize },
    #[error(transparent)]
    Motion(#[from] MotionError),
    #[error("{0}")]
    NotTold(String),
    #[error(
        "no motion around this pose holds all limits: {0}; choose another middle pose (--home), \
         a smaller --range, --clearance or --radius, or move what is in the way"
    )]
    Impossible(String),
    #[error("the designed motion breaks a limit in simulation and nothing is written: {0}")]
    Broken(String),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error("in simulation, {0}")]
    Simulation(#[from] SimulationError),
}

/// White noise where none is given: this share of a joint's largest torque.
const NOISE_SHARE: f64 = 0.01;
/// White noise where no largest torque is known either, N.m.
const NOISE_NM: f64 = 1.0;
const REST_S: f64 = 1.0;
/// Share of the torque limit that a search may use.
const TORQUE_SHARE: f64 = 0.9;
/// Distance kept beyond the clearance, for what lies between grid points, m.
const SPARE_M: f64 = 0.005;
/// Share of all tries that are random motions; the search goes on from the best of them.
const START_SHARE: f64 = 0.05;
const SIGMA: f64 = 0.2;
/// If simulation breaks a limit the motion is made so much smaller, so many times.
const SMALLER: f64 = 0.97;
const ATTEMPTS: i32 = 6;
/// Step of the grid on which the finished motion is checked, s.
const CHECK_DT: f64 = 0.002;

/// What a candidate is worth: first to hold all limits, then to tell much.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Worth {
    exceeded: f64,
    log_det: f64,
}

/// The better one first.
fn order(a: &Worth, b: &Worth) -> Ordering {
    a.exceeded.total_cmp(&b.exceeded).then(b.log_det.total_cmp(&a.log_det))
}

/// The best motion that the search finds; `done` hears how many were tried.
///
/// # Errors
/// If a number is out of range, what is asked for can be told by no motion, no motion holds the
/// limits, or the simulated arm breaks them.
pub fn design(
    twin: &Twin,
    request: &Request,
    done: impl FnMut(usize),
) -> Result<Design, ExcitationError> {
    request.check(twin.robot.dof())?;
    let settings = request.motion();
    let envelope = Envelope::new(&twin.robot, &settings)?;
    let capsules = Capsules::new(&twin.robot, request.radius_m, request.tool_m);
    let limits = Limits::new(twin, envelope, capsules, &request.around, request.clearance_m);
    let recorder = request.recorder(&limits);
    let filled = filled(twin);
    let question = Question::new(&filled, twin, &request.ask, &recorder, &limits.envelope);
    if !question.can_be_answered() {
        return Err(ExcitationError::NotTold(not_told(&request.ask)));
    }
    let family = Family::new(&limits, request.seconds, REST_S);
    let found = best(&family, &limits, &question, &filled, request, done)?;
    let (motion, scenario, held, in_simulation) =
        checked(&family, found, &limits, &filled, &settings, request.seed)?;
    let trajectory = motion.trajectory(&twin.robot)?;
    let answer = question.answer(&trajectory.sampled(DT), DT);
    let answer = answer.ok_or_else(|| ExcitationError::NotTold(not_told(&request.ask)))?;
    let random: RandomSines = random_sines(&question, &limits, &filled, &settings);
    let report =
        report(request, &question, &recorder, &limits, [held, in_simulation], &answer, &random);
    Ok(Design { motion, trajectory, scenario, twin: filled, report })
}

fn not_told(ask: &Ask) -> String {
    match ask {
        Ask::Apart([a, b]) => format!(
            "no motion tells {} from {}: together with what is open besides, they are the same as \
             far as joint torques go",
            a.says(),
            b.says()
        ),
        Ask::Learn { .. } => "nothing of what is asked for shows in joint torques beside what is \
                              open anyway (friction, rotor inertia, offset): ask for more"
            .into(),
    }
}

fn best(
    family: &Family,
    limits: &Limits<'_>,
    question: &Question<'_>,
    filled: &Twin,
    request: &Request,
    done: impl FnMut(usize),
) -> Result<Candidate, ExcitationError> {
    let worth = |x: &[f64]| {
        let (_, motion) = family.candidate(x, limits);
        let tau = torque_along(filled, &motion, family.dt);
        let exceeded = limits.exceeded(&motion.q, &tau, TORQUE_SHARE, SPARE_M);
        // What breaks a limit is not worth the arithmetic.
        let answer: Option<Answer> =
            if exceeded > 0.0 { None } else { question.answer(&motion, family.dt) };
        Worth { exceeded, log_det: answer.map_or(f64::NEG_INFINITY, |a| a.log_det) }
    };
    let mut rng = ChaCha8Rng::seed_from_u64(request.seed);
    let mut draw =
        |_| -> Vec<f64> { (0..family.dimensions()).map(|_| rng.random_range(-1.0..1.0)).collect() };
    let evaluations = request.evaluations;
    let starts = ((START_SHARE * evaluations as f64) as usize).max(1);
    let starts = (0..starts).map(&mut draw).collect();
    let settings = evolution::Settings { seed: request.seed, evaluations, sigma: SIGMA };
    let nothing = || ExcitationError::Impossible("none was tried".into());
    let best = search(starts, &settings, worth, order, done).ok_or_else(nothing)?;
    let (candidate, motion) = family.candidate(&best.x, limits);
    if best.worth.exceeded > 0.0 {
        let tau = torque_along(filled, &motion, family.dt);
        let held = limits.held(&motion, &tau);
        let most = held.passed(limits.clearance_m + SPARE_M);
        let close = || "the torque comes too close to its limit".to_string();
        return Err(ExcitationError::Impossible(most.unwrap_or_else(close)));
    }
    Ok(candidate)
}

/// The motion, made smaller until it holds all limits as commanded and as simulated.
fn checked(
    family: &Family,
    found: Candidate,
    limits: &Limits<'_>,
    filled: &Twin,
    like: &Settings,
    seed: u64,
) -> Result<(Settings, Scenario, Held, Held), ExcitationError> {
    let mut candidate = found;
    let mut broken = String::new();
    for _ in 0..ATTEMPTS {
        let motion = Settings {
            kind: Kind::Series,
            seed,
            home_rad: Some(candidate.centre.clone()),
            series: Some(family.series(&candidate)),
            ..like.clone()
        };
        let sampled = motion.trajectory(limits.robot)?.sampled(CHECK_DT);
        let tau = torque_along(filled, &sampled, CHECK_DT);
        let held = limits.held(&sampled, &tau);
        match held.passed(limits.clearance_m) {
            Some(limit) => broken = limit,
            None => {
                let scenario = scenario(filled, &motion, seed);
                let made = scenario.work_out("the designed motion")?;
                let really = simulated(&made, limits)?;
                match really.passed(limits.clearance_m) {
                    Some(limit) => broken = limit,
                    None => return Ok((motion, scenario, held, really)),
                }
            }
        }
        candidate.coefficients.iter_mut().flatten().for_each(|a| *a *= SMALLER);
    }
    Err(ExcitationError::Broken(broken))
}

impl Request {
    /// Settings of any motion of this length within these limits.
    fn motion(&self) -> Settings {
        Settings {
            duration_s: self.seconds,
            rest_s: REST_S,
            range_rad: self.range_rad,
            speed_rad_s: self.speed_rad_s,
            acceleration_rad_s2: self.acceleration_rad_s2,
            home_rad: self.home_rad.clone(),
            ..Settings::default()
        }
    }

    fn recorder(&self, limits: &Limits<'_>) -> Recorder {
        let usual = |limit: &f64| if limit.is_finite() { NOISE_SHARE * limit } else { NOISE_NM };
        let noise = self.noise_nm.clone();
        Recorder {
            rate_hz: self.rate_hz,
            noise_nm: noise.unwrap_or_else(|| limits.torque.iter().map(usual).collect()),
        }
    }

    fn check(&self, dof: usize) -> Result<(), ExcitationError> {
        let must = |key, value: f64, range: std::ops::RangeInclusive<f64>, condition| match range
            .contains(&value)
        {
            true => Ok(()),
            false => Err(ExcitationError::Number { key, value, condition }),
        };
        let least = f64::MIN_POSITIVE;
        must("--seconds", self.seconds, 6.0..=600.0, "from 6 to 600")?;
        must("--range", self.range_rad, least..=10.0, "above 0 and up to 10")?;
        must("--speed", self.speed_rad_s, least..=100.0, "above 0 and up to 100")?;
        must("--acceleration", self.acceleration_rad_s2, least..=1000.0, "above 0 and up to 1000")?;
        must("--radius", self.radius_m.unwrap_or(1.0), least..=10.0, "above 0 and up to 10")?;
        must("--tool", self.tool_m, 0.0..=10.0, "from 0 to 10")?;
        must("--clearance", self.clearance_m, 0.0..=10.0, "from 0 to 10")?;
        must("--rate", self.rate_hz, 1.0..=1e5, "from 1 to 100000")?;
        let table = self.around.table_z.unwrap_or(0.0);
        must("--table-z", table, -100.0..=100.0, "from -100 to 100")?;
        must("--evaluations", self.evaluations as f64, 10.0..=1e7, "from 10 to 10000000")?;
        let Some(noise) = &self.noise_nm else { return Ok(()) };
        if noise.len() != dof {
            return Err(ExcitationError::Noise { given: noise.len(), joints: dof });
        }
        noise.iter().try_for_each(|&n| must("--noise", n, least..=1e6, "above 0 and up to 1000000"))
    }
}
