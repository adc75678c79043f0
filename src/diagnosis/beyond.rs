//! What lies beyond the limits that a twin states, as causes: after a search, for little evidence speaks for them in one.

use super::candidate::{Candidate, Place, Term};
use super::fit::Fit;
use super::hypotheses::Hypotheses;
use super::limits::Stated;
use super::search::Found;

/// What was found, with all that is beyond its limit among the causes, the surest first, each given those before it.
pub fn with_what_is_beyond<'a>(all: &Hypotheses<'a>, mut found: Found<'a>) -> Found<'a> {
    let mut asked = Vec::new();
    loop {
        let beyond = surely_beyond(all, &found.last, &asked);
        let Some(surest) = beyond.first() else { break };
        match freed(all, &found.last, &beyond) {
            Some(fit) => found.last = fit,
            None => asked.push(*surest),
        }
    }
    found
}

/// The fit with the first of these as a cause or, where there are several, with one for all joints alike if that has more
/// evidence; `None` where either is at a bound.
fn freed<'a>(all: &Hypotheses<'a>, fit: &Fit<'a>, beyond: &[Candidate]) -> Option<Fit<'a>> {
    let surest = *beyond.first()?;
    let alike = (beyond.len() > 1).then_some(Candidate { place: Place::Arm, ..surest });
    let open = [Some(surest), alike].into_iter().flatten().filter(|c| is_open(all, fit, *c));
    let tried = open.filter_map(|c| {
        let start = c.starts(&fit.motion(), fit.data.twin).into_iter().next()?;
        Some(all.tried(fit, &fit.sizes, &Term::new(c, start)))
    });
    let inside = tried.filter(|h| h.at_bound.is_none());
    inside.max_by(|a, b| a.nats.total_cmp(&b.nats)).map(|h| h.fit)
}

/// May it be added?
fn is_open(all: &Hypotheses<'_>, fit: &Fit<'_>, candidate: Candidate) -> bool {
    all.candidates.contains(&candidate) && !fit.model.has(candidate)
}

/// What is surely enough beyond its limit, the surest first; not what was `asked` before.
fn surely_beyond(all: &Hypotheses<'_>, fit: &Fit<'_>, asked: &[Candidate]) -> Vec<Candidate> {
    let open = |c: &Candidate| is_open(all, fit, *c) && !asked.contains(c);
    let stated = Stated::new(fit).and_then(|stated| stated.beyond(all.criteria.coverage));
    let each = stated.into_iter().flatten();
    let mut sure: Vec<_> = each.filter(|(c, o)| *o > all.criteria.least_nats && open(c)).collect();
    sure.sort_by(|a, b| b.1.total_cmp(&a.1));
    sure.into_iter().map(|(c, _)| c).collect()
}

#[cfg(test)]
mod tests {
    use crate::diagnosis::{Cause, Criteria, Settings, diagnose};
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    /// Stands for how a motion is made.
    const SPEEDS: [f64; 2] = [1.1, 1.4];
    const KNOWN_TO: f64 = 0.05;
    const OTHERS: f64 = 0.04;
    const COVERAGE: f64 = 2.0;
    const LINK: usize = 2;
    const JOINT: usize = 1;

    /// What is called of an arm whose links and drives are off by these shares, one after the other.
    fn called(links: [f64; 6], drives: [f64; 6], coverage: f64) -> Vec<Cause> {
        let mut arm = Twin::default();
        for (body, off) in arm.robot.bodies.iter_mut().zip(links) {
            body.inertia = body.inertia.scaled(1.0 + off);
        }
        let recorded = |speed: f64| {
            let mut made = samples(6, 4000, |j, t| {
                let w = speed + 0.31 * j as f64;
                0.7 * (w * t).sin() + 0.4 * (0.43 * w * t + j as f64).cos()
            });
            let torque = arm.torque(&arm.motion(&made));
            made.torque =
                torque.map_joints(|j, t| t.iter().map(|t| (1.0 + drives[j]) * t).collect());
            noisy(&mut made, 0.3);
            made
        };
        let criteria = Criteria { coverage, ..Criteria::default() };
        let settings = Settings { mass_error: KNOWN_TO, criteria, ..Settings::default() };
        let [fit, check] = SPEEDS.map(recorded);
        diagnose(&Twin::default(), &fit, &check, &settings).unwrap().causes
    }

    /// Others are off too, up and down in turn.
    fn one(at: usize, off: f64, others: f64) -> [f64; 6] {
        let mut all = [others, -others, others, -others, others, -others];
        all[at] = off;
        all
    }

    /// Evidence cannot tell it from what all the drives are said to be known to.
    #[test]
    fn a_drive_further_off_than_it_is_known_to_is_a_cause() {
        for off in [0.18, -0.18] {
            let of = |c: &&Cause| c.effect == "torque_constant" && c.joints == [JOINT + 1];
            let by_evidence = called([0.0; 6], one(JOINT, off, OTHERS), f64::INFINITY);
            assert!(!by_evidence.iter().any(|c| of(&c)), "{off}: {by_evidence:?}");
            let causes = called([0.0; 6], one(JOINT, off, OTHERS), COVERAGE);
            let cause = causes.iter().find(of).unwrap_or_else(|| panic!("{off}: {causes:?}"));
            let gain = &cause.parameters[0];
            assert!(gain.low < off && off < gain.high, "{off}: {gain:?}");
        }
    }

    #[test]
    fn drives_that_are_all_off_alike_are_one_cause() {
        let causes = called([0.0; 6], [0.2, 0.19, 0.21, 0.2, 0.18, 0.22], COVERAGE);
        let of = |c: &&Cause| c.effect == "torque_constant";
        let places: Vec<&[usize]> = causes.iter().filter(of).map(|c| &c.joints[..]).collect();
        assert_eq!(places, [&[] as &[usize]], "{causes:?}");
    }

    #[test]
    fn what_is_off_as_it_is_said_to_be_is_none() {
        let causes = called(one(LINK, 0.04, 0.01), one(JOINT, 0.03, OTHERS), COVERAGE);
        assert!(causes.is_empty(), "{causes:?}");
    }
}
