//! `armtwin identify` finds nonlinear parameters by itself.

use std::path::Path;

use serde_json::Value;

use crate::armtwin;

const TERMS: &str =
    "coulomb,viscous,stribeck,presliding,backlash,torque_ripple,rotor_inertia,offset";

fn simulated(scenario: &str, folder: &Path) -> String {
    let out = folder.to_str().unwrap();
    let made = armtwin(&["simulate", scenario, "--out", out, "--duration", "40"]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    folder.join("fit.csv").display().to_string()
}

/// The joints (from 1) at which an effect was found.
fn found(document: &Value, effect: &str) -> Vec<u64> {
    let searched = document["searched"].as_array().unwrap().iter();
    let here = searched.filter(|s| s["effect"] == effect);
    let shown = here.filter(|s| !s["parameters"].as_array().unwrap().is_empty());
    shown.map(|s| s["joint"].as_u64().unwrap()).collect()
}

/// The row of a parameter of a joint (from 1), or of the arm (0).
fn row<'a>(document: &'a Value, joint: usize, name: &str) -> &'a Value {
    let method = &document["methods"][0];
    let rows = match joint {
        0 => &method["arm"],
        j => &method["joints"][j - 1]["parameters"],
    };
    rows.as_array().unwrap().iter().find(|p| p["name"] == name).unwrap()
}

/// Stribeck velocities, a presliding width, an order of ripple, a gap and its stiffness, simulated in
/// rapier, come back. How stiff the touching teeth are an elbow hardly shows, and its interval says so.
#[test]
fn nonlinear_parameters_come_back_from_a_simulation() {
    let folder = tempfile::tempdir().unwrap();
    let fit = simulated("scenarios/ur5_nonlinear.toml", folder.path());
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (json, twin) = (path("out.json"), path("twin.toml"));
    let more = ["--terms", TERMS, "--guard", "0.05", "--reduce", "--method", "nlse"];
    let outputs = ["--check", &path("check.csv"), "--json", &json, "--save-twin", &twin];
    let ran = armtwin(&[&["identify", &fit], &more[..], &outputs].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let says = "torque_ripple: ripple_order from";
    assert!(ran.stdout.contains(says) && ran.stdout.contains("at joint 5,"), "{}", ran.stdout);
    let document: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!(
        (found(&document, "backlash"), found(&document, "torque_ripple")),
        (vec![3], vec![5])
    );
    for (joint, name, truth, near) in [
        (1, "stribeck_excess", 2.4, 0.1),
        (1, "stribeck_velocity", 0.05, 0.1),
        (4, "stribeck_excess", 0.7, 0.15),
        (4, "stribeck_velocity", 0.05, 0.15),
        (6, "presliding", 1.0, 0.05),
        (6, "presliding_width", 0.004, 0.03),
        (5, "ripple_sine", 0.3, 0.05),
        (5, "ripple_cosine", -0.1, 0.15),
        (5, "ripple_order", 202.0, 3e-4),
        (0, "backlash_gap_3", 0.002, 0.15),
        (0, "backlash_stiffness_3", 2e4, f64::INFINITY),
    ] {
        let row = row(&document, joint, name);
        let value = row["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < near, "joint {joint}, {name}: {value}, not {truth}");
        let [low, high] = ["low", "high"].map(|end| row[end].as_f64().unwrap());
        assert!(low <= truth && truth <= high, "{name}: {low} .. {high}, {truth}");
    }
    let r2 = |joint: &Value| joint["check"]["r2"].as_f64().unwrap();
    assert!(document["methods"][0]["joints"].as_array().unwrap().iter().all(|j| r2(j) > 0.999));

    // The twin that was saved has them, and needs no search.
    let again = armtwin(&["identify", &fit, "--twin", &twin, "--terms", "coulomb,viscous"]);
    assert_eq!(again.code, 0, "{}", again.stderr);
    let saved = std::fs::read_to_string(&twin).unwrap();
    assert!(saved.contains("ripple_order") && saved.contains("backlash_gap"), "{saved}");
}

#[test]
fn what_is_not_there_is_not_found_and_half_of_an_effect_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let fit = simulated("scenarios/effects/viscous.toml", folder.path());
    let json = folder.path().join("out.json").display().to_string();
    let terms = "coulomb,viscous,presliding,torque_ripple,backlash,rotor_inertia,offset";
    let twin = folder.path().join("twin.toml").display().to_string();
    let more = ["--method", "nlse", "--json", &json, "--save-twin", &twin];
    let ran = armtwin(&[&["identify", &fit, "--terms", terms], &more[..]].concat());
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let document: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    assert!(document["methods"][0]["joints"][4]["fit"]["r2"].as_f64().unwrap() > 0.999);
    for effect in ["presliding", "torque_ripple", "backlash"] {
        assert_eq!(found(&document, effect), vec![0; 0], "{effect}");
        assert!(ran.stdout.contains(&format!("{effect}: shows at no joint")), "{}", ran.stdout);
        assert!(!std::fs::read_to_string(&twin).unwrap().contains(effect));
    }

    let half = folder.path().join("half.toml");
    std::fs::write(
        &half,
        "robot = \"ur5\"\n[twin]\neffects = [\"backlash\"]\n[twin.values]\nbacklash_damping = 20\n",
    )
    .unwrap();
    let half = half.to_str().unwrap();
    let ran = armtwin(&["identify", &fit, "--twin", half, "--terms", "coulomb,backlash"]);
    assert_eq!(ran.code, 1, "{}", ran.stdout);
    assert!(ran.stderr.contains("backlash_stiffness"), "{}", ran.stderr);
}
