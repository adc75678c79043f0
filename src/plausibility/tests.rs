//! A recording made by Newton and Euler alone is spoilt in every way that files come in: each is told. What
//! arms differ by (loads, gains, tilts, delays, offsets, friction) is not.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::*;
use crate::recording::{Channel, Provenance};
use crate::robot::{Drive, Robot, builtin, inverse_dynamics_series};
use crate::series::JointSeries;

const RATE: f64 = 125.0;
const ROWS: usize = 5000;

/// What the arm has that its twin does not know.
struct Truth {
    robot: Robot,
    gain: f64,
    friction: f64,
    delay_rows: usize,
    offset: f64,
    /// A spring that carries the arm at joint 2, N.m/rad.
    spring: f64,
}

impl Default for Truth {
    fn default() -> Self {
        let robot = Twin::default().robot;
        Self { robot, gain: 1.0, friction: 1.0, delay_rows: 0, offset: 0.0, spring: 0.0 }
    }
}

/// Angle, speed and acceleration of a joint: two sines of its own, around a pose above the table.
fn motion(joint: usize, t: f64) -> [f64; 3] {
    let home = [0.0, -1.4, 1.2, -1.3, -1.5, 0.0][joint % 6];
    let mut state = [home, 0.0, 0.0];
    for (amplitude, hz, phase) in [(0.5, 0.09, 0.3), (0.25, 0.21, 1.1)] {
        let w = std::f64::consts::TAU * hz * (1.0 + 0.13 * joint as f64);
        let (s, c) = (w * t + phase + joint as f64).sin_cos();
        state[0] += amplitude * s;
        state[1] += amplitude * w * c;
        state[2] -= amplitude * w * w * s;
    }
    state
}

/// What the sensors of such an arm record: position, velocity, motor current.
fn recorded(truth: &Truth) -> Recording {
    let time: Vec<f64> = (0..ROWS).map(|k| k as f64 / RATE).collect();
    let dof = truth.robot.dof();
    let series = |which: usize| {
        let rows: Vec<Vec<f64>> =
            (0..dof).map(|j| time.iter().map(|t| motion(j, *t)[which]).collect()).collect();
        JointSeries::from_joints(&rows)
    };
    let [q, qd, qdd] = [0, 1, 2].map(series);
    let rigid = inverse_dynamics_series(&truth.robot, &q, &qd, &qdd);
    let drive = Drive::ur5();
    let mut channels = Vec::new();
    for j in 0..dof {
        let dry = truth.friction * if j < 3 { 6.0 } else { 1.5 };
        let torque = |k: usize| {
            let k = k.saturating_sub(truth.delay_rows);
            let v: f64 = qd.joint(j)[k];
            let spring = if j == 1 { truth.spring * (q.joint(j)[k] + 1.4) } else { 0.0 };
            rigid.joint(j)[k] + dry * v.signum() + 1.5 * dry * v + spring
        };
        let wobble = |k: usize| 0.02 * ((7 * k + 3 * j) as f64 * 1.7).sin();
        let constant = truth.gain * drive.torque_per_ampere(j.min(5));
        let current = (0..ROWS).map(|k| torque(k) / constant + wobble(k)).collect();
        let shown = q.joint(j).iter().map(|q| q + truth.offset).collect();
        channels.push((format!("actual_q_{j}"), shown));
        channels.push((format!("actual_qd_{j}"), qd.joint(j).to_vec()));
        channels.push((format!("actual_current_{j}"), current));
    }
    let channels = channels.into_iter().map(|(name, values)| Channel { name, values }).collect();
    Recording { time, channels, provenance: Provenance::default() }
}

fn column<'a>(recording: &'a mut Recording, name: &str) -> &'a mut Vec<f64> {
    &mut recording.channels.iter_mut().find(|c| c.name == name).unwrap().values
}

fn scale(recording: &mut Recording, stem: &str, factor: f64) {
    for j in 0..6 {
        column(recording, &format!("{stem}_{j}")).iter_mut().for_each(|v| *v *= factor);
    }
}

