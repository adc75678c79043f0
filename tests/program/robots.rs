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
        ("limitless", without_limits(&good), "joint `shoulder_pan_joint`"),
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

fn without_limits(urdf: &str) -> String {
    urdf.lines().filter(|l| !l.contains("<limit")).collect()
}
