//! The causes of a model seen together again: what one was found beside may since have gone.

use rayon::prelude::*;

use super::bound::Adopted;
use super::candidate::{Candidate, Extent};
use super::fit::Fit;
use super::hypotheses::{Hypotheses, WEIGHED};
use super::merge::merged;
use super::refine;
use super::slopes::of_cause;
use super::trial;
use crate::regression::bounds::Bounds;
use crate::regression::{Column, Raw};

/// Rounds of exchanging causes.
const REVISIONS: usize = 4;

/// The causes seen together again, as far as they meet what is `fresh` among them: one that no longer
/// earns its place is dropped, one that another fills better gives way.
pub fn revised<'a>(all: &Hypotheses<'a>, mut fit: Fit<'a>, mut fresh: Vec<Candidate>) -> Fit<'a> {
    for _ in 0..REVISIONS {
        if fit.model.causes.len() < 2 {
            break;
        }
        let better = exchanged(all, &fit, &fresh).or_else(|| merged(all, &fit, &fresh));
        let Some(better) = better else { break };
        let come = better.model.causes.iter().filter(|t| !fit.model.has(t.candidate));
        let gone = fit.model.causes.iter().filter(|t| !better.model.has(t.candidate));
        fresh = come.chain(gone).map(|t| t.candidate).collect();
        fit = better;
    }
    fit
}

/// Without those of `these` that do not earn their places, the weakest first.
pub fn pruned<'a>(
    all: &Hypotheses<'a>,
    mut fit: Fit<'a>,
    these: impl Fn(Candidate) -> bool,
) -> Fit<'a> {
    let fewer = |fit: &Fit<'a>| {
        let causes = fit.model.causes.iter().enumerate();
        let asked: Vec<usize> =
            causes.filter(|(_, t)| these(t.candidate)).map(|(i, _)| i).collect();
        let without = asked.into_par_iter().map(|i| all.without(fit, i));
        let best = without.max_by(|a, b| all.worth(a).total_cmp(&all.worth(b)))?;
        (all.worth(fit) - all.worth(&best) < all.criteria.least_nats).then_some(best)
    };
    while let Some(without) = fewer(&fit) {
        fit = without;
    }
    fit
}

fn exchanged<'a>(all: &Hypotheses<'a>, fit: &Fit<'a>, fresh: &[Candidate]) -> Option<Fit<'a>> {
    let meets = |c: Candidate| fresh.iter().any(|f| f.extent().meets(c.extent()));
    let indices = (0..fit.model.causes.len()).filter(|i| meets(fit.model.causes[*i].candidate));
    let indices: Vec<usize> = indices.collect();
    let slopes = slopes(fit);
    indices.into_iter().find_map(|i| {
        let cause = fit.model.causes[i].candidate;
        let without = refined(all, all.without(fit, i), &slopes, cause.extent());
        let mine = fit.ln_evidence() - without.ln_evidence() - all.ln_rivals();
        // As rivals are seen: beside what the others may come to without it.
        let mine = mine.max(all.tried(&without, &fit.sizes, &fit.model.causes[i]).nats);
        if mine < all.criteria.least_nats {
            return Some(without);
        }
        let ranked = all.rivals(fit, &without, (cause, f64::INFINITY), WEIGHED / 2);
        let best = ranked.into_iter().find(|h| h.at_bound.is_none())?;
        (best.nats > mine + all.criteria.least_nats).then_some(best.fit)
    })
}

/// How the torque of each cause changes with its nonlinear values, at the joints it acts on.
fn slopes(fit: &Fit<'_>) -> Vec<(Candidate, Vec<Raw>)> {
    let causes = fit.model.causes.iter().enumerate().filter(|(_, t)| !t.searched.is_empty());
    causes.map(|(k, t)| (t.candidate, of_cause(fit, k))).collect()
}

