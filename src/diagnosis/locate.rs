//! Nonlinear parameters of effects that are to be fitted, found as those of a candidate are: from
//! the catalogue's starts, refined, each given the others.

use super::bound::at_bound;
use super::candidate::{Candidate, Place, Term};
use super::criteria::Criteria;
use super::data::Data;
use super::fit::Fit;
use super::floor::noise_floor;
use super::model::Model;
use super::observed::Observed;
use super::refine;
use super::screen::screen;
use super::trial;
use super::{DiagnosisError, Settings};
use crate::effects::{Effect, Scope};
use crate::follow::{Watch, stoppable};
use crate::identification::{Located, Terms};
use crate::signals::Samples;
use crate::twin::Twin;

/// How many candidates are refined: those that gain most at their starts.
const REFINED: usize = 4;
/// Rounds of searching every effect again, given the others.
const ROUNDS: usize = 4;
/// What is told of it.
pub const LOCATING: &str = "searching for nonlinear parameters";
/// Gains of log-likelihood that are worth another round, nats.
const SETTLED: f64 = 0.5;

/// Every effect of `terms` whose nonlinear parameters the twin leaves open, wherever it may act; in
/// work that `watch` may end.
///
/// # Errors
/// If no joint slides long enough, or it is ended.
pub fn locate(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    watch: &dyn Watch,
) -> Result<Vec<Located>, DiagnosisError> {
    stoppable(watch, || searched(samples, twin, terms, watch))?
}

fn searched(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    watch: &dyn Watch,
) -> Result<Vec<Located>, DiagnosisError> {
    let open = terms.open_nonlinear(twin);
    if open.is_empty() {
        return Ok(Vec::new());
    }
    let curved = terms.curve_of(twin);
    let given = |joint| terms.given_nonlinear(twin, joint);
    let given: Vec<_> = (0..twin.robot.dof()).map(given).collect();
    let twin = terms.left_open(twin);
    let samples = &twin.correct(samples);
    let floor = noise_floor(samples, &twin);
    let observed = Observed::new(0, &twin, samples, &floor)?;
    let data = Data::new(vec![&observed], &Settings::default()).watched(watch);
    let mut model = Model::of(&twin);
    for (joint, effects) in given.into_iter().enumerate() {
        for (effect, nonlinear) in effects {
            let place = match effect.about().scope {
                Scope::Arm if joint > 0 => continue,
                Scope::Arm => Place::Arm,
                _ => Place::Joint(joint),
            };
            model = model.with(Term::new(Candidate::new(effect, place), nonlinear));
        }
    }
    let each = |e: &&'static dyn Effect| places(*e, twin.robot.dof());
    let candidates: Vec<Candidate> = curved.iter().chain(&open).flat_map(each).collect();
    for found in 0.. {
        // Every round but the last finds one of them.
        watch.bound(LOCATING, found, candidates.len() as u64 + 1);
        let Some(more) = next(&data, &model, &candidates) else { break };
        model = more;
        // What the twin gives stays.
        let given = model.causes.iter().take_while(|t| t.searched.is_empty()).count();
        let sought: Vec<usize> = (given..model.causes.len()).collect();
        refine_together(&data, &mut model, &sought);
    }
    let motion = observed.motion(&twin.robot);
    let is_curve = |c: &&Candidate| curved.is_some_and(|e| e.about().name == c.name());
    let sought = candidates.iter().filter(|c| !is_curve(c));
    Ok(sought.map(|c| located(c, c.starts(&motion, &twin), &model)).collect())
}

fn places(effect: &'static dyn Effect, joints: usize) -> Vec<Candidate> {
    match effect.about().scope {
        Scope::Arm => vec![Candidate::new(effect, Place::Arm)],
        _ => (0..joints).map(|j| Candidate::new(effect, Place::Joint(j))).collect(),
    }
}

/// The model with the candidate that gains most; `None` if none earns its place.
fn next(data: &Data<'_>, model: &Model, candidates: &[Candidate]) -> Option<Model> {
    let fit = tuned(Fit::plain(data, model.clone()));
    let missing = candidates.iter().filter(|c| !model.has(**c)).copied().collect::<Vec<_>>();
    let screened = screen(&fit, &missing);
    let least = Criteria::default().least_nats + (candidates.len() as f64).ln();
    let earns = |s: &super::screen::Screened| {
        let beside = fit.clone().beside(s.sizes.clone());
        let trial = refine::refine(&beside, &s.trial);
        let after = tuned(Fit::new(data, model.with(trial.term()), s.sizes.clone()));
        let nats = after.ln_evidence() - fit.ln_evidence();
        let inside = at_bound(&after, &trial).is_none();
        (nats > least && inside).then_some((nats, after.model))
    };
    let best = screened.iter().take(REFINED).filter_map(earns);
    best.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, model)| model)
}

fn tuned(fit: Fit<'_>) -> Fit<'_> {
    let all: Vec<usize> = (0..fit.data.joints()).collect();
    let sizes = fit.likely_sizes(&all);
    fit.beside(sizes)
}

/// Searches the causes at these indices again, each given all others, until none gains.
pub(super) fn refine_together(data: &Data<'_>, model: &mut Model, sought: &[usize]) {
    for _ in 0..ROUNDS {
        let mut gained = 0.0f64;
        for &i in sought {
            let others = Fit::plain(data, model.without(i));
            let now = trial::tried(&others, &model.causes[i]);
            let again = screen(&others, &[model.causes[i].candidate]);
            let starts = again.into_iter().map(|s| s.trial).chain([now.clone()]);
            let refined = starts.map(|start| refine::refine(&others, &start));
            let best = refined.max_by(|a, b| a.gain.total_cmp(&b.gain));
            let Some(best) = best.filter(|b| b.gain > now.gain) else { continue };
            gained = gained.max(best.ahead_of(&now));
            model.causes[i] = best.term();
        }
        if gained < SETTLED {
            break;
        }
    }
    *model = Fit::plain(data, model.clone()).model;
}

/// The candidate as the model has it; where it is not in the model, at the first start and without torque.
fn located(candidate: &Candidate, starts: Vec<Vec<f64>>, model: &Model) -> Located {
    let Candidate { effect, place, .. } = *candidate;
    let found: Option<&Term> = model.causes.iter().find(|t| t.candidate == *candidate);
    let shown = found.filter(|t| effect.is_itself(&t.linear));
    Located {
        effect,
        joint: if let Place::Joint(j) = place { j } else { 0 },
        linear: shown.map_or(vec![0.0; candidate.linear()], |t| t.linear.clone()),
        nonlinear: found.map_or(starts[0].clone(), |t| t.nonlinear.clone()),
        open: shown.map_or(vec![], |t| t.shapes().collect()),
        starts: starts.len(),
    }
}
