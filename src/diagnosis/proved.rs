//! What a proof by other means than torque holds to stand of what a search finds.

use super::DiagnosisError;
use super::bootstrap::LEVEL;
use super::called::Called;
use super::candidate::{Candidate, Term};
use super::fit::Fit;
use super::hypotheses::Hypotheses;
use super::judge::Judge;
use super::model::Model;
use super::offered::{Offer, offered};
use super::search::Found;

/// A change that stands, and those that do as well in its place, by their indices.
#[derive(Debug, Clone, PartialEq)]
pub struct Stands {
    pub index: usize,
    pub equals: Vec<usize>,
}

impl Stands {
    /// Is it this change, or does this one do as well?
    pub fn includes(&self, index: usize) -> bool {
        self.index == index || self.equals.contains(&index)
    }
}

/// Tells by other means than torque which changes, the most plausible first, stand.
pub type Proof<'a> = dyn FnMut(&[Offer]) -> Result<Vec<Stands>, DiagnosisError> + 'a;

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
    let (offered, offers) = offered(search, [found, blind]);
    let stand = proof(&offers)?;
    let terms = stand.iter().map(|s| offered[s.index].clone());
    let model = terms.fold(Model::of(search.data.twin), |model, term| model.with(term));
    let joints: Vec<usize> = (0..search.data.joints()).collect();
    let fit = search.tuned(Fit::plain(search.data, model), &joints);
    let standings = search.standings(&fit);
    let gains = (0..standings.len()).map(|i| judge.gain(&fit, i)).collect();
    // A model sorts its causes.
    let equals = |cause: &Term| -> Vec<Candidate> {
        let own = stand.iter().find(|s| offered[s.index].candidate == cause.candidate);
        own.iter().flat_map(|s| &s.equals).map(|i| offered[*i].candidate).collect()
    };
    let equals = Some(fit.model.causes.iter().map(equals).collect());
    Ok(Called { fit, standings, gains, unconfirmed: Vec::new(), equals })
}
