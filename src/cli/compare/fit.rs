//! What the twin leaves open, from the recording itself.

use anyhow::Context;

use crate::identification::{
    BoundsByName, Method, Settings, Terms, assemble, fitted_twin, identify,
};
use crate::signals::Samples;
use crate::twin::Twin;

/// What there is to fit: the effects a given twin has no values for; of the built-in UR5 what a
/// real arm needs at least, as in `identify`.
pub fn terms(twin: &Twin, given: bool) -> anyhow::Result<Option<Terms>> {
    if !given {
        return Ok(Some(Terms::usual()?));
    }
    let open = twin.open().next().is_some();
    Ok(if open { Some(Terms::of_twin(twin, &[])?) } else { None })
}

/// The twin with values for `terms`, by separable least squares.
pub fn fit(twin: &Twin, terms: &Terms, samples: &Samples) -> anyhow::Result<Twin> {
    let arm = assemble(samples, twin, terms, &BoundsByName::new())?;
    let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
    let results = identify(&arm, None, &settings)?;
    let result = results.first().context("no method was asked for")?;
    Ok(fitted_twin(twin, terms, &arm, result)?)
}
