//! The check recording, as a search that has not seen it predicts it.

use super::candidate::Candidate;
use super::fit::Fit;
use super::model::Model;
use super::observed::Observed;
use super::shrink::BeforeAfter;
use crate::regression::Blocks;
use crate::series::JointSeries;

/// What is left of the check recording by values of the fit recording alone, N.m at its rows.
pub struct HeldOut {
    /// Residual of the twin as given, its open terms fitted and nothing else, N.m.
    pub before: Blocks,
    /// Residual with the causes that a search of the fit recording alone finds, N.m.
    pub after: Blocks,
    /// Those causes.
    pub causes: Vec<Candidate>,
}

impl HeldOut {
    /// `found` is the search of the fit recording alone.
    pub fn new(found: &Fit<'_>, check: &Observed<'_>) -> Self {
        let values = |model: Model| Fit::plain(found.data, model).held_against(check);
        Self {
            before: values(Model::of(found.data.twin)),
            after: values(found.model.clone()),
            causes: found.model.causes.iter().map(|t| t.candidate).collect(),
        }
    }
}

/// What `with` makes of a residual before and after.
pub fn pair<T>(
    check: &Observed<'_>,
    before: &Blocks,
    after: &Blocks,
    with: impl Fn(&BeforeAfter) -> T,
) -> T {
    let series: [JointSeries; 2] = [check.over_time(before), check.over_time(after)];
    let masks = check.masks();
    let [before, after] = &series;
    with(&BeforeAfter { samples: check.samples, before, after, masks: &masks })
}
