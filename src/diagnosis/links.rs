//! Inertial parameters of all links as one cause: what single causes cannot stand for.
//!
//! Every link has a change of mass and of first moments of its own, the same at all joints. So many
//! values are weighed last, beside what single causes have found, which then have to earn their places
//! beside them: the evidence of the whole model decides. How far links are expected to be from the
//! twin's is what the data say, one among a few spreads.

use super::Value;
use super::bound::is_impossible;
use super::candidate::{Candidate, Place};
use super::fit::Fit;
use super::hypotheses::{Hypotheses, Hypothesis};
use super::revise::pruned;
use super::screen::screen;
use super::search::{Found, grown, tell};
use crate::effects::find;

/// Multiples of what CAD is commonly wrong by: from that to links that are off several times.
const SPREADS: [f64; 3] = [1.0, 3.0, 10.0];

/// All links, as far from the twin's as `spread` times what is common.
fn all_links(links: usize, spread: f64) -> Option<Candidate> {
    let effect = find("link_inertia")?;
    Some(Candidate { spread, ..Candidate::new(effect, Place::Links(links)) })
}

/// What was found with all links beside it, where the evidence of the whole model is for them.
pub fn with_links<'a>(all: &Hypotheses<'a>, found: &Found<'a>) -> Option<Found<'a>> {
    let effect = |name: &str| all.candidates.iter().any(|c| c.name() == name);
    let dof = all.data.twin.robot.dof();
    let groups = SPREADS.iter().filter_map(|&spread| all_links(dof, spread));
    let groups: Vec<Candidate> = groups.filter(|c| effect(c.name())).collect();
    let with_group = |state: &Fit<'a>| {
        let ranked = all.weigh(state, screen(state, &groups), groups.len());
        ranked.into_iter().next().filter(|h| h.at_bound.is_none())
    };
    let gained = |fit: &Fit<'a>| all.gained(&found.start, fit);
    let least = gained(&found.last) + all.criteria.least_nats;
    let earns = |h: &Hypothesis<'a>| gained(&h.fit) >= least;
    let best = with_group(&found.last).filter(earns);
    // Beside the loads that stood in for links they earn little: then in their place.
    let instead = || with_group(&unladen(all, &found.last)?).filter(earns);
    let best = best.or_else(instead)?;
    let group = best.candidate();
    // What stood in for links goes.
    let fit = pruned(all, best.fit, |c| c != group);
    let better = gained(&fit) >= least;
    let i = fit.model.causes.iter().position(|t| t.candidate == group)?;
    let stand = better && !is_impossible(&fit, i);
    let more = stand.then(|| grown(all, Found { last: fit, ..found.clone() }, 0))?;
    tell(all, more.rounds.len(), 0);
    more.last.model.has(group).then_some(more)
}

/// The fit without the loads among its causes; `None` where there are none.
fn unladen<'a>(all: &Hypotheses<'a>, fit: &Fit<'a>) -> Option<Fit<'a>> {
    let mut model = fit.model.clone();
    model.causes.retain(|t| !t.candidate.is_load());
    (model.causes.len() < fit.model.causes.len())
        .then(|| all.tuned(Fit::new(all.data, model, fit.sizes.clone()), &[]))
}

/// Are all links among the causes of a fit?
pub fn stand(fit: &Fit<'_>) -> bool {
    fit.model.causes.iter().any(|t| matches!(t.candidate.place, Place::Links(_)))
}

/// What to do about all links; `None` for other causes.
pub fn remedy(candidate: Candidate) -> Option<&'static str> {
    matches!(candidate.place, Place::Links(_)).then_some(
        "take the mended twin, or let `armtwin identify --with inertia --save-urdf FILE` find the links \
         with their inertia and write them as a URDF",
    )
}

