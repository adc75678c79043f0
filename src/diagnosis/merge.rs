//! One cause for the whole arm in place of the same effect at single joints: all its sensors are read at one time. Its
//! drives are of several sizes, and may each lack the same by another amount.

use super::candidate::{Candidate, Place};
use super::fit::Fit;
use super::hypotheses::{Hypotheses, covers};
use super::screen::screen;

/// The fit with one cause in the sensors of the whole arm in place of those at single joints, one of them `fresh`,
/// where that is ahead.
pub fn merged<'a>(all: &Hypotheses<'a>, fit: &Fit<'a>, fresh: &[Candidate]) -> Option<Fit<'a>> {
    let new = |whole: &&Candidate| {
        let part = |c: &Candidate| fit.model.has(*c) && stands_for(whole, c);
        whole.senses() && fresh.iter().any(part)
    };
    let wholes: Vec<Candidate> = all.open(&fit.model).iter().filter(new).copied().collect();
    wholes.into_iter().find_map(|whole| {
        let mut model = fit.model.clone();
        model.causes.retain(|t| !stands_for(&whole, &t.candidate));
        let without = Fit::new(all.data, model, fit.sizes.clone());
        let without = all.tuned(without, &all.touched(whole));
        let best = all.weigh(&without, screen(&without, &[whole]), 1).into_iter().next()?;
        let ahead = all.worth(&best.fit) - all.worth(fit) > all.criteria.least_nats;
        (best.at_bound.is_none() && ahead).then_some(best.fit)
    })
}

/// Is `part` the same effect at one joint?
fn stands_for(whole: &Candidate, part: &Candidate) -> bool {
    matches!(part.place, Place::Joint(_)) && covers(whole, part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::Term;
    use crate::diagnosis::criteria::Criteria;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::effects::find;
    use crate::signals::Samples;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const DELAY_S: f64 = 0.024;

    fn moving() -> Samples {
        samples(6, 3000, |j, t| 0.7 * ((1.1 + 0.2 * j as f64) * t).sin())
    }

    /// Does an effect of these nonlinear values at two joints become one of the whole arm?
    fn becomes_one(mut made: Samples, effect: &str, nonlinear: &[f64]) -> bool {
        let twin = Twin::default();
        noisy(&mut made, 0.05);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&observed]);
        let effect = find(effect).unwrap();
        let of = |place| Candidate::new(effect, place);
        let (whole, parts) = (of(Place::Arm), [of(Place::Joint(1)), of(Place::Joint(2))]);
        let candidates = [&parts[..], &[whole]].concat();
        let all = Hypotheses { data: &data, candidates, criteria: Criteria::default() };
        let with = |m: Model, p: &Candidate| m.with(Term::new(*p, nonlinear.to_vec()));
        let model = parts.iter().fold(Model::of(&twin), with);
        let merged = merged(&all, &Fit::plain(&data, model), &parts[..1]);
        merged.is_some_and(|fit| fit.model.has(whole) && fit.model.causes.len() == 1)
    }

    /// An arm whose first joints are late.
    fn late(joints: usize) -> Samples {
        let (twin, mut made) = (Twin::default(), moving());
        let late = (DELAY_S / made.dt).round() as usize;
        made.torque = twin.torque(&twin.motion(&made)).map_joints(|j, t| {
            let late = if j < joints { late } else { 0 };
            (0..t.len()).map(|k| t[k.saturating_sub(late)]).collect()
        });
        made
    }

    #[test]
    fn a_delay_that_all_joints_have_alike_is_one_cause() {
        assert!(becomes_one(late(6), "time_delay", &[DELAY_S]));
        assert!(!becomes_one(late(3), "time_delay", &[DELAY_S]));
    }

    #[test]
    fn what_all_drives_have_alike_stays_theirs() {
        const BY_SPEED: f64 = -10.0;
        let (twin, mut made) = (Twin::default(), moving());
        let law = find("viscous_quadratic").unwrap();
        let motion = twin.motion(&made);
        let mut torque = twin.torque(&motion);
        for j in 0..6 {
            let column = law.columns(&motion, j, &[]).swap_remove(0);
            torque.joint_mut(j).iter_mut().zip(column).for_each(|(t, c)| *t += BY_SPEED * c);
        }
        made.torque = torque;
        assert!(!becomes_one(made, "viscous_quadratic", &[]));
    }
}
