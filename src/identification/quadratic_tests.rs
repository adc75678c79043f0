//! The interpolated cost against the direct one.

use std::sync::Arc;

use super::*;
use crate::identification::testing::{self, TRUTH};

#[test]
fn agrees_with_the_direct_cost_to_a_billionth_all_over_the_box() {
    for filtered in [false, true] {
        let problem = testing::problem(6000, 0.3, filtered);
        let bounds = problem.bounds().unwrap();
        let cost = QuadraticCost::new(&problem, &bounds);
        for x in testing::points(&bounds, 200) {
            let (fast, direct) = (cost.rms(&x), problem.direct_cost(&x));
            assert!((fast / direct - 1.0).abs() < 1e-9, "{x:?}: {fast} {direct}");
        }
        let near = problem.direct_cost(&TRUTH);
        assert!((cost.rms(&TRUTH) / near - 1.0).abs() < 1e-9, "{} {near}", cost.rms(&TRUTH));
    }
}

#[test]
fn the_profile_is_the_least_squares_solution_for_its_velocity() {
    let problem = testing::problem(2000, 0.3, false);
    let bounds = problem.bounds().unwrap();
    let cost = QuadraticCost::new(&problem, &bounds);
    for velocity in [0.006, 0.03, 0.2, 0.5] {
        let best = cost.profile(velocity);
        let moved = |i: usize, by: f64| {
            let mut x = best.x.clone();
            x[i] = bounds.clamp(i, x[i] + by);
            cost.sum_of_squares(&x)
        };
        for i in 0..best.x.len() - 1 {
            for by in [-1e-3, 1e-3] {
                let slack = 1e-9 * best.sum_of_squares;
                assert!(moved(i, by) >= best.sum_of_squares - slack, "{velocity}: {i} {by}");
            }
        }
    }
}

#[test]
fn bounds_hold_in_the_profile() {
    let mut problem = testing::problem(2000, 0.3, false);
    problem.columns[0].parameter.upper = 3.0;
    let bounds = problem.bounds().unwrap();
    let best = QuadraticCost::new(&problem, &bounds).profile(0.05);
    assert_eq!(best.x[2], 3.0);
}

#[test]
fn a_joint_that_does_not_move_is_no_obstacle() {
    let mut problem = testing::problem(100, 0.3, false);
    problem.y.fill(0.0);
    problem.columns.iter_mut().for_each(|c| c.values.fill(0.0));
    if let Some(curve) = &mut problem.curve {
        curve.speed.fill(0.0);
        curve.sign.fill(0.0);
        curve.reduce = Arc::new(|all| all);
    }
    let bounds = problem.bounds().unwrap();
    let cost = QuadraticCost::new(&problem, &bounds);
    assert_eq!(cost.profile(0.05).sum_of_squares, 0.0);
}