/// Joints of a cause, from 1: of all links those of which its values say for sure that they are off.
pub fn told(candidate: Candidate, values: &[Value]) -> Vec<usize> {
    let Place::Links(_) = candidate.place else { return candidate.place.joints() };
    let off = |joint: &usize| {
        let own = values.iter().filter(|v| v.joint == Some(*joint));
        own.into_iter().any(|v| v.low > 0.0 || v.high < 0.0)
    };
    candidate.place.joints().into_iter().filter(off).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::{Diagnosis, Settings, diagnose};
    use crate::signals::Samples;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    /// A run of an arm; its path depends on `speed`.
    fn recorded(arm: &Twin, speed: f64) -> Samples {
        let mut arm = arm.clone();
        arm.values.insert("coulomb".into(), vec![5.0, 6.0, 4.0, 1.5, 1.2, 1.0]);
        arm.values.insert("viscous".into(), vec![9.0, 10.0, 7.0, 2.0, 1.5, 1.0]);
        let mut made = samples(6, 4000, |j, t| {
            let w = speed + 0.31 * j as f64;
            0.7 * (w * t).sin() + 0.4 * (0.43 * w * t + j as f64).cos()
        });
        made.torque = arm.torque(&arm.motion(&made));
        noisy(&mut made, 0.3);
        made
    }

    fn diagnosed(arm: &Twin) -> Diagnosis {
        diagnosed_with(arm, &Settings::default())
    }

    fn diagnosed_with(arm: &Twin, settings: &Settings) -> Diagnosis {
        let [fit, check] = [1.1, 1.4].map(|speed| recorded(arm, speed));
        diagnose(&Twin::default(), &fit, &check, settings).unwrap()
    }

    /// An arm whose links are off by these factors in turn.
    fn off_by(factors: [f64; 2]) -> Twin {
        let mut arm = Twin::default();
        for (i, body) in arm.robot.bodies.iter_mut().enumerate() {
            let factor = factors[i % 2];
            body.inertia.mass *= factor;
            body.inertia.about_com *= factor;
        }
        arm
    }

    /// Within a few tolerances of all links and of all scales of torque together: no cause, but told.
    #[test]
    fn many_links_a_little_off_are_told() {
        let found = diagnosed(&off_by([1.3, 0.7]));
        assert!(found.causes.iter().all(|c| c.effect == "link_inertia"), "{:?}", found.causes);
        let told = |note: &String| note.contains("more than the 5 % it is said to be known to");
        assert!(!found.causes.is_empty() || found.notes.iter().any(told), "{:?}", found.notes);
    }

    /// The same where the arm is known better: links are named, and nothing else; a few stand for all, for a link's
    /// values make up for those of its neighbours.
    #[test]
    fn many_links_a_little_off_are_named_where_the_arm_is_known() {
        let known = Settings { mass_error: 0.01, centre_error_m: 0.001, ..Settings::default() };
        let found = diagnosed_with(&off_by([1.3, 0.7]), &known);
        assert!(!found.causes.is_empty());
        assert!(found.causes.iter().all(|c| c.effect == "link_inertia"), "{:?}", found.causes);
        let [share, ..] = found.shrink.torque.above_noise().unwrap();
        assert!(share > 0.9, "{:?}", found.shrink.torque);
    }

    #[test]
    fn many_links_off_are_one_cause() {
        let found = diagnosed(&off_by([2.0, 0.5]));
        let [cause] = &found.causes[..] else { panic!("{:?}", found.causes) };
        assert_eq!(cause.effect, "link_inertia");
        assert!(cause.joints.len() > 1 && cause.parameters.len() == 4 * 6, "{cause:?}");
        assert!(cause.shrink.fraction > 0.9, "{:?}", cause.shrink);
    }

    /// What one load explains is not spread over all links.
    #[test]
    fn a_load_is_no_change_of_all_links() {
        let mut arm = Twin::default();
        arm.effects.push("payload".into());
        for (name, value) in [("payload_mass", 2.0), ("payload_moment_z", 0.2)] {
            arm.values.insert(name.into(), vec![value]);
        }
        for name in ["payload_moment_x", "payload_moment_y"] {
            arm.values.insert(name.into(), vec![0.0]);
        }
        let found = diagnosed(&arm);
        assert!(found.causes.iter().all(|c| c.joints.len() < 2), "{:?}", found.causes);
        assert_eq!(found.causes[0].effect, "payload");
    }

    /// A light load has little inertia, which costs it nothing: it is named, though the last links may be heavier.
    #[test]
    fn a_light_load_is_named() {
        let mut arm = Twin::default();
        arm.effects.push("payload".into());
        let values = [("mass", 0.15), ("moment_x", 0.0), ("moment_y", 0.0), ("moment_z", 0.012)];
        for (name, value) in values {
            arm.values.insert(format!("payload_{name}"), vec![value]);
        }
        let found = diagnosed(&arm);
        let [cause] = &found.causes[..] else { panic!("{:?}", found.causes) };
        let equals = cause.equivalent.iter().map(|e| e.effect.as_str());
        assert!(equals.chain([cause.effect.as_str()]).any(|e| e == "payload"), "{cause:?}");
        let mass = cause.parameters.iter().find(|v| v.name.ends_with("_mass")).unwrap();
        assert!(mass.low < 0.15 && 0.15 < mass.high, "{mass:?}");
    }

    /// A long tool is no point at its centre: its inertia is a value of the load, and no link is called heavier
    /// beside it.
    #[test]
    fn a_load_that_is_spread_out_is_one_load() {
        let mut arm = Twin::default();
        arm.effects.push("payload".into());
        let inertia = [("xx", 0.12), ("yy", 0.12), ("zz", 0.005)];
        let values = [("mass", 2.0), ("moment_x", 0.0), ("moment_y", 0.0), ("moment_z", 0.3)];
        for (name, value) in values {
            arm.values.insert(format!("payload_{name}"), vec![value]);
        }
        for (axis, value) in inertia {
            arm.values.insert(format!("payload_inertia_{axis}"), vec![value]);
        }
        let found = diagnosed(&arm);
        let [cause] = &found.causes[..] else { panic!("{:?}", found.causes) };
        let told = |name: &str| cause.read().into_iter().find(|v| v.name == name).cloned();
        let holds = |name: &str, truth: f64| {
            let value = told(name).unwrap_or_else(|| panic!("no {name}: {cause:?}"));
            assert!(value.low <= truth && truth <= value.high, "{value:?}");
        };
        assert_eq!(cause.effect, "payload");
        for (name, truth) in [("payload_mass", 2.0), ("payload_centre_z", 0.15)] {
            holds(name, truth);
        }
        for (axis, truth) in &inertia[..2] {
            holds(&format!("payload_inertia_{axis}"), *truth);
        }
        assert!(told("payload_moment_z").is_none() && told("payload_inertia_xy").is_none());
    }

    #[test]
    fn sets_of_values_are_kept_apart() {
        let twin = Twin::default();
        let all = all_links(6, 3.0).unwrap();
        let one = Candidate::new(all.effect, Place::Joint(2));
        assert_eq!(all.linear(), 24);
        assert_eq!(
            all.expected(&twin, &[0.0; 24])[8..12],
            one.expected(&twin, &[0.0; 4]).iter().map(|s| 3.0 * s).collect::<Vec<_>>()
        );
        let named: Vec<_> = all.parameters().map(|(p, joint)| (p.name, joint)).collect();
        assert_eq!(named[9], ("link_moment_x", Some(2)));
        assert_eq!(named[24], ("link_mass_reference", Some(0)));
        let linear: Vec<f64> = (0..24).map(|i| 0.01 * f64::from(i)).collect();
        let mut references = vec![0.0; 24];
        all.settle(&linear, &mut references);
        assert_eq!(references, linear);
    }
}