fn swap(recording: &mut Recording, stems: &[&str], a: usize, b: usize) {
    for stem in stems {
        let names = [format!("{stem}_{a}"), format!("{stem}_{b}")];
        let first = column(recording, &names[0]).clone();
        let second = std::mem::replace(column(recording, &names[1]), first);
        *column(recording, &names[0]) = second;
    }
}

fn held(recording: &Recording, assumed: bool) -> Judgement {
    let twin = Twin::default();
    judge(recording, &Arm { twin: &twin, assumed, scaled: true })
}

#[track_caller]
fn doubted(recording: &Recording, parts: &[&str]) {
    let doubts = held(recording, false).doubts;
    let words: Vec<String> = doubts.iter().map(|d| format!("{}; {}", d.what, d.remedy)).collect();
    assert!(!words.is_empty(), "no doubt, expected {parts:?}");
    for part in parts {
        assert!(words.join("\n").contains(part), "{part:?} not in {words:#?}");
    }
}

const ALL: [&str; 3] = ["actual_q", "actual_qd", "actual_current"];

#[test]
fn what_it_says_it_is_raises_no_doubt_and_carries_the_arm() {
    let found = held(&recorded(&Truth::default()), true);
    assert_eq!(found.doubts, []);
    let slope = found.slopes[1].unwrap();
    assert!((slope.value - 1.0).abs() < 0.05 && slope.explained > 0.95, "{slope:?}");
    assert_eq!(found.slopes[0], None);
}

#[test]
fn whatever_a_diagnosis_is_for_raises_no_doubt() {
    let robot = || Truth::default().robot;
    let tilted = |angle: f64| {
        let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), angle);
        Robot { gravity: turn * robot().gravity, ..robot() }
    };
    let loaded = |kg: f64| robot().with_payload(kg, Vector3::new(0.05, 0.0, 0.1), Matrix3::zeros());
    let heavier = || {
        let mut robot = robot();
        robot.bodies.iter_mut().for_each(|b| b.inertia.mass *= 1.3);
        robot
    };
    for (name, truth) in [
        ("5 kg", Truth { robot: loaded(5.0), ..Truth::default() }),
        ("2 kg", Truth { robot: loaded(2.0), ..Truth::default() }),
        ("tilt", Truth { robot: tilted(0.5), ..Truth::default() }),
        ("tilt back", Truth { robot: tilted(-0.5), ..Truth::default() }),
        ("heavier", Truth { robot: heavier(), ..Truth::default() }),
        ("gain", Truth { gain: 1.5, ..Truth::default() }),
        ("gain", Truth { gain: 0.6, ..Truth::default() }),
        ("rough", Truth { friction: 4.0, ..Truth::default() }),
        ("smooth", Truth { friction: 0.0, ..Truth::default() }),
        ("late", Truth { delay_rows: 12, ..Truth::default() }),
        ("offset", Truth { offset: 0.2, ..Truth::default() }),
        ("spring", Truth { spring: 60.0, ..Truth::default() }),
        ("counterbalance", Truth { spring: 150.0, ..Truth::default() }),
        ("outweighed", Truth { spring: 400.0, ..Truth::default() }),
    ] {
        let found = held(&recorded(&truth), name != "5 kg");
        assert_eq!(found.doubts, [], "{name}: {:?}", found.slopes);
    }
}

