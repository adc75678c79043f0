//! Elimination on a joint whose friction is known.

use super::*;
use crate::identification::problem::Parameter;
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

/// A wave that is not there goes, and with it the slope of its order and what that put on the torque.
#[test]
fn a_slope_goes_with_what_it_hangs_on() {
    let mut problem = testing::problem(3000, 0.3, false);
    let before = problem.y.clone();
    let wave = |order: f64| (0..3000).map(|k| (order * k as f64).sin()).collect::<Vec<f64>>();
    let parameter = |name: &str, lower, upper| Parameter {
        name: name.into(),
        unit: "N.m".into(),
        lower,
        upper,
    };
    problem.columns.push(Column::linear(parameter("ripple_sine", -20.0, 20.0), wave(0.7)));
    let slope = Column {
        parameter: parameter("ripple_order", 50.0, 500.0),
        values: wave(0.31),
        slope_of: ["ripple_sine"].into(),
        centre: 200.0,
    };
    axpy(slope.centre, &slope.values, &mut problem.y);
    problem.columns.push(slope);
    let gone = terms(&problem);
    assert!(gone.contains(&"ripple_sine".into()) && !gone.contains(&"ripple_order".into()));
    take_out(&mut problem, "ripple_sine");
    assert!(problem.index("ripple_order").is_none());
    let furthest = problem.y.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(furthest < 1e-10, "{furthest}");
}
