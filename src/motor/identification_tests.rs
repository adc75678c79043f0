//! What can be identified, what cannot, and whether the statistics keep their promise.

use std::sync::atomic::AtomicBool;

use super::dependence::dependence;
use super::experiment::{Clean, Record};
use super::fit::{Fit, least_squares, least_squares_from, swarm};
use super::inference::{Knowledge, analyse};
use super::model::{COUNT, NAMES, index};
use super::report::{Method, run};
use super::scenario::{Channel, SHIPPED, Scenario, ScenarioError};
use super::study::study;
use crate::identification::levenberg_marquardt::Residuals;
use crate::identification::pso;

/// A shipped scenario at 100 Hz instead of 1 kHz, to keep tests fast.
fn thinned(n: usize) -> Scenario {
    let mut scenario = Scenario::parse(SHIPPED[n - 1]).unwrap();
    scenario.identification.sample_time = 0.01;
    scenario.verification.sample_time = 0.01;
    scenario.identification.duration = 50.0;
    scenario.verification.duration = 50.0;
    scenario
}

fn record(scenario: &Scenario) -> Record {
    Clean::of(&scenario.truth, &scenario.identification).unwrap().for_identification(1)
}

fn known_at_truth(scenario: &Scenario) -> Knowledge {
    let record = record(scenario);
    analyse(&scenario.problem(&record), &scenario.truth.to_array()).unwrap()
}

fn names(members: &[usize]) -> Vec<&str> {
    members.iter().map(|&k| NAMES[k]).collect()
}

#[test]
fn shipped_scenarios_are_the_papers() {
    for (text, [v2, v3]) in SHIPPED.iter().zip([[0.05, 0.02], [0.0, 0.0]]) {
        let scenario = Scenario::parse(text).unwrap();
        let paper = [0.1, 0.2, 0.1, 1.5, 0.1, 0.2, 0.05, v2, v3, 0.01];
        assert_eq!(scenario.truth.to_array(), paper);
        assert_eq!(scenario.pso, pso::Settings { parallel: true, ..Default::default() });
        assert_eq!([scenario.identification.snr_db, scenario.verification.snr_db], [28.0, 25.0]);
        assert_eq!(scenario.warnings().len(), 1);
    }
}

#[test]
fn speed_alone_leaves_one_direction_and_it_is_found() {
    let knowledge = known_at_truth(&thinned(1));
    assert_eq!(knowledge.undetermined.len(), 1);
    let members = names(&knowledge.undetermined[0]);
    assert_eq!(members, ["J", "L", "R", "T_s", "T_c", "T_v1", "T_v2", "T_v3"]);
    assert!(knowledge.smallest_kept > 1e-6, "{}", knowledge.smallest_kept);
    assert!(knowledge.largest_dropped.unwrap() < 1e-11);
    let combinations: Vec<&str> = knowledge.combinations.iter().map(|c| c.name.as_str()).collect();
    let expected = ["J * R", "L / R", "T_s * R", "T_c * R", "T_v1 * R", "T_v2 * R", "T_v3 * R"];
    assert_eq!(combinations, expected);
}

#[test]
fn no_interval_for_what_is_not_identifiable() {
    let knowledge = known_at_truth(&thinned(1));
    for (k, known) in knowledge.parameters.iter().enumerate() {
        let refused = known.robust.low.is_nan() && known.paper.low.is_nan();
        assert_eq!(refused, !knowledge.identifiable[k], "{}", NAMES[k]);
        assert!(known.robust.p.is_finite(), "existence of {} is testable all the same", NAMES[k]);
    }
    assert!(knowledge.identifiable[index::K] && knowledge.identifiable[index::OMEGA_S]);
}

#[test]
fn a_zero_term_is_not_part_of_the_direction() {
    let knowledge = known_at_truth(&thinned(2));
    assert_eq!(names(&knowledge.undetermined[0]), ["J", "L", "R", "T_s", "T_c", "T_v1"]);
}