#[test]
fn units_are_told() {
    let spoilt = |stems: &[(&str, f64)]| {
        let mut recording = recorded(&Truth::default());
        stems.iter().for_each(|(stem, factor)| scale(&mut recording, stem, *factor));
        recording
    };
    let degrees = 57.295_779_513;
    doubted(&spoilt(&[("actual_q", degrees)]), &["joints 1, 2, 3, 4, 5, 6", "degrees"]);
    doubted(&spoilt(&[("actual_qd", degrees)]), &["actual_qd is in degrees/s"]);
    doubted(
        &spoilt(&[("actual_qd", 2.0)]),
        &["actual_qd is 2.0000 times what actual_q changes by"],
    );
    doubted(&spoilt(&[("actual_q", degrees), ("actual_qd", degrees)]), &["read in degrees"]);
    doubted(&spoilt(&[("actual_current", 1000.0)]), &["in mA", "joint 2"]);
    doubted(&spoilt(&[("actual_current", 13.6)]), &["holds torque"]);
    // A motion in which weight hardly varies: the size alone tells.
    let mut still = spoilt(&[("actual_current", 1000.0)]);
    for j in 1..6 {
        for stem in ["actual_q", "actual_qd"] {
            let first = column(&mut still, &format!("{stem}_{j}"))[0];
            column(&mut still, &format!("{stem}_{j}")).fill(if stem == "actual_q" {
                first
            } else {
                0.0
            });
        }
    }
    doubted(&still, &["times the most that the ur5 can give", "mA"]);
    let mut milliseconds = recorded(&Truth::default());
    milliseconds.time.iter_mut().for_each(|t| *t *= 1000.0);
    doubted(&milliseconds, &["milliseconds", "time_scale = 1e-3"]);
    assert_eq!(held(&milliseconds, false).doubts.len(), 1);
}

#[test]
fn signs_are_told() {
    for stem in ALL {
        let mut recording = recorded(&Truth::default());
        scale(&mut recording, stem, -1.0);
        let words = match stem {
            "actual_current" => "opposite sign at every joint",
            _ => "goes the other way",
        };
        doubted(&recording, &[words]);
    }
    for j in 0..6 {
        let mut recording = recorded(&Truth::default());
        column(&mut recording, &format!("actual_current_{j}")).iter_mut().for_each(|v| *v *= -1.0);
        doubted(&recording, &[&format!("joint {}: the recorded torque has the opposite", j + 1)]);
        let mut recording = recorded(&Truth::default());
        for stem in ["actual_q", "actual_qd"] {
            column(&mut recording, &format!("{stem}_{j}")).iter_mut().for_each(|v| *v *= -1.0);
        }
        doubted(&recording, &[&format!("joint {}: ", j + 1)]);
    }
    let mut hangs = Truth::default();
    hangs.robot.gravity *= -1.0;
    doubted(&recorded(&hangs), &["upside down"]);
}

#[test]
fn orders_are_told() {
    for (a, b) in [(0, 2), (1, 2), (0, 5), (3, 4), (4, 5)] {
        for stem in ALL {
            let mut recording = recorded(&Truth::default());
            swap(&mut recording, &[stem], a, b);
            doubted(&recording, &["in another order"]);
        }
    }
    let mut by_alphabet = recorded(&Truth::default());
    swap(&mut by_alphabet, &ALL, 0, 2);
    doubted(&by_alphabet, &["the joints are in another order", "1, 3"]);
    let mut without_speed = by_alphabet.clone();
    without_speed.channels.retain(|c| !c.name.starts_with("actual_qd"));
    doubted(&without_speed, &["the joints are in another order"]);
}

#[test]
fn a_velocity_of_something_else_is_told() {
    let mut recording = recorded(&Truth::default());
    *column(&mut recording, "actual_qd_2") = (0..ROWS).map(|k| (0.05 * k as f64).sin()).collect();
    doubted(&recording, &["joint 3: actual_qd is not what actual_q changes by"]);
}

/// A gripper's velocity may be that of its motor.
#[test]
fn a_factor_of_one_joint_alone_is_its_own_affair() {
    let mut recording = recorded(&Truth::default());
    column(&mut recording, "actual_qd_5").iter_mut().for_each(|v| *v *= 2.3);
    assert_eq!(held(&recording, false).doubts, []);
    // It hides no wrong unit of all others.
    for j in 0..6 {
        column(&mut recording, &format!("actual_qd_{j}")).iter_mut().for_each(|v| *v *= 2.0);
    }
    doubted(&recording, &["joints 1, 2, 3, 4, 5: actual_qd is 2.0000 times"]);
}

