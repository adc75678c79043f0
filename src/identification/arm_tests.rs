//! Several joints, shared parameters, and both methods.

use super::*;
use crate::identification::problem::Parameter;
use crate::identification::pso;
use crate::identification::settings::Search;
use crate::identification::testing::{self, TRUTH};

fn arm(shared: &[f64]) -> ArmProblem {
    let joints: Vec<JointProblem> = (0..3)
        .map(|j| JointProblem { joint: j + 1, ..testing::problem(1500 + j, 0.3, false) })
        .collect();
    let column = |j: usize, k: usize, n: usize| {
        (0..n).map(|i| ((k + 1) as f64 * 0.01 * i as f64 + j as f64).sin()).collect::<Vec<_>>()
    };
    let shared_columns: Vec<Vec<Vec<f64>>> = joints
        .iter()
        .enumerate()
        .map(|(j, p)| (0..shared.len()).map(|k| column(j, k, p.samples())).collect())
        .collect();
    let names = ["mass", "moment_x", "moment_y", "moment_z"];
    let parameter = |k: usize| Parameter {
        name: format!("payload_{}", names[k]),
        unit: "kg".into(),
        lower: if k == 0 { 0.0 } else { -3.0 },
        upper: 15.0,
    };
    let mut arm =
        ArmProblem { joints, shared: (0..shared.len()).map(parameter).collect(), shared_columns };
    let minus: Vec<f64> = shared.iter().map(|v| -v).collect();
    arm.joints = shared::take_off(&arm, &minus);
    arm
}

#[test]
fn a_payload_and_every_joints_friction_are_found_together() {
    let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
    let results = identify(&arm(&[2.0, 0.1, -0.2, 0.3]), None, &settings).unwrap();
    for result in &results {
        let truth = [2.0, 0.05, -0.1, 0.15];
        for (row, truth) in result.arm.iter().zip(truth) {
            assert!(row.low < truth && truth < row.high, "{row:?}");
            assert!(row.high - row.low < 0.2, "{row:?}");
        }
        for joint in &result.joints {
            let viscous = joint.parameters.iter().find(|p| p.name == "viscous").unwrap();
            assert!(viscous.low < TRUTH[2] && TRUTH[2] < viscous.high, "{viscous:?}");
        }
    }
    assert_eq!(results[0].arm[1].name, "payload_centre_x");
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let problem = arm(&[]);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut results =
            pool.install(|| identify(&problem, Some(&problem), &Settings::default())).unwrap();
        let joints = results.iter_mut().flat_map(|r| &mut r.joints);
        joints.for_each(|j| j.seconds = 0.0);
        results
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn both_costs_lead_the_swarm_to_the_same_place() {
    let settings = Settings {
        methods: vec![Method::Pso],
        pso: pso::Settings { iterations: 300, ..Default::default() },
        ..Default::default()
    };
    let direct = Settings { pso_cost: Search::Direct, ..settings.clone() };
    let problem = arm(&[]);
    let [a, b] = [settings, direct].map(|s| identify(&problem, None, &s).unwrap());
    for (a, b) in a[0].joints.iter().zip(&b[0].joints) {
        assert!((a.cost / b.cost - 1.0).abs() < 1e-6, "{} {}", a.cost, b.cost);
    }
}
