//! Which of what a search finds is called a cause.

use rayon::prelude::*;

use super::blind::Blind;
use super::bound::is_impossible;
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
    /// Those of them that both recordings show together, and the fit recording alone does not: they are in the model,
    /// and have no name of their own.
    pub unconfirmed: Vec<Candidate>,
    /// Where a proof decided: what it cannot tell from each cause.
    pub equals: Option<Vec<Vec<Candidate>>>,
}

/// What stands of the search of both recordings: causes that are more probable than not, gain on the check
/// recording, and sit at no bound. What does not is left out, the weakest first, and the others are seen again
/// without it. Where the law is not exact, the search of the fit recording alone has to find the cause too, or it gets no name.
pub fn called<'a>(
    search: &Hypotheses<'a>,
    judge: &Judge<'_>,
    found: &Found<'a>,
    blind: &Blind<'_, '_>,
) -> Called<'a> {
    let mut fit = found.last.clone();
    let mut rejected = Vec::new();
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
        let law = |i: &usize| {
            gains[*i].needs_replication(fit.model.causes[*i].candidate, &search.criteria)
        };
        let laws = (0..count).filter(law).map(|i| (&standings[i], &gains[i]));
        let unconfirmed = blind.misses(&fit.model, laws);
        return Called { fit, standings, gains, unconfirmed, equals: None };
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
    if let Some(inside) = tamed(fit, standings) {
        return Some(inside);
    }
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

/// The fit with a cause inside its range that a search let wander out of it, where that is as good.
fn tamed<'a>(fit: &Fit<'a>, standings: &[Standing<'a>]) -> Option<Fit<'a>> {
    let inside = |h: &&Hypothesis<'a>| {
        h.at_bound.is_none() && !is_impossible(&h.fit, h.fit.model.causes.len() - 1)
    };
    let wandered = (0..standings.len()).filter(|i| is_impossible(fit, *i));
    wandered.map(|i| standings[i].cause()).find(inside).map(|h| h.fit.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Settings;
    use crate::diagnosis::candidate::{Place, Term};
    use crate::diagnosis::criteria::Criteria;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::independent::counted;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::effects::find;
    use crate::signals::Samples;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const JOINT: usize = 1;
    const OFFSET_NM: f64 = 2.0;
    const NOISE_NM: f64 = 0.3;

    /// An arm with an offset at a joint, and there something that no law describes.
    fn recorded(speed: f64) -> Samples {
        let twin = Twin::default();
        let mut made = samples(6, 4000, |j, t| 0.7 * ((speed + 0.2 * j as f64) * t).sin());
        made.torque = twin.torque(&twin.motion(&made));
        let (own, next) = (made.q.joint(JOINT).to_vec(), made.q.joint(JOINT + 1).to_vec());
        let odd = own.iter().zip(&next).map(|(a, b)| (3.0 * a + 2.0 * b).sin());
        let torque = made.torque.joint_mut(JOINT).iter_mut();
        torque.zip(odd).for_each(|(t, odd)| *t += OFFSET_NM + odd);
        noisy(&mut made, NOISE_NM);
        made
    }

    /// A search that finds a candidate, or nothing.
    fn found<'a>(search: &Hypotheses<'a>, candidate: Option<Candidate>) -> Found<'a> {
        let joints: Vec<usize> = (0..6).collect();
        let fitted = |model: Model| search.tuned(Fit::plain(search.data, model), &joints);
        let start = fitted(Model::of(search.data.twin));
        let with = |c: Candidate| fitted(start.model.with(Term::new(c, vec![])));
        let last = candidate.map_or_else(|| start.clone(), with);
        Found { start, last, rounds: vec![], screened: vec![] }
    }

    /// What is called where the search of the fit recording alone finds the offset, or nothing.
    fn found_by(both: bool) -> (Vec<Candidate>, Vec<Candidate>) {
        let twin = Twin::default();
        let made = [recorded(1.1), recorded(1.4)];
        let floors = made.each_ref().map(|s| noise_floor(s, &twin));
        let [fit, check] = [0, 1].map(|i| Observed::new(i, &twin, &made[i], &floors[i]).unwrap());
        let settings = Settings::default();
        let [one, other, all] =
            [vec![&fit], vec![&check], vec![&fit, &check]].map(|parts| Data::new(parts, &settings));
        let offset = Candidate::new(find("current_offset").unwrap(), Place::Joint(JOINT));
        // Rows that already count as they do beside the offset: there is nothing to see again.
        let with_offset = Model::of(&twin).with(Term::new(offset, vec![]));
        let one = counted(&one, &with_offset);
        let search =
            |data| Hypotheses { data, candidates: vec![offset], criteria: Criteria::default() };
        let [alone, search] = [search(&one), search(&all)];
        let judge = Judge { fit: &one, check: &other, criteria: Criteria::default() };
        let [own, found] = [found(&alone, both.then_some(offset)), found(&search, Some(offset))];
        let called = called(&search, &judge, &found, &Blind::new(&alone, &own));
        let causes = called.fit.model.causes.iter().map(|t| t.candidate).collect();
        (causes, called.unconfirmed)
    }

    #[test]
    fn what_the_fit_recording_alone_does_not_show_stays_in_the_model_without_a_name() {
        let [(there, none), (too, open)] = [true, false].map(found_by);
        assert_eq!((there.len(), none.len()), (1, 0));
        assert_eq!((too.len(), open.len()), (1, 1));
    }

    /// LuGre friction whose bristles move within a third of a milliradian: how they are damped hardly shows, here
    /// with the wrong sign.
    #[test]
    fn a_value_that_wandered_out_of_its_range_is_taken_inside() {
        let twin = Twin::default();
        let mut made = samples(6, 4000, |j, t| 0.7 * ((1.1 + 0.2 * j as f64) * t).sin());
        let lugre = find("lugre").unwrap();
        let (motion, shape) = (twin.motion(&made), vec![3e-4, 0.5, 0.1]);
        let [bristle, rate] = &lugre.columns(&motion, JOINT, &shape)[..] else { panic!() };
        let friction = bristle.iter().zip(rate).map(|(z, rate)| 6.0 * z - 10.0 * rate);
        let friction: Vec<f64> = friction.collect();
        let mut torque = twin.torque(&motion);
        torque.joint_mut(JOINT).iter_mut().zip(friction).for_each(|(t, f)| *t += f);
        made.torque = torque;
        noisy(&mut made, NOISE_NM);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&observed]);
        let candidate = Candidate::new(lugre, Place::Joint(JOINT));
        let search =
            Hypotheses { data: &data, candidates: vec![candidate], criteria: Criteria::default() };
        let model = Model::of(&twin).with(Term::new(candidate, shape));
        let fit = Fit::plain(&data, model);
        assert!(is_impossible(&fit, 0), "{:?}", fit.values(0));
        let inside = tamed(&fit, &search.standings(&fit)).unwrap();
        let [level, damping] = [0, 1].map(|k| inside.values(0)[k]);
        assert!((level - 6.0).abs() < 0.3 && damping == 0.0, "{level} {damping}");
    }
}