#[test]
fn current_or_one_of_the_eight_makes_all_identifiable() {
    let mut with_current = thinned(1);
    with_current.measured = vec![Channel::Omega, Channel::Current];
    assert!(known_at_truth(&with_current).undetermined.is_empty());
    for k in (0..COUNT).filter(|&k| k != index::K && k != index::OMEGA_S) {
        let mut given = thinned(1);
        given.given[k] = Some(given.truth.to_array()[k]);
        assert!(known_at_truth(&given).undetermined.is_empty(), "{} given", NAMES[k]);
    }
    let mut useless = thinned(1);
    useless.given[index::K] = Some(0.2);
    assert_eq!(known_at_truth(&useless).undetermined.len(), 1);
}

#[test]
fn both_channels_identify_all_ten_from_random_starts() {
    let mut scenario = thinned(1);
    scenario.measured = vec![Channel::Omega, Channel::Current];
    let record = record(&scenario);
    let problem = scenario.problem(&record);
    let Fit { values, cost, .. } = least_squares(&problem, &scenario.bounds, 3, 2, &|| ());
    assert!((cost - 1.0).abs() < 0.05, "{cost}");
    let knowledge = analyse(&problem, &values).unwrap();
    assert!(knowledge.newton_step < 0.3, "{}", knowledge.newton_step);
    for (k, truth) in scenario.truth.to_array().into_iter().enumerate() {
        let known = &knowledge.parameters[k].robust;
        // Twice the 99 % interval: fails once in 1e7.
        let half = known.high - known.low;
        assert!((values[k] - truth).abs() < half, "{}: {} {truth}", NAMES[k], values[k]);
        assert!(known.p < 0.01, "{} exists", NAMES[k]);
    }
}

#[test]
fn a_search_from_the_speed_ends_where_it_started() {
    let scenario = thinned(1);
    let record = record(&scenario);
    let problem = scenario.problem(&record);
    let truth = scenario.truth.to_array();
    let scaled = |c: f64| {
        let mut v = truth;
        v[index::L] *= c;
        v[index::R] *= c;
        for k in [index::J, index::T_S, index::T_C, index::T_V1, index::T_V2, index::T_V3] {
            v[k] /= c;
        }
        v
    };
    let fit =
        least_squares_from(&problem, &scenario.bounds, &[truth, scaled(1.5), scaled(0.7)], &|| ());
    let costs: Vec<f64> = fit.starts.iter().map(|e| e.cost).collect();
    assert!((costs[0] - costs[1]).abs() < 1e-6 && (costs[0] - costs[2]).abs() < 1e-6, "{costs:?}");
    let r: Vec<f64> = fit.starts.iter().map(|e| e.values[index::R]).collect();
    assert!(r[1] / r[0] > 1.2 && r[2] / r[0] < 0.85, "{r:?}");
}

/// The noise is 1, and 1e-4 of it far less than what swarms leave on the table.
#[test]
fn a_swarms_cost_is_the_cost_or_not_below_its_limit() {
    let mut scenario = thinned(1);
    for measured in [vec![Channel::Omega], vec![Channel::Omega, Channel::Current]] {
        scenario.measured = measured;
        let record = record(&scenario);
        let problem = scenario.problem(&record);
        for share in [0.7, 0.95, 1.0, 1.1, 1.6] {
            let x = scenario.truth.to_array().map(|v| share * v);
            let mut residuals = vec![0.0; problem.count()];
            problem.residuals(&x, &mut residuals);
            let squares: f64 = residuals.iter().map(|r| r * r).sum();
            let cost = (squares / residuals.len() as f64).sqrt();
            assert!((problem.cost(&x) / cost - 1.0).abs() < 1e-12, "{share}");
            let coarse = problem.cost_below(f64::INFINITY, &x);
            assert!((coarse / cost - 1.0).abs() < 1e-4, "{share}: {coarse} {cost}");
            assert_eq!(problem.cost_below(1.01 * coarse, &x), coarse);
            for limit in [0.2, 0.9, 0.999_999, 1.0].map(|s| s * coarse) {
                assert!(problem.cost_below(limit, &x) >= limit, "{share}");
            }
        }
    }
}

