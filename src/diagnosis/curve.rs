//! Laws of one curve of a joint are one cause.
//!
//! A joint has one curve of viscous friction over velocity, and one along which friction builds up after a reversal. Where a
//! model has two laws of it, the curve bends as neither of them does alone: that is one finding, by the name of the law that
//! takes most off. The mended twin has both.

use super::{Cause, Named};
use crate::effects::{Curve, find};

/// Of causes, what takes most off first: one for each curve of a joint, and the laws that go with it, whose names stand beside its own.
pub fn one_of_each(causes: Vec<Cause>) -> [Vec<Cause>; 2] {
    let [mut named, mut laws] = [Vec::<Cause>::new(), Vec::new()];
    for cause in causes {
        let Some(first) = named.iter_mut().find(|first| are_of_one(first, &cause)) else {
            named.push(cause);
            continue;
        };
        let name = Named { effect: cause.effect.clone(), joints: cause.joints.clone() };
        if !first.equivalent.contains(&name) {
            first.equivalent.push(name);
        }
        laws.push(cause);
    }
    [named, laws]
}

/// Are both laws of the same curve of the same joint?
fn are_of_one(a: &Cause, b: &Cause) -> bool {
    let place = |c: &Cause| (c.joints.clone(), c.recording.clone());
    curve(a).is_some() && curve(a) == curve(b) && place(a) == place(b)
}

fn curve(cause: &Cause) -> Option<Curve> {
    find(&cause.effect)?.law_of()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cause(effect: &str, joint: usize) -> Cause {
        let json = serde_json::json!({
            "effect": effect, "joints": [joint], "probability": 0.83, "equivalent": [], "parameters": [],
            "shrink": { "check_before_nm": 2.0, "check_after_nm": 1.0, "fraction": 0.75, "low": 0.7, "high": 0.8 },
            "found_without_check": true, "cause": "", "remedy": ""
        });
        serde_json::from_value(json).unwrap()
    }

    #[test]
    fn a_curve_of_a_joint_is_one_cause_by_the_law_that_takes_most_off() {
        let all = [
            ("viscous_cubic", 1),
            ("payload", 0),
            ("viscous_quadratic", 1),
            ("viscous_quadratic", 2),
            ("lugre", 1),
            ("presliding", 1),
        ];
        let [named, laws] = one_of_each(all.map(|(effect, joint)| cause(effect, joint)).into());
        let names = |some: &[Cause]| -> Vec<(String, usize)> {
            some.iter().map(|c| (c.effect.clone(), c.joints[0])).collect()
        };
        let is = |some: &[Cause], those: &[(&str, usize)]| {
            names(some) == those.iter().map(|(n, j)| (n.to_string(), *j)).collect::<Vec<_>>()
        };
        let kept = [("viscous_cubic", 1), ("payload", 0), ("viscous_quadratic", 2), ("lugre", 1)];
        assert!(is(&named, &kept), "{named:?}");
        assert!(is(&laws, &[("viscous_quadratic", 1), ("presliding", 1)]), "{laws:?}");
        let equal = Named { effect: "viscous_quadratic".into(), joints: vec![1] };
        assert_eq!(named[0].equivalent, [equal]);
        assert!(named[2].equivalent.is_empty());
    }
}
