//! What is said about a joint whose friction is known.

use super::*;
use crate::identification::quadratic::QuadraticCost;
use crate::identification::separable;
use crate::identification::testing::{self, TRUTH};

fn fitted(problem: &JointProblem) -> Vec<ParameterEstimate> {
    let bounds = problem.bounds().unwrap();
    let cost = QuadraticCost::new(problem, &bounds);
    let outcome = separable::minimise(problem, &cost, &bounds, &Default::default());
    judge(problem, &outcome.x).unwrap()
}

fn named<'a>(all: &'a [ParameterEstimate], name: &str) -> &'a ParameterEstimate {
    all.iter().find(|e| e.name == name).unwrap()
}

#[test]
fn true_values_lie_in_the_intervals_of_an_excited_joint() {
    let problem = testing::problem(6000, 0.3, false);
    let all = fitted(&problem);
    for (i, p) in problem.parameters().iter().enumerate() {
        let row = named(&all, &p.name);
        assert!(row.identifiable, "{row:?}");
        assert!(row.low < TRUTH[i] && TRUTH[i] < row.high, "{row:?} {}", TRUTH[i]);
    }
    let excess = named(&all, "stribeck_excess");
    assert!(excess.p < 1e-6 && excess.value > 0.0, "{excess:?}");
}

#[test]
fn a_curve_that_is_not_there_is_not_given_a_velocity() {
    let mut problem = testing::problem(3000, 0.3, false);
    let (s, g) = match &problem.curve {
        Some(c) => (c.sign.clone(), c.column(TRUTH[5])),
        None => panic!("the problem has a curve"),
    };
    let _ = s;
    crate::kernels::axpy(TRUTH[0] - TRUTH[1], &g, &mut problem.y);
    let all = fitted(&problem);
    for name in ["static", "stribeck_velocity"] {
        let row = named(&all, name);
        assert!(!row.identifiable && row.why_not.is_some(), "{row:?}");
        assert_eq!([row.low, row.high], row.bounds);
    }
    assert!(named(&all, "coulomb").identifiable);
}

#[test]
fn a_curve_below_the_slowest_sample_is_not_identifiable() {
    let mut problem = testing::problem(3000, 0.3, false);
    problem.speed.iter_mut().for_each(|w| *w = w.max(0.2));
    let row = named(&fitted(&problem), "static").clone();
    assert!(!row.identifiable);
    assert!(row.why_not.unwrap().contains("slower"), "speaks of slow samples");
}

#[test]
fn terms_that_are_one_and_the_same_name_each_other() {
    let mut problem = testing::problem(3000, 0.3, false);
    problem.columns[2].values = problem.columns[1].values.clone();
    let row = named(&fitted(&problem), "viscous_cubic").clone();
    assert!(row.why_not.unwrap().contains("viscous_quadratic"));
}

#[test]
fn a_standing_joint_has_no_estimates_and_no_panic() {
    let mut problem = testing::problem(3000, 0.3, false);
    problem.y.truncate(4);
    let rows = judge(&problem, &TRUTH).unwrap();
    assert!(rows.iter().all(|r| !r.identifiable && r.why_not.is_some()));
}
