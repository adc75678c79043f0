//! What answers to cases on somebody's own recordings are worth: held against the same recordings
//! untouched.

mod agreement;
mod figures;
mod found;
mod page;
#[cfg(test)]
mod tests;

pub use agreement::agreement;
pub use figures::{figures, goals};
pub use page::parts;

use std::collections::HashMap;

use super::Judged;
use crate::diagnosis::{Named, Verdict};
use crate::trials::Kind;

/// Are these cases on somebody's own recordings?
pub fn are(cases: &[Judged]) -> bool {
    cases.iter().any(|j| Kind::ON_RECORDINGS.contains(&j.kind))
}

/// Sets what follows from the answers to the untouched pairs: of which names nobody knows whether they are true (the pair
/// beside is told them), which are strays, and which of those may be the arm's own all the same (another pair is told them).
pub fn hold_against_base(cases: &mut [Judged]) {
    let untouched = cases.iter().filter(|j| j.kind == Kind::Untouched);
    let base: HashMap<String, Vec<Named>> =
        untouched.map(|j| (j.case.clone(), j.all_names())).collect();
    let of_the_arm: Vec<Named> = base.values().flatten().cloned().collect();
    for judged in cases.iter_mut() {
        let Some(base) = judged.base.as_ref().and_then(|name| base.get(name)) else { continue };
        let hidden = judged.truth.clone();
        for cause in judged.printed.iter_mut().filter(|c| !c.is_one_of(&hidden)) {
            if cause.is_one_of(base) {
                cause.holds = None;
            } else {
                cause.may_be_the_arms = cause.is_one_of(&of_the_arm);
                judged.strays.push(cause.named.clone());
            }
        }
        judged.in_base = hidden.iter().any(|h| base.contains(h));
        judged.wrong = !judged.strays.is_empty();
        if judged.kind == Kind::GraftedForeign {
            let explained = judged.verdict == Some(Verdict::Explained);
            judged.right = judged.verdict.is_some() && !judged.wrong && !explained;
        }
    }
}
