//! All joints by each method.

use std::time::Instant;

use rayon::prelude::*;

use super::assemble::ArmProblem;
use super::bounds::Bounds;
use super::error::IdentificationError;
use super::problem::JointProblem;
use super::quadratic::QuadraticCost;
use super::{Found, JointEstimate, MethodResult, judge, pso, separable, shared};

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The paper's swarm.
    Pso,
    /// Separable least squares refined by Levenberg-Marquardt.
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

/// How the swarm's cost is evaluated; the same number either way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Search {
    /// Interpolated quadratic form ([`QuadraticCost`]).
    #[default]
    Quadratic,
    /// The law at every sample.
    Direct,
}

#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Settings {
    pub methods: Vec<Method>,
    /// Joint j's swarm is seeded with `seed` + 2^32 j.
    pub seed: u64,
    pub pso: pso::Settings,
    pub pso_cost: Search,
    pub nlse: separable::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            methods: vec![Method::Pso, Method::Nlse],
            seed: 1,
            pso: pso::Settings::default(),
            pso_cost: Search::default(),
            nlse: separable::Settings::default(),
        }
    }
}

/// One joint's problem with its payload taken off, ready to be searched.
pub struct Prepared {
    pub problem: JointProblem,
    pub bounds: Bounds,
    pub cost: QuadraticCost,
    /// For `cost`, s.
    seconds: f64,
}

impl Prepared {
    /// # Errors
    /// If bounds are the wrong way round.
    pub fn new(problem: JointProblem) -> Result<Self, IdentificationError> {
        let clock = Instant::now();
        let bounds = problem.bounds()?;
        let cost = QuadraticCost::new(&problem, &bounds);
        Ok(Self { problem, bounds, cost, seconds: clock.elapsed().as_secs_f64() })
    }

    /// The global optimum by separable least squares.
    pub fn separable(&self, settings: &separable::Settings) -> separable::Outcome {
        separable::minimise(&self.problem, &self.cost, &self.bounds, settings)
    }

    /// The paper's swarm.
    pub fn swarm(&self, settings: &Settings, seed: u64) -> pso::Outcome {
        match settings.pso_cost {
            Search::Quadratic => {
                pso::minimise(|x| self.cost.rms(x), &self.bounds, &settings.pso, seed)
            }
            Search::Direct => {
                let shared = pso::Settings { parallel: true, ..settings.pso };
                pso::minimise(|x| self.problem.direct_cost(x), &self.bounds, &shared, seed)
            }
        }
    }
}

/// What a search of one joint came to.
struct Searched {
    x: Vec<f64>,
    evaluations: usize,
    seconds: f64,
    stopped: String,
}

/// Fits every joint by every method; `check` is another recording's problem, assembled alike.
/// Parameters of the whole arm are solved for first (they are linear: see `shared`), and every
/// method is given what is left.
///
/// # Errors
/// If bounds are wrong or a residual is not finite.
pub fn identify(
    fit: &ArmProblem,
    check: Option<&ArmProblem>,
    settings: &Settings,
) -> Result<Vec<MethodResult>, IdentificationError> {
    let common = shared::solve(fit, &settings.nlse)?;
    let joints = shared::take_off(fit, &common);
    let check = check.map(|c| shared::take_off(c, &common));
    let prepared: Vec<Prepared> =
        joints.into_par_iter().map(Prepared::new).collect::<Result<_, _>>()?;
    let one = |&method: &Method| {
        let searched: Vec<Searched> =
            prepared.par_iter().map(|p| search(p, method, settings)).collect();
        let xs: Vec<Vec<f64>> = searched.iter().map(|s| s.x.clone()).collect();
        let found = Found { joints: xs, shared: common.clone() };
        report(method, &prepared, fit, check.as_deref(), searched, found)
    };
    settings.methods.iter().map(one).collect()
}

fn search(p: &Prepared, method: Method, settings: &Settings) -> Searched {
    let clock = Instant::now();
    let (x, evaluations, stopped) = match method {
        Method::Pso => {
            let seed = settings.seed.wrapping_add((p.problem.joint as u64) << 32);
            let o = p.swarm(settings, seed);
            (o.best, o.evaluations, text(o.stop))
        }
        Method::Nlse => {
            let o = p.separable(&settings.nlse);
            (o.x, o.evaluations, text(o.stop))
        }
    };
    Searched { x, evaluations, seconds: p.seconds + clock.elapsed().as_secs_f64(), stopped }
}

/// A stop reason as it stands in JSON.
fn text(stop: impl serde::Serialize) -> String {
    let value = serde_json::to_value(stop).ok();
    value.and_then(|v| v.as_str().map(str::to_string)).unwrap_or_default()
}

fn report(
    method: Method,
    prepared: &[Prepared],
    fit: &ArmProblem,
    check: Option<&[JointProblem]>,
    searched: Vec<Searched>,
    found: Found,
) -> Result<MethodResult, IdentificationError> {
    let problems: Vec<&JointProblem> = prepared.iter().map(|p| &p.problem).collect();
    let (tables, arm) = if fit.shared.is_empty() {
        let one = |(p, s): (&&JointProblem, &Searched)| judge::judge(p, &s.x);
        let pairs: Vec<_> = problems.iter().zip(&searched).collect();
        (pairs.into_par_iter().map(one).collect::<Result<_, _>>()?, vec![])
    } else {
        shared::judge(&problems, fit, &found)?
    };
    let estimate = |(j, (s, parameters)): (usize, (Searched, Vec<_>))| JointEstimate {
        joint: problems[j].joint,
        samples: problems[j].samples(),
        cost: problems[j].direct_cost(&s.x),
        evaluations: s.evaluations,
        seconds: s.seconds,
        stopped: s.stopped,
        fit: problems[j].goodness(&s.x),
        check: check.map(|c| c[j].goodness(&s.x)),
        parameters,
    };
    let joints = searched.into_iter().zip(tables).enumerate().map(estimate).collect();
    Ok(MethodResult { method: method.name().into(), joints, arm, found })
}

#[cfg(test)]
#[path = "arm_tests.rs"]
mod tests;
