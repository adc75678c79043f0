//! From a request to a motion that was searched, simulated and compared.

use std::cmp::Ordering;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::ask::Ask;
use super::baseline::{DT, RandomSines, random_sines};
use super::candidate::{Candidate, Family};
use super::capsules::Capsules;
use super::error::ExcitationError;
use super::evolution::{self, search};
use super::limits::{Held, Limits, torque_along};
use super::question::{Answer, Question};
use super::report::{Report, report};
use super::request::{REST_S, Request};
use super::scenario::{filled, scenario};
use super::simulated::simulated;
use crate::motion::{Envelope, Kind, Settings, Trajectory};
use crate::simulation::Scenario;
use crate::twin::Twin;

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
