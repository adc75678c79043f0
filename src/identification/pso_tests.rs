//! The swarm on functions whose minimum is known.

use super::*;

fn sphere(x: &[f64]) -> f64 {
    x.iter().map(|x| (x - 0.3).powi(2)).sum()
}

fn cube(n: usize) -> Bounds {
    Bounds::new(vec![-1.0; n], vec![1.0; n]).unwrap()
}

#[test]
fn the_papers_settings_find_the_bottom_of_a_bowl() {
    let outcome = minimise(sphere, &cube(6), &Settings::default(), 1);
    assert!(outcome.cost < 1e-12, "{}", outcome.cost);
    assert_eq!(outcome.evaluations, 60 * 1001);
    assert_eq!(outcome.stop, Stop::Iterations);
}

#[test]
fn a_minimum_outside_the_box_is_met_at_its_wall() {
    let outcome = minimise(|x| (x[0] - 5.0).powi(2), &cube(1), &Settings::default(), 1);
    assert_eq!(outcome.best, [1.0]);
}

#[test]
fn the_outcome_follows_from_the_seed_and_not_from_the_threads() {
    let settings = Settings { iterations: 30, ..Settings::default() };
    let alone = minimise(sphere, &cube(3), &settings, 7);
    let shared = Settings { parallel: true, ..settings };
    assert_eq!(alone, minimise(sphere, &cube(3), &shared, 7));
    assert_ne!(alone.best, minimise(sphere, &cube(3), &settings, 8).best);
}

#[test]
fn a_cost_that_is_only_a_bound_where_it_is_not_below_its_limit_finds_the_same() {
    let settings = Settings { iterations: 50, ..Settings::default() };
    let cut_short = |x: &[f64], limit: f64| {
        let cost = sphere(x);
        if cost < limit { cost } else { limit }
    };
    let whole = minimise(sphere, &cube(3), &settings, 5);
    assert_eq!(minimise_below(cut_short, &cube(3), &settings, 5), whole);
}

#[test]
fn a_cost_that_is_never_finite_is_said_so() {
    let settings = Settings { iterations: 3, ..Settings::default() };
    assert_eq!(minimise(|_| f64::NAN, &cube(2), &settings, 1).stop, Stop::NoFiniteCost);
}

#[test]
fn the_inertia_weight_falls_from_its_largest_to_its_smallest_value() {
    let s = Settings::default();
    assert_eq!(inertia_weight(&s, 0), 0.9);
    assert!((inertia_weight(&s, 500) - 0.65).abs() < 1e-15);
}
