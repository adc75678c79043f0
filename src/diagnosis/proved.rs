//! What a proof by other means than torque holds to stand of what a search finds.

use super::bootstrap::LEVEL;
use super::called::Called;
use super::candidate::{Candidate, Extent, Term};
use super::fit::Fit;
use super::hypotheses::{Hypotheses, Standing, WEIGHED};
use super::judge::Judge;
use super::model::Model;
use super::screen::screen;
use super::search::Found;
use super::{Change, DiagnosisError, intervals};

/// A change that stands, and those that do as well in its place, by their indices.
#[derive(Debug, Clone, PartialEq)]
pub struct Stands {
    pub index: usize,
    pub equals: Vec<usize>,
}

/// Tells by other means than torque which changes, of those that a search found, stand.
pub type Proof<'a> = dyn FnMut(&[Change]) -> Result<Vec<Stands>, DiagnosisError> + 'a;

/// Probability that what shrinks the error does so along any motion: its interval excludes that with this much.
pub const SURE: f64 = 0.5 * (1.0 + LEVEL);

/// What `proof` holds to stand of all that either search finds; evidence as the recordings show it beside that.
///
/// # Errors
/// If `proof` fails.
pub fn proved<'a>(
    search: &Hypotheses<'a>,
    judge: &Judge<'_>,
    [found, blind]: [&Found<'a>; 2],
    proof: &mut Proof<'_>,
) -> Result<Called<'a>, DiagnosisError> {
    let offered = offered(search, found, blind);
    let changes: Vec<Change> = offered.iter().map(|o| o.1.clone()).collect();
    let stand = proof(&changes)?;
    let terms = stand.iter().map(|s| offered[s.index].0.clone());
    let model = terms.fold(Model::of(search.data.twin), |model, term| model.with(term));
    let joints: Vec<usize> = (0..search.data.joints()).collect();
    let fit = search.tuned(Fit::plain(search.data, model), &joints);
    let standings = search.standings(&fit);
    let gains = (0..standings.len()).map(|i| judge.gain(&fit, i)).collect();
    // A model sorts its causes.
    let equals = |cause: &Term| -> Vec<Candidate> {
        let own = stand.iter().find(|s| offered[s.index].0.candidate == cause.candidate);
        own.iter().flat_map(|s| &s.equals).map(|i| offered[*i].0.candidate).collect()
    };
    let equals = Some(fit.model.causes.iter().map(equals).collect());
    Ok(Called { fit, standings, gains, unconfirmed: Vec::new(), equals })
}

/// What is there to be proved, as terms of the model and as changes of the twin: causes that a search finds, what comes
/// close to them, what a search took up and gave up again, and what acts in several joints.
fn offered<'a>(
    search: &Hypotheses<'a>,
    found: &Found<'a>,
    blind: &Found<'a>,
) -> Vec<(Term, Change)> {
    let searched = [&found.last, &blind.last].into_iter().flat_map(changes);
    let standings = search.standings(&found.last);
    let near = standings.iter().flat_map(|s| near(search, s));
    let mut all: Vec<(Term, Change)> = Vec::new();
    for offer in searched.chain(near).chain(alone(search, [found, blind])) {
        if !all.iter().any(|(known, _)| known.candidate == offer.0.candidate) {
            all.push(offer);
        }
    }
    all
}

/// Rivals with about the evidence of a cause, for what they are weighed by is linear.
fn near(search: &Hypotheses<'_>, standing: &Standing<'_>) -> Vec<(Term, Change)> {
    let criteria = &search.criteria;
    let cause = standing.cause().nats;
    let least = cause - criteria.margin(cause, false);
    let usable = standing.ranked.iter().filter(|h| h.at_bound.is_none() && h.nats > least.max(0.0));
    usable.filter_map(|h| changes(&h.fit).pop()).collect()
}

/// What acts in several joints, each alone: one of them may do what a search has a cause at every joint for. And what was
/// the best at some time: the steps that follow are linear as well.
fn alone<'a>(search: &Hypotheses<'a>, [found, blind]: [&Found<'a>; 2]) -> Vec<(Term, Change)> {
    let start = &found.start;
    let rounds = [found, blind].into_iter().flat_map(|f| &f.rounds);
    let added: Vec<Candidate> = rounds.flat_map(|r| r.added.iter().copied()).collect();
    let offered = |c: &&Candidate| c.extent() == Extent::Several || added.contains(c);
    let candidates: Vec<Candidate> = search.candidates.iter().filter(offered).copied().collect();
    let weighed = search.weigh(start, screen(start, &candidates), WEIGHED).into_iter();
    let usable = weighed.filter(|h| h.at_bound.is_none() && h.nats > search.criteria.least_nats);
    usable.flat_map(|h| changes(&h.fit)).collect()
}

/// The causes of a fit, as changes of the twin.
fn changes(fit: &Fit<'_>) -> Vec<(Term, Change)> {
    let values = intervals::of_fit(fit);
    let terms = fit.model.causes.iter().zip(values);
    terms.map(|(t, v)| (t.clone(), Change::of(t.candidate, &v, fit.data.twin))).collect()
}
