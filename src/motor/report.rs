//! One scenario from recording to result, as data: what `armtwin motor --json` writes.

use serde::Serialize;

use super::dependence::Dependence;
pub use super::error::MotorError;
use super::error::error_percent;
use super::experiment::{Clean, Record};
use super::fit::{End, Fit, Tick, least_squares, swarm};
use super::inference::{ALPHA, Combination, Conventions, Interval, Knowledge, analyse};
use super::input::Excitation;
use super::model::{COUNT, Motor, NAMES, UNITS};
use super::output_error::OutputError;
use super::scenario::{Channel, NlseSettings, Scenario};
use super::simulate::{Accuracy, Output, simulate};
use crate::identification::pso;
use crate::statistics::Goodness;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    Pso,
    Nlse,
}

impl Method {
    pub fn name(self) -> &'static str {
        match self {
            Self::Pso => "pso",
            Self::Nlse => "nlse",
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScenarioReport {
    pub scenario: usize,
    pub title: String,
    pub measured: Vec<Channel>,
    pub given: Vec<Given>,
    /// Random seed for noise and searches.
    pub seed: u64,
    pub warnings: Vec<String>,
    /// Parameters in every direction that the data cannot determine.
    pub unidentifiable: Vec<Vec<&'static str>>,
    /// Noise of each measured channel as its second differences show it.
    pub noise: Vec<f64>,
    pub methods: Vec<MethodReport>,
    /// How the error of what is not identifiable follows bounds and starts; empty if all is.
    pub dependence: Vec<Dependence>,
    pub settings: Settings,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Given {
    pub name: &'static str,
    pub value: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    pub identification: Excitation,
    pub verification: Excitation,
    pub bounds: [[f64; 2]; COUNT],
    pub nlse: NlseSettings,
    pub pso: pso::Settings,
    pub alpha: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodReport {
    pub method: &'static str,
    /// 1 - SSE/SST of the speed on the verification recording.
    pub r2: f64,
    /// (rad/s)^2, on the verification recording.
    pub mse: f64,
    pub fit: Goodness,
    pub check: Goodness,
    /// sqrt(mean r^2), in units of the noise: 1 is as good as the truth.
    pub cost: f64,
    pub evaluations: usize,
    pub seconds: f64,
    pub stopped: String,
    pub starts: Vec<End>,
    /// Distance from the minimum in standard errors.
    pub newton_step: f64,
    /// False: the search stopped short, and tests and intervals do not hold.
    pub at_minimum: bool,
    pub unidentifiable: Vec<Vec<&'static str>>,
    pub identifiability: Cliff,
    pub combinations: Vec<CombinationReport>,
    pub parameters: Vec<ParameterReport>,
}

/// The singular values of the Jacobian on either side of the rank decision.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cliff {
    pub smallest_kept: f64,
    pub largest_dropped: Option<f64>,
    pub threshold: f64,
}

/// `statistics::Design` drops what is below, relative to the largest.
const THRESHOLD: f64 = 1e-9;

/// Standard errors from the minimum within which tests and intervals are taken to hold.
pub(super) const FARTHEST: f64 = 0.5;

/// Half a 99 % interval, % of the value, up to which the excitation supports a parameter.
const SUPPORTED: f64 = 5.0;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CombinationReport {
    #[serde(flatten)]
    pub combination: Combination,
    pub truth: f64,
    /// Error relative to the truth, %; absent where that is zero.
    pub error_percent: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterReport {
    pub name: &'static str,
    pub unit: &'static str,
    pub truth: f64,
    pub value: f64,
    pub error_percent: Option<f64>,
    /// Robust, 99 %; null where refused (not identifiable, at a bound, or given).
    pub low: f64,
    pub high: f64,
    pub statistic: f64,
    pub p: f64,
    pub log10_p: f64,
    pub asymptotic: Interval,
    pub paper: Interval,
    pub bounds: [f64; 2],
    pub at_bound: bool,
    pub given: bool,
    pub identifiable: bool,
    /// p <= alpha: the term exists.
    pub kept: bool,
    pub verdict: String,
}

impl ParameterReport {
    /// Searched for, and its interval within 5 % of the value.
    pub fn is_supported(&self) -> bool {
        !self.given && 50.0 * (self.high - self.low) / self.value.abs() <= SUPPORTED
    }
}

impl Scenario {
    pub(super) fn given_values(&self) -> Vec<Given> {
        let one = |k: usize| self.given[k].map(|value| Given { name: NAMES[k], value });
        (0..COUNT).filter_map(one).collect()
    }
}

/// Recordings of a scenario for identification and for verification.
pub fn recordings(scenario: &Scenario, seed: u64) -> Result<[Record; 2], MotorError> {
    let clean = |e| Clean::of(&scenario.truth, e).map_err(MotorError::Truth);
    let identification = clean(&scenario.identification)?.for_identification(seed);
    Ok([identification, clean(&scenario.verification)?.for_verification(seed)])
}

/// Identifies, tests and verifies one scenario by each method.
pub fn run(
    scenario: &Scenario,
    methods: &[Method],
    seed: u64,
    tick: Tick<'_>,
) -> Result<ScenarioReport, MotorError> {
    let [identification, verification] = recordings(scenario, seed)?;
    let problem = scenario.problem(&identification);
    let mut reports = Vec::new();
    for method in methods {
        let fit = search(scenario, &problem, *method, seed, tick);
        reports.push(report_of(scenario, &problem, fit, &identification, &verification)?);
    }
    let unidentifiable = reports.last().map(|m| m.unidentifiable.clone()).unwrap_or_default();
    Ok(ScenarioReport {
        scenario: scenario.number,
        title: scenario.title.clone(),
        measured: scenario.measured.clone(),
        given: scenario.given_values(),
        seed,
        warnings: scenario.warnings(),
        unidentifiable,
        noise: problem.sigma.clone(),
        methods: reports,
        dependence: Vec::new(),
        settings: Settings {
            identification: scenario.identification,
            verification: scenario.verification,
            bounds: scenario.bounds,
            nlse: scenario.nlse,
            pso: scenario.pso,
            alpha: ALPHA,
        },
    })
}

fn search(
    scenario: &Scenario,
    problem: &OutputError<'_>,
    method: Method,
    seed: u64,
    tick: Tick<'_>,
) -> Fit {
    let bounds = &scenario.bounds;
    match method {
        Method::Pso => swarm(problem, bounds, &scenario.pso, seed, tick),
        Method::Nlse => least_squares(problem, bounds, scenario.nlse.starts, seed, tick),
    }
}

fn report_of(
    scenario: &Scenario,
    problem: &OutputError<'_>,
    fit: Fit,
    identification: &Record,
    verification: &Record,
) -> Result<MethodReport, MotorError> {
    if !fit.cost.is_finite() {
        return Err(MotorError::NothingFits);
    }
    let knowledge = analyse(problem, &fit.values)?;
    let check = goodness(&fit.values, verification)?;
    let names = |members: &Vec<usize>| members.iter().map(|&k| NAMES[k]).collect();
    Ok(MethodReport {
        method: fit.method,
        r2: check.r2,
        mse: check.mse,
        fit: goodness(&fit.values, identification)?,
        check,
        cost: fit.cost,
        evaluations: fit.evaluations,
        seconds: fit.seconds,
        stopped: fit.stopped,
        starts: fit.starts,
        newton_step: knowledge.newton_step,
        at_minimum: knowledge.newton_step <= FARTHEST,
        unidentifiable: knowledge.undetermined.iter().map(names).collect(),
        identifiability: Cliff {
            smallest_kept: knowledge.smallest_kept,
            largest_dropped: knowledge.largest_dropped,
            threshold: THRESHOLD,
        },
        combinations: combinations(scenario, &knowledge),
        parameters: (0..COUNT).map(|k| parameter(scenario, &knowledge, &fit.values, k)).collect(),
    })
}

/// Goodness of fit of the speed.
fn goodness(values: &[f64; COUNT], record: &Record) -> Result<Goodness, MotorError> {
    let mut output = Output::default();
    simulate(&Motor::from_array(values), &record.input, Accuracy::SEARCH, &mut output)
        .map_err(|_| MotorError::NothingFits)?;
    Ok(Goodness::of(&record.measured.omega, &output.omega))
}

fn combinations(scenario: &Scenario, knowledge: &Knowledge) -> Vec<CombinationReport> {
    let truth = scenario.truth.to_array();
    let of = |combination: &Combination| {
        let truth = combination.of(&truth);
        let error_percent = error_percent(combination.value, truth);
        CombinationReport { combination: combination.clone(), truth, error_percent }
    };
    knowledge.combinations.iter().map(of).collect()
}

fn parameter(
    scenario: &Scenario,
    knowledge: &Knowledge,
    values: &[f64; COUNT],
    k: usize,
) -> ParameterReport {
    let (value, bounds, given) = (values[k], scenario.bounds[k], scenario.given[k].is_some());
    let near = 1e-6 * (bounds[1] - bounds[0]);
    let at_bound = !given && (value <= bounds[0] + near || value >= bounds[1] - near);
    let mut known = knowledge.parameters[k];
    if at_bound {
        known = known.without_bounds();
    }
    let Conventions { robust, asymptotic, paper } = known;
    let kept = given || robust.p <= ALPHA;
    let verdict = match (given, knowledge.identifiable[k], at_bound) {
        (true, ..) => "given".into(),
        (_, false, _) => beyond_reach(NAMES[k], knowledge),
        (_, _, true) => "at its bound: no interval".into(),
        _ if knowledge.newton_step > FARTHEST => "not at a minimum: p and interval void".into(),
        _ => width_verdict(value, &robust, kept),
    };
    ParameterReport {
        name: NAMES[k],
        unit: UNITS[k],
        truth: scenario.truth.to_array()[k],
        value,
        error_percent: error_percent(value, scenario.truth.to_array()[k]),
        low: robust.low,
        high: robust.high,
        statistic: robust.statistic,
        p: robust.p,
        log10_p: robust.log10_p,
        asymptotic,
        paper,
        bounds,
        at_bound,
        given,
        identifiable: knowledge.identifiable[k],
        kept,
        verdict,
    }
}

fn beyond_reach(name: &str, knowledge: &Knowledge) -> String {
    let involves = |c: &&Combination| c.factors.iter().any(|(n, _)| *n == name);
    match knowledge.combinations.iter().find(involves) {
        Some(c) => format!("not identifiable, only {}", c.name),
        None => "not identifiable".into(),
    }
}

/// What the width of the 99 % interval allows to say.
fn width_verdict(value: f64, robust: &Interval, kept: bool) -> String {
    let percent = 50.0 * (robust.high - robust.low) / value.abs();
    match (kept, percent) {
        (false, _) => "may be zero".into(),
        (_, p) if p <= SUPPORTED => format!("identified, +-{p:.2} %"),
        (_, p) if p <= 20.0 => format!("roughly, +-{p:.0} %"),
        (_, p) => format!("hardly supported by this excitation, +-{p:.0} %"),
    }
}
