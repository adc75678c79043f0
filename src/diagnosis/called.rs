//! Which of what a search finds is called a cause.

use rayon::prelude::*;

use super::blind::Blind;
use super::candidate::Candidate;
use super::fit::Fit;
use super::hypotheses::{Hypotheses, Hypothesis, Standing};
use super::judge::{Gain, Judge};
use super::ranking::probability;
use super::search::Found;

/// The model with the causes that are called causes, each among its rivals.
pub struct Called<'a> {
    pub fit: Fit<'a>,
    pub standings: Vec<Standing<'a>>,
    pub gains: Vec<Gain>,
    /// What both recordings show together, and the fit recording alone does not.
    pub unconfirmed: Vec<Candidate>,
    /// Where a proof decided: what it cannot tell from each cause.
    pub equals: Option<Vec<Vec<Candidate>>>,
}

/// What stands of the search of both recordings: causes that are more probable than not, gain on the check
/// recording, and sit at no bound. What does not is left out, the weakest first, and the others are seen again
/// without it. Where the law is not exact, the search of the fit recording alone has to find the cause too.
pub fn called<'a>(
    search: &Hypotheses<'a>,
    judge: &Judge<'_>,
    found: &Found<'a>,
    blind: &Blind<'_, '_>,
) -> Called<'a> {
    let mut fit = found.last.clone();
    let (mut rejected, mut unconfirmed) = (Vec::new(), Vec::new());
    loop {
        // What costs least to see comes first.
        let count = fit.model.causes.len();
        let gains: Vec<Gain> = (0..count).into_par_iter().map(|i| judge.gain(&fit, i)).collect();
        let least = |a: &usize, b: &usize| gains[*a].largest().total_cmp(&gains[*b].largest());
        let agrees = |i: &usize| judge.agrees(&gains[*i], fit.model.causes[*i].candidate);
        if let Some(i) = (0..count).filter(|i| !agrees(i)).min_by(least) {
            fit = search.without(&fit, i);
            continue;
        }
        let standings = search.standings(&fit);
        if let Some(next) = corrected(search, judge, &fit, &standings, &gains, &mut rejected) {
            fit = next;
            continue;
        }
        let chosen = |i: &usize| blind.chooses(&standings[*i], &gains[*i]);
        let law = |i: &usize| {
            gains[*i].needs_replication(fit.model.causes[*i].candidate, &search.criteria)
        };
        let is_open = |i: &usize| law(i) && !chosen(i);
        let Some(i) = (0..count).filter(is_open).min_by(least) else {
            return Called { fit, standings, gains, unconfirmed, equals: None };
        };
        unconfirmed.push(fit.model.causes[i].candidate);
        fit = search.without(&fit, i);
    }
}

/// The fit without the weakest cause that fails, or with the better one of two names; `None` where all stand.
/// What is `rejected` does not come back.
fn corrected<'a>(
    search: &Hypotheses<'a>,
    judge: &Judge<'_>,
    fit: &Fit<'a>,
    standings: &[Standing<'a>],
    gains: &[Gain],
    rejected: &mut Vec<Candidate>,
) -> Option<Fit<'a>> {
    let criteria = &search.criteria;
    let fails = |i: &usize| {
        let bound = standings[*i].cause().at_bound.is_some() || is_impossible(fit, *i);
        bound || probability(&standings[*i], &gains[*i], criteria) <= 0.5
    };
    let nats = |i: &usize| standings[*i].cause().nats;
    let weakest = (0..standings.len()).filter(fails).min_by(|a, b| nats(a).total_cmp(&nats(b)));
    let next = |standing: &Standing<'a>, rejected: &[Candidate], least: f64| {
        let fresh = |h: &&Hypothesis<'a>| {
            let inside = h.at_bound.is_none() && !rejected.contains(&h.candidate());
            inside && h.nats > least
        };
        standing.ranked.iter().find(fresh).map(|h| h.fit.clone())
    };
    if let Some(i) = weakest {
        // What fails may have stood in for what does not, and looks the same.
        rejected.push(standings[i].cause().candidate());
        let least = (nats(&i) - criteria.equal_odds.ln()).max(criteria.least_nats);
        let instead = next(&standings[i], rejected, least);
        return Some(instead.unwrap_or_else(|| search.without(fit, i)));
    }
    // A better name beside which all others stand.
    standings.iter().find_map(|standing| {
        let better = next(standing, rejected, standing.cause().nats)?;
        let gain = |i: usize| judge.gain(&better, i);
        let stand = |i: usize| judge.agrees(&gain(i), better.model.causes[i].candidate);
        let stand = (0..better.model.causes.len()).all(stand);
        rejected.extend(stand.then_some(standing.cause().candidate()));
        stand.then_some(better)
    })
}

/// Is a linear value of cause `i` beyond what it can be?
fn is_impossible(fit: &Fit<'_>, i: usize) -> bool {
    let candidate = fit.model.causes[i].candidate;
    let values = fit.values(i);
    let linear = &values[..candidate.linear()];
    let beyond = |(k, v): (usize, &f64)| {
        let [min, max] = candidate.range(k, fit.data.twin);
        let slack = 1e-6 * (max - min);
        *v < min - slack || *v > max + slack
    };
    // The first one makes the effect what it is.
    linear.iter().enumerate().any(beyond)
        || linear.first().is_some_and(|v| {
            let [min, _] = candidate.range(0, fit.data.twin);
            min == 0.0 && *v <= 0.0
        })
}
