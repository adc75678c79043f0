//! Real recordings, where they are at hand: all load, and say what is known about them.

use std::path::PathBuf;

use super::*;
use crate::recording::read;

/// The folder of recordings, or a line that says why the test does nothing.
fn shared() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let folder = std::env::var_os("ARMTWIN_SHARED").map_or(beside, PathBuf::from);
    let found = folder.join("recordings").is_dir();
    if !found {
        eprintln!("skipped: no recordings under {}", folder.display());
    }
    found.then_some(folder)
}

fn map_for(path: &str) -> Option<PathBuf> {
    let name = match path {
        _ if path.contains("collision_detection_data") => "ur10e_shamilmamedov_collision.toml",
        _ if path.contains("shamilmamedov") => "ur10e_shamilmamedov.toml",
        _ => return None,
    };
    Some(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenarios/columns").join(name))
}

fn load(folder: &std::path::Path, name: &str) -> Inspection {
    let recording = read(&folder.join("recordings").join(name), map_for(name).as_deref());
    inspect(&recording.unwrap_or_else(|e| panic!("{e}")))
}

/// Arms whose logs hold no torque or current of six joints, in formats of their own.
const OTHERS: [&str; 3] = ["sage-so101", "rhoban-bam_xl330", "dfki-double_pendulum"];

/// Every CSV below, and every folder of one-signal logs.
fn recordings(folder: PathBuf) -> Vec<PathBuf> {
    let (mut open, mut found) = (vec![folder], Vec::new());
    while let Some(folder) = open.pop() {
        if folder.join("log_q_actual.csv.gz").is_file() {
            found.push(folder);
            continue;
        }
        if OTHERS.iter().any(|other| folder.ends_with(other)) {
            continue;
        }
        for entry in std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
            match entry.to_str() {
                _ if entry.is_dir() => open.push(entry),
                Some(name) if name.ends_with(".csv.gz") => found.push(entry),
                _ => {}
            }
        }
    }
    found
}

#[test]
fn every_recording_at_hand_loads() {
    let Some(shared) = shared() else { return };
    let mut found = recordings(shared.join("recordings"));
    assert!(found.len() >= 35, "{} recordings", found.len());
    found.extend(recordings(shared.join("practice")));
    for path in found {
        let map = map_for(&path.to_string_lossy());
        let recording = read(&path, map.as_deref()).unwrap_or_else(|e| panic!("{e}"));
        let inspection = inspect(&recording);
        assert_eq!(inspection.joints, 6, "{}", path.display());
        for stem in ["actual_q", "actual_qd", "actual_current"] {
            recording.require_joints(stem, 6).unwrap();
        }
        for m in &inspection.motion {
            assert!(m.velocity_correlation.is_none_or(|r| r > 0.99), "{}: {m:?}", path.display());
        }
    }
}

#[track_caller]
fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value}, expected {expected}");
}

/// Noise at rest of the current, joint by joint.
fn current(inspection: &Inspection) -> &[JointSignal] {
    &inspection.signals.iter().find(|s| s.name == "actual_current").unwrap().columns
}

#[test]
fn the_ur5_recording_shows_its_known_figures() {
    let Some(shared) = shared() else { return };
    let folder = "kkufieta-ur5_modeling_force_estimate/Movement_No6_Acc_slow_Verify_Model";
    let inspection = load(&shared, folder);
    assert_eq!((inspection.samples, inspection.sampling.missing), (10264, 0));
    near(inspection.sampling.mean_hz, 125.0, 1e-6);
    near(inspection.moving_s, 60.7, 0.05);
    for (j, speed) in [1.06, 1.06, 1.06, 0.92, 1.02, 1.10].into_iter().enumerate() {
        near(inspection.motion[j].top_speed(), speed, 0.006);
        let column = &current(&inspection)[j];
        assert!(column.noise_at_rest && (0.009..0.02).contains(&column.noise), "{column:?}");
        near(column.step.unwrap(), if j < 3 { 0.002242 } else { 0.001525 }, 2e-6);
    }
}

#[test]
fn every_second_sample_of_the_early_ur5_recordings_is_missing() {
    let Some(shared) = shared() else { return };
    for (name, hz, moving) in [
        ("Movement_No1", 62.6, 35.3),
        ("Movement_No2", 62.9, 20.7),
        ("Movement_No3_Acc", 63.0, 11.5),
    ] {
        let inspection = load(&shared, &format!("kkufieta-ur5_modeling_force_estimate/{name}"));
        near(inspection.sampling.mean_hz, hz, 0.1);
        near(inspection.moving_s, moving, 0.15);
        near(inspection.sampling.missing as f64 / inspection.samples as f64, 1.0, 0.03);
    }
}

#[test]
fn the_ur3e_recording_shows_its_gaps() {
    let Some(shared) = shared() else { return };
    let inspection = load(&shared, "INTO-CPS-Association-aurt/wave_currentData_100v_40a.csv.gz");
    assert_eq!((inspection.samples, inspection.sampling.gaps.len()), (6887, 73));
    near(inspection.sampling.step_max_s, 0.024, 1e-6);
    for (j, noise) in [0.013, 0.011, 0.006, 0.007, 0.009, 0.009].into_iter().enumerate() {
        near(current(&inspection)[j].noise, noise, 0.0006);
    }
    let says = |part: &str| inspection.findings.iter().any(|f| f.contains(part));
    assert!(says("joints 1, 3, 4, 5, 6: no motion"));
    assert!(says("joint_control_output repeats target_current"));
}

#[test]
fn the_ur10e_recording_shows_its_uneven_steps_and_noise() {
    let Some(shared) = shared() else { return };
    let name =
        "shamilmamedov-dynamic_calibration/identification_data/ur-20_02_19_14harm50sec.csv.gz";
    let inspection = load(&shared, name);
    near(inspection.sampling.mean_hz, 95.3, 0.1);
    near(inspection.moving_s, 50.3, 0.1);
    for (j, speed) in [1.28, 0.99, 1.19, 0.85, 1.04, 1.23].into_iter().enumerate() {
        near(inspection.motion[j].top_speed(), speed, 0.006);
    }
    let known = [(0.045, 0.067), (0.035, 0.055), (0.022, 0.031), (0.012, 0.016)];
    for (column, (low, high)) in current(&inspection).iter().zip(known) {
        assert!((low..high).contains(&column.noise), "{column:?}");
    }
    let rms = [2.16, 7.17, 3.00, 0.43, 0.38, 0.34];
    rms.into_iter().enumerate().for_each(|(j, x)| near(current(&inspection)[j].rms, x, 0.006));
}
