//! Probabilities: what is at work, beside rivals, nothing, and a discrepancy of any shape.

use super::candidate::Candidate;
use super::criteria::Criteria;
use super::findings::Findings;
use super::fit::Fit;
use super::hypotheses::{Hypothesis, Standing};
use super::judge::Gain;
use super::{Cause, Named, Ranked};

const NONE: &str = "none";
const UNKNOWN: &str = "unknown";

pub fn named(candidate: Candidate) -> Named {
    Named { effect: candidate.name().into(), joints: candidate.place.joints() }
}

/// Probability that a law agrees again, which agreed in so many recordings of so many (Jeffreys' prior). Where it would
/// not, something unknown looks like it.
fn agrees_again(agreed: f64, of: f64) -> f64 {
    (agreed + 0.5) / (of + 1.0)
}

/// What a probability is worth: a law that is not exact was chosen by one recording and confirmed by another, what acts
/// in one of them alone was seen once.
pub fn replicated(probability: f64, candidate: Candidate, gain: &Gain, criteria: &Criteria) -> f64 {
    if gain.needs_replication(candidate, criteria) {
        agrees_again(2.0, 2.0) * probability
    } else if gain.is_untried(candidate) {
        agrees_again(1.0, 1.0) * probability
    } else {
        probability
    }
}

/// Probability that a cause is there: it or what looks the same, beside its other rivals and none of them.
pub fn probability(standing: &Standing<'_>, gain: &Gain, criteria: &Criteria) -> f64 {
    let shares = shares(standing, criteria);
    let usable = standing.ranked.iter().filter(|h| h.at_bound.is_none());
    let set = |h: &Hypothesis<'_>| is_mine(standing, h) || is_equal(standing, gain, h, criteria);
    usable.zip(shares).filter(|(h, _)| set(h)).map(|(_, share)| share).sum()
}

pub fn is_mine(standing: &Standing<'_>, h: &Hypothesis<'_>) -> bool {
    h.candidate() == standing.cause().candidate()
}

/// Does it do as well, within what tells nothing ([`Criteria::margin`]), by all that is known or by the data alone? A
/// heavier last link is less expected than a payload, and looks the same.
pub fn is_equal(
    standing: &Standing<'_>,
    gain: &Gain,
    h: &Hypothesis<'_>,
    criteria: &Criteria,
) -> bool {
    let mine = standing.cause();
    let exact = !gain.needs_replication(mine.candidate(), criteria);
    let trusted = |h: &Hypothesis<'_>| criteria.trusted(h.nats);
    let near = |mine: f64, other: f64| mine - other < criteria.margin(mine, exact);
    let as_well = |mine: f64, other: f64| other > 0.0 && near(mine, other);
    let by_all = || as_well(trusted(mine), trusted(h));
    let by_data = || !standing.beyond && as_well(standing.shown(mine), standing.shown(h));
    !is_mine(standing, h) && h.at_bound.is_none() && (by_all() || by_data())
}

/// Probabilities of the hypotheses not rejected, in order; the last: the other causes alone are at work.
fn shares(standing: &Standing<'_>, criteria: &Criteria) -> Vec<f64> {
    let usable = standing.ranked.iter().filter(|h| h.at_bound.is_none());
    let nats: Vec<f64> = usable.map(|h| h.nats).chain([0.0]).collect();
    criteria.probabilities(&nats)
}

/// What looks the same as a cause.
pub fn equivalents(standing: &Standing<'_>, gain: &Gain, criteria: &Criteria) -> Vec<Named> {
    let others = standing.ranked.iter().filter(|h| is_equal(standing, gain, h, criteria));
    // It is the same name in one recording and in all.
    let own = named(standing.cause().candidate());
    others.map(|h| named(h.candidate())).filter(|other| *other != own).collect()
}