#[test]
fn the_swarm_comes_close_in_a_small_box() {
    let mut scenario = thinned(2);
    scenario.measured = vec![Channel::Omega, Channel::Current];
    scenario.identification.duration = 20.0;
    let record = record(&scenario);
    let problem = scenario.problem(&record);
    let truth = scenario.truth.to_array();
    let bounds: [[f64; 2]; COUNT] = std::array::from_fn(|k| match truth[k] {
        v if v > 0.0 => [0.5 * v, 2.0 * v],
        _ => scenario.bounds[k],
    });
    let settings = pso::Settings { iterations: 60, ..scenario.pso };
    let fit = swarm(&problem, &bounds, &settings, 1, &|| ());
    assert!(fit.cost < 1.6, "{}", fit.cost);
    let knowledge = analyse(&problem, &fit.values).unwrap();
    assert!(knowledge.newton_step > 1.0, "a short search is not at a minimum, and that is seen");
    assert_eq!(fit.evaluations, 100 * 61);
}

#[test]
fn members_follow_the_box_and_combinations_do_not() {
    let mut scenario = thinned(1);
    scenario.pso.particles_per_parameter = 2;
    let rows = dependence(&scenario, 1).unwrap();
    let of = |width: f64| rows.iter().find(|d| d.width == width && d.method == "nlse").unwrap();
    assert!(of(1.05).member_error[1] <= 5.0 + 1e-6);
    assert!(of(5.0).member_error[1] > 20.0);
    assert!((of(5.0).cost[0] - of(1.2).cost[0]).abs() < 1e-3);
    assert!(of(5.0).combination_error[0] < 10.0);
}

#[test]
fn honest_conventions_keep_their_rates_and_the_papers_does_not() {
    let mut scenario = thinned(2);
    scenario.measured = vec![Channel::Omega, Channel::Current];
    let study =
        study(&scenario, Method::Nlse, [100, 40], &(), &AtomicBool::new(false), &|| ()).unwrap();
    assert_eq!((study.seeds, study.failed), (40, 0));
    for k in [index::T_V2, index::T_V3] {
        let counts = &study.parameters[k];
        // Nominal 0.4 of 40.
        assert!(counts.kept[0] <= 4 && counts.kept[1] <= 4, "{counts:?}");
        assert!(counts.kept[2] >= 30, "{counts:?}");
        assert!(counts.covered[0] >= 36 && counts.covered[2] <= 10, "{counts:?}");
    }
    let exists = [index::J, index::K, index::L, index::R, index::T_C, index::T_V1];
    assert!(exists.iter().all(|&k| study.parameters[k].kept[0] == 40));
}

#[test]
fn a_report_keeps_what_is_there_and_drops_what_is_not() {
    let mut scenario = thinned(2);
    scenario.measured = vec![Channel::Omega, Channel::Current];
    scenario.nlse.starts = 2;
    let report = run(&scenario, &[Method::Nlse], 1, &|| ()).unwrap();
    assert!(report.unidentifiable.is_empty());
    let method = &report.methods[0];
    let kept: Vec<bool> = method.parameters.iter().map(|p| p.kept).collect();
    let expected = [true, true, true, true, true, true, true, false, false, true];
    assert_eq!(kept, expected);
    assert!(method.r2 > 0.98);
}

#[test]
fn bad_scenarios_say_what_and_where() {
    let good = SHIPPED[0];
    let message = |from: &str, to: &str| {
        assert!(good.contains(from));
        Scenario::parse(&good.replacen(from, to, 1)).unwrap_err().to_string()
    };
    assert!(message("J = 0.1 ", "J = -0.1 ").contains("[truth] J = -0.1: must be positive"));
    assert!(message("T_c = 0.2 ", "# ").contains("[truth] has no T_c"));
    assert!(message("T_c = 0.2 ", "T_x = 0.2 ").contains("unknown parameter T_x"));
    assert!(message("J = [0.05, 0.2]", "J = [0.2, 0.05]").contains("lower < upper"));
    assert!(message("[\"omega\"]", "[\"current\"]").contains("give omega"));
    assert!(message("[\"omega\"]", "[\"speed\"]").contains("speed"));
    assert!(message("duration = 100.0", "duration = 0.01").contains("[identification] duration"));
    assert!(message("starts = 6", "starts = 0").contains("[nlse] starts"));
    assert!(message("peak = 5.0", "peek = 5.0").contains("peek"));
    let mut all = Scenario::parse(good).unwrap();
    all.given = all.truth.to_array().map(Some);
    assert!(matches!(all.check(), Err(ScenarioError::NothingLeft)));
}
