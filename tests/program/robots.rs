//! `armtwin robots` and `armtwin urdf`.

use std::fs;

use crate::armtwin;

#[test]
fn robots_are_listed_for_people_and_machines() {
    let text = armtwin(&["robots"]);
    assert!(text.stdout.lines().all(|l| l.chars().count() <= 100), "{}", text.stdout);
    let json = armtwin(&["robots", "--json"]);
    assert_eq!((text.code, json.code), (0, 0));
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    let names: Vec<_> = json.as_array().unwrap().iter().map(|r| r["name"].as_str()).collect();
    for name in ["ur5", "ur5-as-printed", "ur3", "ur10", "ur3e", "ur5e", "ur10e"] {
        assert!(text.stdout.contains(name) && names.contains(&Some(name)), "{name}");
    }
    assert_eq!((json[0]["dof"].as_u64(), json[0]["mass_kg"].as_f64()), (Some(6), Some(17.0489)));
    assert!(json[0]["source"].as_str().unwrap().contains("Tables I and II"));
}

#[test]
fn urdf_goes_to_standard_output_or_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ur3e.urdf");
    let written = armtwin(&["urdf", "--robot", "ur3e", "-o", file.to_str().unwrap()]);
    let printed = armtwin(&["urdf", "--robot", "ur3e"]);
    assert_eq!((written.code, printed.code), (0, 0), "{}", written.stderr);
    assert_eq!(fs::read_to_string(file).unwrap(), printed.stdout);
    assert!(printed.stdout.contains("shoulder_lift_joint") && printed.stdout.contains("tool0"));
}

/// Each of these is one line on standard error, exit code 1, and no output file.
#[test]
fn bad_urdfs_are_refused_without_a_trace() {
    let good = armtwin(&["urdf"]).stdout;
    let closed = "<joint name=\"back\" type=\"fixed\"><parent link=\"tool0\"/>\
                  <child link=\"forearm_link\"/></joint></robot>";
    let cases = [
        ("loop", good.replace("</robot>", closed), "link `forearm_link`"),
        ("massless", good.replace("value=\"2.33\"", "value=\"0\""), "link `forearm_link`"),
        ("slider", good.replacen("revolute", "prismatic", 1), "joint `shoulder_pan_joint`"),
        ("cut", good[..good.len() / 2].to_string(), "not a valid URDF"),
        ("empty", String::new(), "not a valid URDF"),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (name, text, expected) in cases {
        let file = folder.path().join(format!("{name}.urdf"));
        let out = folder.path().join("out.urdf");
        fs::write(&file, text).unwrap();
        let run =
            armtwin(&["urdf", "--robot", file.to_str().unwrap(), "-o", out.to_str().unwrap()]);
        assert_eq!((run.code, run.stderr.lines().count()), (1, 1), "{name}: {}", run.stderr);
        assert!(run.stderr.contains(expected) && run.stderr.contains(name), "{}", run.stderr);
        assert!(!out.exists());
    }
}

#[test]
fn unknown_robots_and_unwritable_files_exit_with_1() {
    let unknown = armtwin(&["urdf", "--robot", "ur7"]);
    assert!(unknown.code == 1 && unknown.stderr.contains("ur10e"), "{}", unknown.stderr);
    let nowhere = armtwin(&["urdf", "-o", "/no/such/folder/a.urdf"]);
    assert!(nowhere.code == 1 && nowhere.stderr.contains("/no/such/folder"), "{}", nowhere.stderr);
}

/// Base and tip by flag; what was assumed on standard error and in the JSON; written, the chain
/// reads back with the same joints, masses and gravity.
#[test]
fn an_arm_is_taken_out_of_a_larger_robot() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let (file, json, again) = (at("left.urdf"), at("left.json"), at("again.json"));
    let cart = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/robots/cart_with_two_arms.urdf");
    let chain = ["--base", "left_mount", "--tip", "left_hand"];
    let run = ["urdf", "--robot", cart, "-o", &file, "--json", &json];
    let taken = armtwin(&[&run[..], &chain[..]].concat());
    assert_eq!(taken.code, 0, "{}", taken.stderr);
    let read = |file: &str| -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
    };
    let arm = read(&json);
    assert_eq!((&arm["base"], &arm["tip"]), (&"left_mount".into(), &"left_hand".into()));
    let notes: Vec<_> = arm["notes"].as_array().unwrap().iter().map(|n| n.as_str()).collect();
    let said: Vec<_> =
        taken.stderr.lines().map(|l| l.strip_prefix("note: cart_with_two_arms.urdf: ")).collect();
    assert_eq!(notes, said);
    assert!(taken.stderr.contains("`left_grip` (prismatic), `left_grip_2` (mimic)"));
    let back = ["urdf", "--robot", &file, "--base", "base", "-o", &at("b"), "--json", &again];
    let back = armtwin(&back);
    assert_eq!(back.code, 0, "{}", back.stderr);
    let again = read(&again);
    assert_eq!((&again["joints"], &again["mass_kg"]), (&arm["joints"], &arm["mass_kg"]));
    for (a, b) in (0..3).map(|k| (&arm["gravity_m_s2"][k], &again["gravity_m_s2"][k])) {
        assert!((a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 1e-12, "{a} {b}");
    }
    let ambiguous = armtwin(&["urdf", "--robot", cart, "--base", "mast", "-o", &at("none.urdf")]);
    assert_eq!((ambiguous.code, ambiguous.stderr.lines().count()), (1, 1), "{}", ambiguous.stderr);
    assert!(
        ambiguous.stderr.contains("`left_3`, `right_3`")
            && !folder.path().join("none.urdf").exists()
    );
}

/// A scenario and a twin with the same keys, from simulation to identification.
#[test]
fn a_chain_is_simulated_and_identified() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let cart = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/robots/cart_with_two_arms.urdf");
    let arm = format!(
        "robot = {cart:?}\nbase = \"mast\"\ntip = \"right_3\"\n[drive]\ngear_ratio = 100\n\
         torque_constant = 0.1\n"
    );
    fs::write(at("twin.toml"), &arm).unwrap();
    let moving = "[motion]\nduration_s = 10.0\n[effects.coulomb]\ncoulomb = 3.0\n[effects.viscous]\n\
                  viscous = 2.0\n";
    fs::write(at("scenario.toml"), arm + moving).unwrap();
    let simulated = armtwin(&["simulate", &at("scenario.toml"), "--out", &at("sim")]);
    assert_eq!(simulated.code, 0, "{}", simulated.stderr);
    assert!(
        simulated.stderr.contains("note: cart_with_two_arms.urdf: gravity"),
        "{}",
        simulated.stderr
    );
    let fit = at("sim/fit.csv");
    let run = armtwin(&["identify", &fit, "--twin", &at("twin.toml"), "--json", &at("i.json")]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let said = run.stderr.lines().filter(|l| l.contains("gravity is along -z of `world`"));
    assert_eq!(said.count(), 1, "{}", run.stderr);
    let report = fs::read_to_string(at("i.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    for joint in report["methods"][0]["joints"].as_array().unwrap() {
        let coulomb = &joint["parameters"][0];
        assert_eq!(coulomb["name"], "coulomb");
        assert!((coulomb["value"].as_f64().unwrap() - 3.0).abs() < 0.15, "{joint:#}");
    }
}
