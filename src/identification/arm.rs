//! All joints by each method.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use super::arm_problem::ArmProblem;
use super::error::IdentificationError;
use super::posterior::{self, Sampled};
use super::prepared::Prepared;
use super::problem::JointProblem;
use super::settings::{Method, Settings};
use super::{Found, JointEstimate, MethodResult, ParameterEstimate, judge, shared};
use crate::follow::{Watch, go_on, stoppable};

/// What a search of one joint came to.
struct Searched {
    x: Vec<f64>,
    evaluations: usize,
    seconds: f64,
    stopped: String,
    posterior: Option<Sampled>,
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
    identify_watched(fit, check, settings, &())
}

/// Fits like [`identify`], tells `watch` whenever one joint is through one method, and ends when it says so.
///
/// # Errors
/// As [`identify`], and if it is ended.
pub fn identify_watched(
    fit: &ArmProblem,
    check: Option<&ArmProblem>,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Vec<MethodResult>, IdentificationError> {
    stoppable(watch, || by_all(fit, check, settings, watch))?
}

fn by_all(
    fit: &ArmProblem,
    check: Option<&ArmProblem>,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Vec<MethodResult>, IdentificationError> {
    if settings.methods.contains(&Method::Mcmc) && !fit.shared.is_empty() {
        let names: Vec<_> = fit.shared.iter().map(|p| p.name.as_str()).collect();
        return Err(IdentificationError::SharedPosterior { names: names.join(", ") });
    }
    let common = shared::solve(fit, &settings.nlse)?;
    let joints = shared::take_off(fit, &common);
    let check = check.map(|c| shared::take_off(c, &common));
    let prepared: Vec<Prepared> =
        joints.into_par_iter().map(Prepared::new).collect::<Result<_, _>>()?;
    let (done, of) = (AtomicU64::new(0), (prepared.len() * settings.methods.len()) as u64);
    let tell = |done| watch.tell("fitting joint", done, of);
    tell(0);
    let one = |&method: &Method| {
        let searched: Vec<Searched> = prepared
            .par_iter()
            .map(|p| search(p, method, settings, watch))
            .inspect(|_| tell(1 + done.fetch_add(1, Ordering::Relaxed)))
            .collect::<Result<_, _>>()?;
        let xs: Vec<Vec<f64>> = searched.iter().map(|s| s.x.clone()).collect();
        let found = Found { joints: xs, shared: common.clone() };
        report(method, &prepared, fit, check.as_deref(), searched, found)
    };
    settings.methods.iter().map(one).collect()
}

fn search(
    p: &Prepared,
    method: Method,
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Searched, IdentificationError> {
    go_on(watch);
    let clock = Instant::now();
    let seed = settings.seed.wrapping_add((p.problem.joint as u64) << 32);
    let mut posterior = None;
    let (x, evaluations, stopped) = match method {
        Method::Pso => {
            let o = p.swarm(settings, seed, watch);
            (o.best, o.evaluations, text(o.stop))
        }
        Method::Nlse => {
            let o = p.separable(&settings.nlse);
            (o.x, o.evaluations, text(o.stop))
        }
        Method::Mcmc => {
            let o = posterior::sample(p, &settings.mcmc, &settings.nlse, seed, watch)?;
            let stopped = if o.converged() { "converged" } else { "not_converged" };
            let found = (o.x.clone(), o.evaluations, stopped.into());
            posterior = Some(o);
            found
        }
    };
    let seconds = p.seconds + clock.elapsed().as_secs_f64();
    Ok(Searched { x, evaluations, seconds, stopped, posterior })
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
    let (mut tables, arm): (Vec<Vec<ParameterEstimate>>, _) = if fit.shared.is_empty() {
        let one = |(p, s): (&&JointProblem, &Searched)| judge::judge(p, &s.x);
        let pairs: Vec<_> = problems.iter().zip(&searched).collect();
        (pairs.into_par_iter().map(one).collect::<Result<_, _>>()?, vec![])
    } else {
        shared::judge(&problems, fit, &found)?
    };
    for (rows, searched) in tables.iter_mut().zip(&searched) {
        searched.posterior.iter().for_each(|p| p.replace(rows));
    }
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
