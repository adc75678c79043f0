//! Nonlinear parameters of effects that are to be fitted, found as those of a candidate are: from
//! the catalogue's starts, refined, each given the others.

use super::DiagnosisError;
use super::bound::at_bound;
use super::candidate::{Candidate, Place, Term};
use super::evidence::Evidence;
use super::floor::noise_floor;
use super::model::{Fit, Model};
use super::rank::{LEAST_NATS, effective_shares, gain, price};
use super::search::{self, Trial};
use crate::effects::{Effect, Role, Scope};
use crate::identification::{Located, Terms};
use crate::signals::Samples;
use crate::twin::Twin;

/// Of the candidates that gain most at their starts, how many are refined.
const REFINED: usize = 4;
/// Rounds of searching every effect again, given the others.
const ROUNDS: usize = 4;
/// Gains of log-likelihood that are worth another round, nats.
const SETTLED: f64 = 0.5;

/// Every effect of `terms` whose nonlinear parameters the twin leaves open, wherever it may act.
///
/// # Errors
/// If no joint slides long enough.
pub fn locate(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
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
    let evidence = Evidence::new(&twin, samples, &floor)?;
    let mut model = Model::of(&twin);
    for (joint, effects) in given.into_iter().enumerate() {
        for (effect, nonlinear) in effects {
            let place = match effect.about().scope {
                Scope::Arm if joint > 0 => continue,
                Scope::Arm => Place::Arm,
                _ => Place::Joint(joint),
            };
            model = model.with(Term::new(Candidate { effect, place }, nonlinear));
        }
    }
    let each = |e: &&'static dyn Effect| places(*e, twin.robot.dof());
    let candidates: Vec<Candidate> = curved.iter().chain(&open).flat_map(each).collect();
    while let Some(more) = next(&evidence, &model, &candidates) {
        model = more;
        // What the twin gives stays.
        let given = model.causes.iter().take_while(|t| t.searched.is_empty()).count();
        let sought: Vec<usize> = (given..model.causes.len()).collect();
        refine_together(&evidence, &mut model, &sought);
    }
    let motion = evidence.motion(&twin.robot);
    let is_curve = |c: &&Candidate| curved.is_some_and(|e| e.about().name == c.name());
    let sought = candidates.iter().filter(|c| !is_curve(c));
    Ok(sought.map(|c| located(c, c.starts(&motion), &model)).collect())
}

fn places(effect: &'static dyn Effect, joints: usize) -> Vec<Candidate> {
    match effect.about().scope {
        Scope::Arm => vec![Candidate { effect, place: Place::Arm }],
        _ => (0..joints).map(|j| Candidate { effect, place: Place::Joint(j) }).collect(),
    }
}

/// The model with the candidate that gains most; `None` if none earns its price, which counts
/// among how many starts it was chosen.
fn next(evidence: &Evidence<'_>, model: &Model, candidates: &[Candidate]) -> Option<Model> {
    let fit = Fit::new(evidence, model.clone());
    let missing = candidates.iter().filter(|c| !model.has(**c)).copied().collect::<Vec<_>>();
    let screened = search::screen(&fit, &missing, &[]);
    let refined = screened.iter().take(REFINED).map(|(start, _)| search::refine(&fit, start));
    let earns = |trial: Trial| {
        let after = search::adopt(&fit, model, &trial);
        let share = effective_shares(&after.system.residual);
        let gained = gain(evidence, &fit.squares, &after.squares, &share);
        let chosen = (trial.starts.len() as f64).ln();
        let worth = gained - price(&after, model.causes.len()) - chosen;
        let inside = at_bound(&after, &trial).is_none();
        (worth > LEAST_NATS && inside).then_some((worth, after.model))
    };
    let best = refined.filter_map(earns).max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, model)| model)
}

/// Searches the causes at these indices again, each given all others, until none gains.
pub(super) fn refine_together(evidence: &Evidence<'_>, model: &mut Model, sought: &[usize]) {
    for _ in 0..ROUNDS {
        let mut gained = 0.0f64;
        for &i in sought {
            let others = Fit::new(evidence, model.without(&[i]));
            let now = search::tried(&others, &model.causes[i]);
            let again = search::screen(&others, &[model.causes[i].candidate], &[]);
            let starts = again.into_iter().map(|(start, _)| start).chain([now.clone()]);
            let refined = starts.map(|start| search::refine(&others, &start));
            let best = refined.max_by(|a, b| a.gain.total_cmp(&b.gain));
            let Some(best) = best.filter(|b| b.gain > now.gain) else { continue };
            gained = gained.max(best.ahead_of(&now));
            model.causes[i] = best.term();
        }
        if gained < SETTLED {
            break;
        }
    }
    *model = Fit::new(evidence, model.clone()).model;
}

/// As the model has it; where it is not in the model, at the first start and without torque.
fn located(candidate: &Candidate, starts: Vec<Vec<f64>>, model: &Model) -> Located {
    let Candidate { effect, place } = *candidate;
    let found: Option<&Term> = model.causes.iter().find(|t| t.candidate == *candidate);
    let shown = found.filter(|t| effect.is_itself(&t.linear));
    let parameters = effect.about().parameters.iter().filter(|p| p.role == Role::Nonlinear);
    let is_reference: Vec<bool> = parameters.map(|p| p.is_reference()).collect();
    Located {
        effect,
        joint: if let Place::Joint(j) = place { j } else { 0 },
        linear: shown.map_or(vec![0.0; candidate.linear()], |t| t.linear.clone()),
        nonlinear: found.map_or(starts[0].clone(), |t| t.nonlinear.clone()),
        open: shown
            .map_or(vec![], |t| t.searched.iter().copied().filter(|k| !is_reference[*k]).collect()),
        starts: starts.len(),
    }
}