/// The strongest cause's rivals, "none" and "unknown": what is at work first of all.
pub fn ranking(findings: &Findings<'_>) -> Vec<Ranked> {
    let criteria = &findings.search.criteria;
    let causes = &findings.last.model.causes;
    let is_open = |i: &usize| findings.unconfirmed.contains(&causes[*i].candidate);
    let strongest = (0..causes.len()).filter(|i| !is_open(i)).max_by(|a, b| {
        let taken = |i: &usize| {
            let s = &findings.gains[*i].shrink;
            s.check_before_nm.powi(2) - s.check_after_nm.powi(2)
        };
        taken(a).total_cmp(&taken(b))
    });
    let (mut rows, rest): (Vec<(Candidate, f64)>, &Fit<'_>) = match strongest {
        Some(i) => {
            let standing = &findings.standings[i];
            let usable = standing.ranked.iter().filter(|h| h.at_bound.is_none());
            (usable.map(|h| (h.candidate(), h.nats)).collect(), &standing.without)
        }
        None => {
            let first = findings.found.rounds.first();
            let weighed = first.iter().flat_map(|r| &r.weighed);
            let usable = weighed.filter(|w| w.at_bound.is_none());
            (usable.map(|w| (w.candidate, w.nats)).collect(), &findings.found.start)
        }
    };
    rows.sort_by(|a, b| b.1.total_cmp(&a.1));
    // Nothing at all against a discrepancy: what is not there has no evidence.
    let unknown = rest.evidence_of_discrepancy();
    let [none, unknown] = if unknown > 0.0 { [-unknown, 0.0] } else { [0.0, unknown] };
    let nats: Vec<f64> = rows.iter().map(|r| r.1).chain([none, unknown]).collect();
    let mut shares = criteria.probabilities(&nats);
    let worth = |(candidate, share): (Candidate, f64)| match strongest {
        Some(i) => replicated(share, causes[i].candidate, &findings.gains[i], criteria),
        // What was found and is not called agreed in one recording, not in the other.
        None if findings.found.last.model.has(candidate) => agrees_again(1.0, 2.0) * share,
        None => share,
    };
    let worth: Vec<f64> = rows.iter().map(|r| r.0).zip(shares.iter().copied()).map(worth).collect();
    let (laws, rest) = shares.split_at_mut(rows.len());
    let taken: f64 = laws.iter().zip(&worth).map(|(share, worth)| share - worth).sum();
    let instead = instead(strongest.is_some(), [none, unknown], criteria);
    rest.iter_mut().zip(instead).for_each(|(rest, share)| *rest += share * taken);
    laws.copy_from_slice(&worth);
    let mut all: Vec<Ranked> = rows
        .iter()
        .zip(&shares)
        .map(|((candidate, nats), share)| ranked(named(*candidate), *share, *nats))
        .collect();
    let seen = |c: &Candidate| rows.iter().any(|r| r.0 == *c);
    let screened = findings.found.screened.iter().filter(|(c, _)| !seen(c));
    all.extend(screened.map(|(c, nats)| ranked(named(*c), 0.0, *nats)));
    let of = |name: &str| Named { effect: name.into(), joints: vec![] };
    all.push(ranked(of(NONE), shares[rows.len()], none));
    all.push(ranked(of(UNKNOWN), shares[rows.len() + 1], unknown));
    all.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    all
}

/// Shares of nothing and of something unknown in what is not a law: where one is called, what is not it looks like it.
fn instead(called: bool, nats: [f64; 2], criteria: &Criteria) -> Vec<f64> {
    if called { vec![0.0, 1.0] } else { criteria.probabilities(&nats) }
}

fn ranked(named: Named, probability: f64, nats: f64) -> Ranked {
    let Named { effect, joints } = named;
    Ranked { effect, joints, probability, nats: if nats.is_finite() { nats } else { 0.0 } }
}

/// The probability of "unknown".
pub fn unknown(ranking: &[Ranked]) -> f64 {
    ranking.iter().filter(|r| r.effect == UNKNOWN).map(|r| r.probability).sum()
}

