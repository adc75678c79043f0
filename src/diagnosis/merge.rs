//! One cause for the whole arm in place of the same effect at several of its joints: drives are alike.

use super::candidate::{Candidate, Place};
use super::fit::Fit;
use super::hypotheses::{Hypotheses, covers};
use super::screen::screen;

/// The fit with one cause for the whole arm in place of those at several joints, one of them `fresh`, where that has
/// more evidence.
pub fn merged<'a>(all: &Hypotheses<'a>, fit: &Fit<'a>, fresh: &[Candidate]) -> Option<Fit<'a>> {
    let stands_for = |whole: &Candidate, part: &Candidate| {
        matches!(part.place, Place::Joint(_)) && covers(whole, part)
    };
    let several = |whole: &&Candidate| {
        let parts = fit.model.causes.iter().filter(|t| stands_for(whole, &t.candidate));
        parts.count() > 1 && fresh.iter().any(|part| stands_for(whole, part))
    };
    let open = all.open(&fit.model);
    open.iter().filter(several).find_map(|whole| {
        let mut model = fit.model.clone();
        model.causes.retain(|t| !stands_for(whole, &t.candidate));
        let without = Fit::new(all.data, model, fit.sizes.clone());
        let without = all.tuned(without, &all.touched(*whole));
        let best = all.weigh(&without, screen(&without, &[*whole]), 1).into_iter().next()?;
        let better = best.at_bound.is_none() && all.worth(&best.fit) > all.worth(fit);
        better.then_some(best.fit)
    })
}
