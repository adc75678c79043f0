//! Does PSO beat NLSE where the bounds are tight around the truth?
//!
//! The comparison of [`super::versus`] on a simulated arm, whose truth is known, in boxes of
//! several widths around it.

use std::collections::BTreeMap;

use super::versus::{Duel, duel};
use crate::identification::IdentificationError;
use crate::identification::problem::JointProblem;

/// Bounds are truth / width .. truth x width.
pub const WIDTHS: [f64; 3] = [1.05, 1.5, 5.0];
/// Share of the Coulomb level: a smaller truth (N.m at 1 rad/s) counts as none.
const ABSENT: f64 = 0.05;

/// Duels at all joints in boxes of one width.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Boxed {
    pub width: f64,
    pub duels: Vec<Duel>,
}

/// `truth` by parameter, one value per joint.
///
/// # Errors
/// If bounds are the wrong way round.
pub fn boxed(
    joints: &[JointProblem],
    truth: &BTreeMap<&'static str, Vec<f64>>,
    seeds: u64,
) -> Result<Vec<Boxed>, IdentificationError> {
    let at = |width: f64| {
        let within = joints.iter().map(|j| duel(&narrowed(j, truth, width), seeds));
        Ok(Boxed { width, duels: within.collect::<Result<_, _>>()? })
    };
    WIDTHS.into_iter().map(at).collect()
}

/// A joint's problem in a box around the truth. What does not exist may be as large as the Coulomb
/// level times width - 1, either way.
pub fn narrowed(
    joint: &JointProblem,
    truth: &BTreeMap<&'static str, Vec<f64>>,
    width: f64,
) -> JointProblem {
    let mut joint = joint.clone();
    let number = joint.joint - 1;
    let true_value = |name: &str| truth.get(name).and_then(|v| v.get(number)).copied();
    let level = true_value("coulomb").unwrap_or(1.0);
    for p in joint.parameters_mut() {
        let value = true_value(&p.name).unwrap_or(0.0);
        (p.lower, p.upper) = match value > ABSENT * level || p.lower > 0.0 {
            true => (value / width, value * width),
            false => (value - (width - 1.0) * level, value + (width - 1.0) * level),
        };
    }
    joint
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::testing;

    fn truth() -> BTreeMap<&'static str, Vec<f64>> {
        let names = ["coulomb", "static", "viscous", "viscous_quadratic", "viscous_cubic"];
        let values = names.into_iter().zip([6.0, 8.5, 9.0, 0.0, 0.8]);
        let velocity = ("stribeck_velocity", 0.05);
        values.chain([velocity]).map(|(name, v)| (name, vec![v])).collect()
    }

    #[test]
    fn a_box_holds_the_truth_and_what_is_absent_may_have_either_sign() {
        let joint = narrowed(&testing::problem(600, 0.3, false), &truth(), 1.5);
        let bounds: BTreeMap<_, _> =
            joint.parameters().iter().map(|p| (p.name.clone(), [p.lower, p.upper])).collect();
        assert_eq!(bounds["coulomb"], [4.0, 9.0]);
        assert_eq!(bounds["viscous_quadratic"], [-3.0, 3.0]);
        assert_eq!(bounds["viscous"], [6.0, 13.5]);
    }

    #[test]
    fn a_wider_box_costs_no_more_and_least_squares_is_first_in_all() {
        let joint = testing::problem(600, 0.3, false);
        let found = boxed(&[joint], &truth(), 3).unwrap();
        assert_eq!(found.iter().map(|b| b.width).collect::<Vec<_>>(), WIDTHS);
        assert!(found.iter().all(|b| b.duels[0].separable.reached == 1), "{found:?}");
        let lowest: Vec<f64> = found.iter().map(|b| b.duels[0].lowest).collect();
        assert!(lowest[0] >= lowest[1] && lowest[1] >= lowest[2], "{lowest:?}");
    }
}