/// A cause that torque does not show goes first: what the others share is left by it.
pub fn with_sensor(sensor: &[Cause], mut ranking: Vec<Ranked>) -> Vec<Ranked> {
    for cause in sensor {
        ranking.retain(|r| r.effect != cause.effect || r.joints != cause.joints);
        ranking.iter_mut().for_each(|r| r.probability *= 1.0 - cause.probability);
        let named = Named { effect: cause.effect.clone(), joints: cause.joints.clone() };
        let probability = 1.0 - ranking.iter().map(|r| r.probability).sum::<f64>();
        ranking.insert(0, ranked(named, probability, 0.0));
    }
    ranking
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::Place;
    use crate::diagnosis::{Checked, Diagnosis, Settings, diagnose};
    use crate::effects::find;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    /// An arm whose friction at `JOINT` differs by direction, more so at speed by `viscous`, N.m.s/rad.
    fn diagnosed(viscous: f64) -> Diagnosis {
        let mut arm = Twin::default();
        arm.effects.push("coulomb_asymmetry".into());
        for (name, value) in [("coulomb_asymmetry", 1.5), ("viscous_asymmetry", viscous)] {
            let mut values = vec![0.0; 6];
            values[JOINT] = value;
            arm.values.insert(name.into(), values);
        }
        let [fit, check] = [1.1, 1.4].map(|speed| {
            let mut made = samples(6, 3000, |j, t| 0.7 * ((speed + 0.2 * j as f64) * t).sin());
            made.torque = arm.torque(&arm.motion(&made));
            noisy(&mut made, 0.3);
            made
        });
        diagnose(&Twin::default(), &fit, &check, &Settings::default()).unwrap()
    }

    const JOINT: usize = 1;

    /// A push that the fit recording alone has, a law where nothing but noise is left, and one where more is.
    #[test]
    fn what_was_seen_once_is_less_sure_than_what_was_seen_twice() {
        let criteria = Criteria::default();
        let of = |name: &str, recording: Option<usize>, acts: bool, where_exact: f64| {
            let candidate = Candidate::new(find(name).unwrap(), Place::Arm);
            let shrink = Checked::default();
            let gain = Gain { shrink, where_exact, where_inexact: 0.0, acts };
            replicated(1.0, Candidate { recording, ..candidate }, &gain, &criteria)
        };
        assert_eq!(of("external_contact", Some(0), false, 0.0), 0.75);
        assert_eq!(of("load_friction", None, false, 0.0), 0.75);
        assert_eq!(of("load_friction", None, true, 0.5), 1.0);
        assert!((of("load_friction", None, true, 0.0) - 2.5 / 3.0).abs() < 1e-12);
    }

    fn names(found: &Diagnosis) -> Vec<&str> {
        let [cause] = &found.causes[..] else { panic!("{:?}", found.causes) };
        assert_eq!(cause.joints, [JOINT + 1]);
        let equals = cause.equivalent.iter().map(|e| e.effect.as_str());
        [cause.effect.as_str()].into_iter().chain(equals).collect()
    }

    /// That one of them could have another part besides tells nothing of what is there.
    #[test]
    fn names_of_the_same_torque_are_equals_whatever_else_one_of_them_could_be() {
        let found = diagnosed(0.0);
        let names = names(&found);
        assert!(
            names.contains(&"coulomb_asymmetry") && names.contains(&"current_offset"),
            "{names:?}"
        );
    }

    #[test]
    fn what_is_not_called_leaves_room_for_nothing_or_for_something_unknown() {
        let of = |called, nats| instead(called, nats, &Criteria::default());
        assert!(of(false, [0.0, -20.0])[0] > 0.999 && of(false, [-20.0, 0.0])[1] > 0.999);
        assert_eq!(of(true, [0.0, -20.0]), [0.0, 1.0]);
    }

    #[test]
    fn a_part_that_shows_tells_them_apart() {
        assert_eq!(names(&diagnosed(2.0)), ["coulomb_asymmetry"]);
    }
}
