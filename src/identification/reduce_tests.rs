//! Elimination on a joint whose friction is known.

use super::*;
use crate::identification::testing::{self, TRUTH};
use crate::kernels::axpy;

fn terms(problem: &JointProblem) -> Vec<String> {
    let dropped = eliminate(problem.clone(), &separable::Settings::default()).unwrap();
    dropped.into_iter().map(|d| d.term).collect()
}

#[test]
fn terms_that_exist_stay() {
    assert_eq!(terms(&testing::problem(6000, 0.1, false)), Vec::<String>::new());
}

#[test]
fn terms_that_are_absent_go() {
    let mut problem = testing::problem(3000, 0.3, false);
    for (i, value) in [(1, TRUTH[3]), (2, TRUTH[4])] {
        let column = problem.columns[i].values.clone();
        axpy(-value, &column, &mut problem.y);
    }
    let mut gone = terms(&problem);
    gone.sort();
    assert_eq!(gone, ["viscous_cubic", "viscous_quadratic"]);
}

#[test]
fn a_static_level_below_coulomb_is_no_stribeck_term() {
    let mut problem = testing::problem(3000, 0.1, false);
    let curve = problem.curve.as_ref().unwrap().column(TRUTH[5]);
    axpy(2.0 * (TRUTH[0] - TRUTH[1]), &curve, &mut problem.y);
    assert!(terms(&problem).contains(&"stribeck".to_string()));
}

#[test]
fn a_viscous_term_outlasts_higher_powers() {
    let mut problem = testing::problem(3000, 0.3, false);
    for i in 0..3 {
        let column = problem.columns[i].values.clone();
        axpy(-TRUTH[2 + i], &column, &mut problem.y);
    }
    assert_eq!(terms(&problem).last().unwrap(), "viscous");
}

#[test]
fn without_its_stribeck_term_a_curve_is_coulomb_friction() {
    let mut problem = testing::problem(100, 0.1, false);
    take_out(&mut problem, "stribeck");
    let names: Vec<_> = problem.parameters().into_iter().map(|p| p.name.clone()).collect();
    assert_eq!(names, ["coulomb", "viscous", "viscous_quadratic", "viscous_cubic"]);
}
