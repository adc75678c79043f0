//! `armtwin identify --method mcmc` as a user runs it.

use std::process::Command;

fn armtwin(args: &[&str], folder: &std::path::Path) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_armtwin")).args(args).current_dir(folder).output().unwrap()
}

#[test]
fn posteriors_stand_beside_the_other_estimates_in_the_json() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/ur5_paper.toml");
    let made = armtwin(&["simulate", scenario, "--duration", "20", "--out", "r"], folder.path());
    assert!(made.status.success(), "{made:?}");
    let arguments = ["identify", "r/fit.csv", "--method", "nlse,mcmc", "--json", "out.json"];
    let found = armtwin(&arguments, folder.path());
    assert!(found.status.success(), "{found:?}");
    let text = std::fs::read_to_string(folder.path().join("out.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["methods"][1]["method"], "mcmc");
    let joint = &json["methods"][1]["joints"][5];
    assert!(["converged", "not_converged"].contains(&joint["stopped"].as_str().unwrap()));
    for p in joint["parameters"].as_array().unwrap() {
        let q = &p["posterior"];
        let [low, mean, high] = ["low", "mean", "high"].map(|k| q[k].as_f64().unwrap());
        assert!(low < mean && mean < high && q["r_hat"].is_f64(), "{p}");
        assert!(p["bounds"][0].as_f64().unwrap() <= low, "{p}");
    }
}

#[test]
fn a_posterior_of_what_all_joints_share_is_refused_with_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/ur5_clean.toml");
    armtwin(&["simulate", scenario, "--duration", "8", "--out", "r"], folder.path());
    let arguments = ["identify", "r/fit.csv", "--method", "mcmc", "--with", "payload"];
    let refused = armtwin(&arguments, folder.path());
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--method nlse"), "{refused:?}");
}
