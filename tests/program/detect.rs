//! `armtwin detect`.

use crate::armtwin;

#[test]
fn a_measurement_goes_on_where_it_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let keep = folder.path().join("keep");
    let page = folder.path().join("page.md");
    let [keep_arg, page_arg] = [&keep, &page].map(|p| p.to_str().unwrap());
    let root = env!("CARGO_MANIFEST_DIR");
    let [offset, limit] = ["current_offset", "torque_saturation"]
        .map(|name| format!("{root}/scenarios/effects/{name}.toml"));
    let usual = ["--seeds", "4", "--duration", "10", "--keep", keep_arg, "-o", page_arg];
    let run = |files: &[&str]| armtwin(&[&["detect"], files, &usual].concat());

    let out = run(&[&offset]);
    assert_eq!((out.code, out.stdout.as_str()), (0, ""), "{}", out.stderr);
    let kept = keep.join("current_offset.json");
    let mut found: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&kept).unwrap()).unwrap();
    let value = found["detectable"]["value"].as_f64().unwrap();
    assert!(value > 0.0 && value < 1.0, "{found}");
    assert!(std::fs::read_to_string(&page).unwrap().contains("current_offset |"));

    // What is kept is believed, what is missing measured.
    found["detectable"]["unit"] = "believed".into();
    std::fs::write(&kept, found.to_string()).unwrap();
    let out = run(&[&limit, &offset]);
    assert_eq!(out.code, 0, "{}", out.stderr);
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.contains("believed") && text.contains("not from the recorded"), "{text}");
}

#[test]
fn a_scenario_is_named_after_its_effect() {
    let out = armtwin(&["detect", "no_such_effect.toml"]);
    assert_eq!(out.code, 1);
    assert!(out.stderr.contains("no effect `no_such_effect`"), "{}", out.stderr);
}