/// Without a cause at `extent` the others may be elsewhere: those whose values gain by a step are
/// searched again.
fn refined<'a>(
    all: &Hypotheses<'a>,
    mut fit: Fit<'a>,
    slopes: &[(Candidate, Vec<Raw>)],
    extent: Extent,
) -> Fit<'a> {
    for (cause, slopes) in slopes.iter().filter(|(c, _)| c.extent().meets(extent)) {
        let Some(i) = fit.model.causes.iter().position(|t| t.candidate == *cause) else { continue };
        let columns = Column::all(slopes, &fit.metric);
        let unknown = vec![f64::INFINITY; columns.len()];
        let step = fit.system.project(&columns, &unknown);
        let (_, gain) = step.solve(&Bounds::unbounded(columns.len()));
        if gain <= all.criteria.least_nats {
            continue;
        }
        let others = Fit::new(all.data, fit.model.without(i), fit.sizes.clone());
        let trial = trial::tried(&others, &fit.model.causes[i]);
        let trial = refine::refine(&others, &trial);
        let better = all.tuned(Adopted::new(&others, trial).fit, &all.touched(*cause));
        if better.ln_evidence() > fit.ln_evidence() {
            fit = better;
        }
    }
    fit
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Settings;
    use crate::diagnosis::candidate::{Place, Term};
    use crate::diagnosis::criteria::Criteria;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::effects::find;
    use crate::regression::random_effects::STEPS;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const DELAY_S: f64 = 0.03;
    const FOUND_S: f64 = 0.015;

    /// A delay that was found too short, beside an offset that is not there: without the offset the
    /// delay moves to where it is.
    #[test]
    fn values_found_beside_what_goes_are_searched_again() {
        let twin = Twin::default();
        let mut made = samples(6, 3000, |j, t| 0.7 * ((1.1 + 0.2 * j as f64) * t).sin());
        let late = (DELAY_S / made.dt).round() as usize;
        let torque = twin.torque(&twin.motion(&made));
        made.torque =
            torque.map_joints(|_, t| (0..t.len()).map(|k| t[k.saturating_sub(late)]).collect());
        noisy(&mut made, 0.05);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&observed]);
        let delay = Candidate::new(find("time_delay").unwrap(), Place::Arm);
        let offset = Candidate::new(find("current_offset").unwrap(), Place::Joint(1));
        let criteria = Criteria::default();
        let all = Hypotheses { data: &data, candidates: vec![delay, offset], criteria };
        let state = Fit::plain(&data, Model::of(&twin));
        let too_short = trial::tried(&state, &Term::new(delay, vec![FOUND_S])).term();
        let model = state.model.with(too_short).with(Term::new(offset, vec![]));
        let revised = revised(&all, Fit::plain(&data, model), vec![offset]);
        assert!(!revised.model.has(offset) && revised.model.has(delay));
        let found = revised.values(0)[0];
        assert!((found - late as f64 * made.dt).abs() < 1e-3, "{found} s");
    }

    /// An offset beside a discrepancy that it does not need: what looks nearly the same is not better for being seen without
    /// one.
    #[test]
    fn a_cause_is_seen_as_its_rivals_are() {
        const JOINT: usize = 1;
        let twin = Twin::default();
        let mut made = samples(6, 3000, |j, t| 0.7 * ((1.1 + 0.2 * j as f64) * t).sin());
        made.torque = twin.torque(&twin.motion(&made));
        made.torque.joint_mut(JOINT).iter_mut().for_each(|t| *t += 1.0);
        noisy(&mut made, 0.3);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let exact = Settings { mass_error: 0.0, ..Settings::default() };
        let data = Data::new(vec![&observed], &exact);
        let at = |name: &str| Candidate::new(find(name).unwrap(), Place::Joint(JOINT));
        let [offset, asymmetry] = ["current_offset", "coulomb_asymmetry"].map(at);
        let (candidates, criteria) = (vec![offset, asymmetry], Criteria::default());
        let all = Hypotheses { data: &data, candidates, criteria };
        let model = Model::of(&twin).with(Term::new(offset, vec![]));
        let mut sizes = data.nothing();
        sizes.joints[JOINT].fill(STEPS);
        let fit = Fit::new(&data, model, sizes);
        let without = all.without(&fit, 0);
        let as_it_is = fit.ln_evidence() - without.ln_evidence() - all.ln_rivals();
        let rival = all.rivals(&fit, &without, (offset, f64::INFINITY), WEIGHED).remove(0);
        assert!(rival.nats > as_it_is + criteria.least_nats, "{} {as_it_is}", rival.nats);
        assert!(exchanged(&all, &fit, &[offset]).is_none());
    }
}
