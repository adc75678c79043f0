//! Every format is read back.

use std::path::Path;
use std::sync::OnceLock;

use super::*;
use crate::excitation::tests::{request, twin};
use crate::excitation::{Ask, design};
use crate::recording::read;
use crate::simulation::Scenario;

fn designed() -> &'static Design {
    static MADE: OnceLock<Design> = OnceLock::new();
    MADE.get_or_init(|| {
        let ask = Ask::learn("coulomb", 6).unwrap();
        design(&twin(), &request(ask, 4, 30), |_| ()).unwrap()
    })
}

fn at(design: &Design, t: f64) -> [[f64; 6]; 3] {
    let [mut q, mut qd, mut qdd] = [[0.0; 6]; 3];
    design.trajectory.at(t, &mut q, &mut qd, &mut qdd);
    [q, qd, qdd]
}

#[test]
fn csv_is_read_by_this_program() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("next.csv");
    files(designed(), &[&path]).unwrap();
    let recording = read(&path, None).unwrap();
    assert_eq!(recording.time.len(), 1251);
    for (i, stem) in ["target_q", "target_qd", "target_qdd"].into_iter().enumerate() {
        let series = recording.joints(stem).unwrap();
        for k in [0, 100, 777, 1250] {
            let expected = at(designed(), recording.time[k])[i];
            (0..6).for_each(|j| assert!((series.joint(j)[k] - expected[j]).abs() < 1e-9));
        }
    }
    // Level upper arm and forearm: what holds them is no small torque.
    let moment = recording.joints("target_moment").unwrap();
    assert!(moment.joint(1).iter().any(|t| t.abs() > 20.0));
}

/// The YAML as JSON: keys in quotes, blocks as braces.
#[test]
fn joint_trajectory_is_what_ros_expects() {
    let text = text(designed(), Format::JointTrajectory);
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let names = lines.next().unwrap().strip_prefix("joint_names: ").unwrap();
    let names: Vec<String> = serde_json::from_str(names).unwrap();
    assert_eq!(names[2], "elbow_joint");
    assert_eq!(lines.next(), Some("points:"));
    let lines: Vec<&str> = lines.collect();
    assert_eq!(lines.len(), 4 * 251);
    let mut before = -1.0;
    for (k, point) in lines.chunks(4).enumerate() {
        let keys = ["- positions: ", "  velocities: ", "  accelerations: "];
        let time = point[3].strip_prefix("  time_from_start: ").unwrap();
        let time = time.replace("sec:", "\"sec\":").replace("nano\"sec\":", "\"nanosec\":");
        let time: serde_json::Value = serde_json::from_str(&time).unwrap();
        let (sec, nanosec) = (time["sec"].as_u64().unwrap(), time["nanosec"].as_u64().unwrap());
        let t = sec as f64 + 1e-9 * nanosec as f64;
        assert!(t > before && (t - 0.04 * k as f64).abs() < 1e-9 && nanosec < 1_000_000_000);
        before = t;
        for (i, key) in keys.into_iter().enumerate() {
            let values: Vec<f64> =
                serde_json::from_str(point[i].strip_prefix(key).unwrap()).unwrap();
            let expected = at(designed(), t)[i];
            assert!(values.iter().zip(expected).all(|(v, e)| (v - e).abs() < 1e-8), "{t} s");
        }
    }
}

#[test]
fn urscript_is_balanced_and_follows_the_motion() {
    let text = text(designed(), Format::UrScript);
    let code: Vec<&str> =
        text.lines().map(|l| l.split('#').next().unwrap_or_default().trim()).collect();
    let begins = code.iter().filter(|l| l.starts_with("def ") || l.starts_with("while ")).count();
    assert_eq!(begins, code.iter().filter(|l| **l == "end").count());
    for (open, close) in [('(', ')'), ('[', ']')] {
        assert!(code.iter().all(|l| l.matches(open).count() == l.matches(close).count()));
    }
    assert_eq!(code.iter().filter(|l| l.starts_with("movej([")).count(), 1);
    let knots: Vec<[Vec<f64>; 2]> = code
        .iter()
        .filter_map(|l| l.strip_prefix("to([")?.strip_suffix("])"))
        .map(|l| {
            let (q, v) = l.split_once("], [").unwrap();
            [q, v].map(|list| list.split(", ").map(|x| x.parse().unwrap()).collect())
        })
        .collect();
    assert_eq!(knots.len(), 250);
    // Between knots, by the program's own cubic.
    let h = urscript::KNOT_S;
    for (k, pair) in knots.windows(2).enumerate() {
        let u = 0.3;
        let [[q0, v0], [q1, v1]] = [&pair[0], &pair[1]];
        let expected = at(designed(), h * (k as f64 + 1.0 + u))[0];
        for j in 0..6 {
            let (a, b) = ((1.0 + 2.0 * u) * (1.0 - u) * (1.0 - u), h * u * (1.0 - u) * (1.0 - u));
            let (c, d) = (u * u * (3.0 - 2.0 * u), h * u * u * (u - 1.0));
            let q = a * q0[j] + b * v0[j] + c * q1[j] + d * v1[j];
            assert!((q - expected[j]).abs() < 1e-5, "knot {k} joint {j}: {q} {}", expected[j]);
        }
    }
}

#[test]
fn the_scenario_is_the_motion_and_the_twin() {
    let text = text(designed(), Format::Scenario);
    let scenario = Scenario::parse(&text, "next.toml").unwrap();
    let made = scenario.work_out("next.toml").unwrap();
    assert_eq!(made.fit, designed().trajectory);
    assert_ne!(made.check, made.fit);
    let names: Vec<_> = made.setup.effects.iter().map(|i| i.effect.about().name).collect();
    assert_eq!(names, ["coulomb", "viscous"]);
    assert_eq!(made.setup.drive.rotor_inertia, twin().drive.rotor_inertia);
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let make = |seed: u64| {
        let ask = Ask::learn("coulomb", 6).unwrap();
        let made = design(&twin(), &request(ask, seed, 30), |_| ()).unwrap();
        [Format::Csv, Format::JointTrajectory, Format::UrScript, Format::Scenario]
            .map(|f| super::text(&made, f))
    };
    let again = make(4);
    for (i, format) in [Format::Csv, Format::JointTrajectory].into_iter().enumerate() {
        assert!(again[i] == super::text(designed(), format), "{format:?}");
    }
    assert!(again[3] == super::text(designed(), Format::Scenario));
    assert!(again != make(5));
}

#[test]
fn names_say_what_a_file_is() {
    assert_eq!(Format::of(Path::new("a/b.YML")).unwrap(), Format::JointTrajectory);
    let message = Format::of(Path::new("b.txt")).unwrap_err().to_string();
    assert!(message.contains("b.txt") && message.contains(".script"), "{message}");
    let folder = tempfile::TempDir::new().unwrap();
    let paths = [folder.path().join("a.csv"), folder.path().join("b.txt")];
    assert!(files(designed(), &paths).is_err());
    assert!(!paths[0].exists(), "half of the files were written");
}
