//! `armtwin compare`.

use super::armtwin;

/// A short simulated recording in a folder of its own.
#[cfg(feature = "viewer")]
fn simulated() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let made =
        armtwin(&["simulate", "scenarios/ur5_friction.toml", "--duration", "8", "--out", out]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    folder
}

#[cfg(feature = "viewer")]
#[test]
fn the_twin_that_made_a_recording_stays_beside_it() {
    let folder = simulated();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let (fit, rrd, json) = (path("fit.csv"), path("twin.rrd"), path("twin.json"));
    let twin = "scenarios/twins/ur5.toml";
    let run = armtwin(&["compare", &fit, "--twin", twin, "-o", &rrd, "--json", &json]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains("shoulder_pan"), "{}", run.stdout);
    let report: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    for joint in report["joints"].as_array().unwrap() {
        let number = |key: &str| joint[key].as_f64().unwrap();
        assert!(number("r2") > 0.9, "{joint}");
        assert!(number("tracking_rms_rad") < 0.01, "{joint}");
    }
    let bytes = std::fs::read(&rrd).unwrap();
    assert_eq!(&bytes[..4], b"RRF2");
    assert!(bytes.len() < 4_000_000, "{} bytes for 8 s", bytes.len());
}

#[cfg(feature = "viewer")]
#[test]
fn nothing_is_written_for_a_recording_without_torque() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let mut text = String::from("timestamp,actual_q_0,actual_q_1\n");
    (0..500).for_each(|k| text += &format!("{},0.1,0.2\n", k as f64 * 0.008));
    std::fs::write(path("log.csv"), text).unwrap();
    let run = armtwin(&["compare", &path("log.csv"), "-o", &path("log.rrd")]);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("log.csv"), "{}", run.stderr);
    assert!(!folder.path().join("log.rrd").exists());
}

#[cfg(not(feature = "viewer"))]
#[test]
fn without_the_viewer_it_says_how_to_get_it() {
    let run = armtwin(&["compare", "any.csv"]);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("cargo build --release"), "{}", run.stderr);
}