#[test]
fn an_arm_that_nobody_named_is_told_by_its_weight() {
    let small = recorded(&Truth { robot: builtin("ur3e").unwrap(), ..Truth::default() });
    let doubts = held(&small, true).doubts;
    assert!(doubts[0].what.contains("assumed because no arm was named"), "{doubts:?}");
    assert_eq!(held(&small, false).doubts, []);
    let mut torque = small;
    for j in 0..6 {
        let constant = Drive::ur5().torque_per_ampere(j);
        let channel = torque.channels.iter_mut().find(|c| c.name == format!("actual_current_{j}"));
        let channel = channel.unwrap();
        channel.name = format!("joint_torque_{j}");
        channel.values.iter_mut().for_each(|v| *v *= constant);
    }
    let doubts = held(&torque, true).doubts;
    assert!(doubts[0].remedy.contains("ur3e"), "{doubts:?}");
    assert_eq!(likely_arms(&torque)[0].0, "ur3e");
}

/// Every recording of real arms that is at hand, with the twin of its arm, and every case of another simulator.
#[test]
fn real_recordings_raise_no_doubt() {
    let root = std::path::PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let shared =
        std::env::var_os("ARMTWIN_SHARED").map_or(root.join("../shared"), std::path::PathBuf::from);
    if !shared.join("recordings").is_dir() {
        return eprintln!("skipped: no recordings under {}", shared.display());
    }
    let twin = |name: &str| Twin::load(&root.join("scenarios/twins").join(name)).unwrap();
    let map = |name: &str| Some(root.join("scenarios/columns").join(name));
    let mut seen = 0;
    let mut held = |path: &std::path::Path, map: Option<&std::path::Path>, twin: &Twin, assumed| {
        let recording = crate::recording::read(path, map).unwrap();
        let found = judge(&recording, &Arm { twin, assumed, scaled: true });
        assert_eq!(found.doubts, [], "{}: {:?}", path.display(), found.slopes);
        seen += 1;
    };
    let (ur5, ur10e) = (twin("ur5.toml"), twin("ur10e.toml"));
    let (usual, collision) =
        (map("ur10e_shamilmamedov.toml"), map("ur10e_shamilmamedov_collision.toml"));
    let mut open = vec![shared.join("recordings"), shared.join("practice")];
    while let Some(folder) = open.pop() {
        for path in std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()) {
            let name = path.to_string_lossy().into_owned();
            let is_log = name.ends_with(".csv.gz") && !name.contains("/log_");
            match () {
                () if path.join("log_q_actual.csv.gz").is_file() => held(&path, None, &ur5, true),
                () if ["so101", "xl330", "pendulum"].iter().any(|n| name.contains(n)) => {}
                () if path.is_dir() => open.push(path),
                () if is_log && name.contains("collision_detection_data") => {
                    held(&path, collision.as_deref(), &ur10e, false);
                }
                () if is_log && name.contains("shamilmamedov") => {
                    held(&path, usual.as_deref(), &ur10e, false);
                }
                () if is_log => held(&path, None, &ur5, true),
                () => {}
            }
        }
    }
    assert!(seen >= 35, "{seen} recordings");
}

#[test]
fn effort_is_told_by_the_weight_of_the_arm_that_is_named() {
    let drive = Drive::ur5();
    for (stem, torque) in [("actual_current", false), ("joint_torque", true)] {
        let mut recording = recorded(&Truth::default());
        for channel in &mut recording.channels {
            let Some(j) = channel.name.strip_prefix("actual_current_") else { continue };
            let j: usize = j.parse().unwrap();
            let factor = if torque { drive.torque_per_ampere(j) } else { 1.0 };
            channel.values.iter_mut().for_each(|v| *v *= factor);
            channel.name = format!("effort_{j}");
        }
        crate::recording::settle_effort(&mut recording, &Twin::default().robot);
        assert_eq!(recording.joint_count(stem), 6, "{:?}", recording.provenance.notes);
        assert!(recording.provenance.notes[0].contains("by gravity"));
        assert_eq!(held(&recording, false).doubts, []);
    }
}
