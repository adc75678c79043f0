//! The file is read back with the library that wrote it, and by the viewer where it is installed.

use std::collections::BTreeMap;
use std::process::Command;

use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};

use super::*;
use crate::case_studies::figures::Figure;
use crate::figure::{Drawn, Line, Panel, Scale, over_time};
use crate::robot::Robot;
use crate::series::JointSeries;

fn arm() -> Robot {
    crate::robot::builtin("ur5").unwrap()
}

fn series(time: &[f64], f: impl Fn(usize, f64) -> f64) -> JointSeries {
    let rows: Vec<Vec<f64>> = (0..6).map(|j| time.iter().map(|&t| f(j, t)).collect()).collect();
    JointSeries::from_joints(&rows)
}

/// Sines, with a twin that lags a little and predicts torque without the ripple.
fn comparison(samples: usize) -> Comparison {
    let time: Vec<f64> = (0..samples).map(|k| k as f64 * 0.008).collect();
    let rest = [0.3, -1.2, 1.5, -1.8, -1.57, 0.0];
    let angle = |j: usize, t: f64| rest[j] + 0.7 * ((0.5 + 0.13 * j as f64) * t).sin();
    let speed = |j: usize, t: f64| {
        let w = 0.5 + 0.13 * j as f64;
        0.7 * w * (w * t).cos()
    };
    let torque = |j: usize, t: f64| 40.0 / (j + 1) as f64 * (0.9 * t).sin();
    let ripple = |j: usize, t: f64| 2.0 / (j + 1) as f64 * (25.0 * t).sin();
    Comparison {
        title: "sines".into(),
        robot: arm(),
        recorded: Motion { q: series(&time, angle), qd: series(&time, speed) },
        simulated: Motion {
            q: series(&time, |j, t| angle(j, t - 0.1)),
            qd: series(&time, |j, t| speed(j, t - 0.1)),
        },
        target_q: Some(series(&time, angle)),
        torque: Torque {
            measured: series(&time, |j, t| torque(j, t) + ripple(j, t)),
            predicted: series(&time, torque),
        },
        summary: "# Sines\n\n| joint | rms |\n|---|---|\n| 1 | 0.5 |\n".into(),
        time,
    }
}

/// The chunks of the recording (not of the blueprint) in a file, by entity path.
fn chunks(path: &std::path::Path) -> BTreeMap<String, Vec<Chunk>> {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut found: BTreeMap<String, Vec<Chunk>> = BTreeMap::new();
    for message in DecoderApp::decode_lazy(file) {
        if let LogMsg::ArrowMsg(store, arrow) = message.unwrap()
            && store.is_recording()
        {
            let chunk = Chunk::from_arrow_msg(&arrow).unwrap();
            found.entry(chunk.entity_path().to_string()).or_default().push(chunk);
        }
    }
    found
}

fn written(comparison: &Comparison) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("twin.rrd");
    write_rrd(comparison, &path).unwrap();
    (folder, path)
}

/// Rows and last time (s) of an entity that is logged in one piece on the timeline.
fn extent(chunks: &[Chunk]) -> (usize, f64) {
    let timed: Vec<_> = chunks.iter().filter(|c| !c.is_static()).collect();
    assert_eq!(timed.len(), 1, "one chunk on the timeline");
    let times = timed[0].timelines().values().next().unwrap();
    assert_eq!(times.name(), plots::TIMELINE);
    (timed[0].num_rows(), *times.times_raw().last().unwrap() as f64 * 1e-9)
}

#[test]
fn every_quantity_of_every_joint_is_there_to_the_last_sample() {
    let comparison = comparison(1001);
    let (_folder, path) = written(&comparison);
    let found = chunks(&path);
    for joint in 0..6 {
        for quantity in plots::QUANTITIES {
            let entity = format!("/{}", plots::entity(joint, quantity));
            assert_eq!(extent(&found[&entity]), (1001, 8.0), "{entity}");
        }
    }
    assert!(found.contains_key("/summary"));
}

#[test]
fn curves_hold_the_values_they_are_named_after() {
    let comparison = comparison(300);
    let (_folder, path) = written(&comparison);
    let found = chunks(&path);
    let row = |quantity: &plots::Quantity, k: usize| -> Vec<f64> {
        let chunks = &found[&format!("/{}", plots::entity(2, quantity))];
        let timed = chunks.iter().find(|c| !c.is_static()).unwrap();
        let scalars = rerun::Scalars::descriptor_scalars().component;
        timed.iter_slices::<f64>(scalars).nth(k).unwrap().to_vec()
    };
    let at = |series: &JointSeries| series.joint(2)[250];
    let (measured, predicted) = (at(&comparison.torque.measured), at(&comparison.torque.predicted));
    let (recorded, simulated) = (at(&comparison.recorded.q), at(&comparison.simulated.q));
    assert_eq!(row(&plots::TORQUE, 250), [measured, predicted]);
    assert_eq!(row(&plots::RESIDUAL, 250), [measured - predicted]);
    assert_eq!(
        row(&plots::ANGLE, 250),
        [at(comparison.target_q.as_ref().unwrap()), recorded, simulated]
    );
    assert_eq!(row(&plots::TRACKING, 250), [recorded - simulated]);
}

#[test]
fn both_arms_move_until_the_end_at_no_more_than_the_pose_rate() {
    let comparison = comparison(1001);
    let (_folder, path) = written(&comparison);
    let found = chunks(&path);
    for side in ["recorded", "simulated"] {
        let mut entity = format!("/arm/{side}");
        for body in &comparison.robot.bodies {
            entity += &format!("/{}", body.name);
            let (rows, last) = extent(&found[&entity]);
            assert!((190..=242).contains(&rows) && last == 8.0, "{entity}: {rows} rows to {last}");
            assert!(found.contains_key(&format!("{entity}/link")), "{entity} has a shape");
        }
        assert!(found.contains_key(&format!("/arm/{side}/flange_path")));
    }
}

#[test]
fn the_arrangement_comes_along_and_is_active() {
    let (_folder, path) = written(&comparison(11));
    let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
    let messages: Vec<LogMsg> = DecoderApp::decode_lazy(file).map(Result::unwrap).collect();
    let active = messages.iter().any(
        |m| matches!(m, LogMsg::BlueprintActivationCommand(c) if c.make_active && c.make_default),
    );
    let views = messages.iter().filter(|m| match m {
        LogMsg::ArrowMsg(store, arrow) if store.is_blueprint() => {
            let path = Chunk::from_arrow_msg(arrow).unwrap().entity_path().to_string();
            path.starts_with("/view/") && path.ends_with("/ViewContents")
        }
        _ => false,
    });
    assert!(active);
    assert_eq!(views.count(), 2 + 4 * 6 + 6 * plots::QUANTITIES.len());
}

/// Composes what the file says about each body's pose in its parent at one row.
#[test]
fn poses_in_the_file_are_those_of_the_kinematics() {
    use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
    let comparison = comparison(1);
    let (_folder, path) = written(&comparison);
    let found = chunks(&path);
    let mut entity = String::from("/arm/simulated");
    let mut pose = Isometry3::<f64>::identity();
    let q: Vec<f64> = (0..6).map(|j| comparison.simulated.q.joint(j)[0]).collect();
    let expected = crate::robot::body_placements(&comparison.robot, &q);
    for (body, expected) in comparison.robot.bodies.iter().zip(expected) {
        entity += &format!("/{}", body.name);
        let timed = found[&entity].iter().find(|c| !c.is_static()).unwrap();
        let translation = rerun::Transform3D::descriptor_translation().component;
        let quaternion = rerun::Transform3D::descriptor_quaternion().component;
        let t = timed.iter_slices::<[f32; 3]>(translation).next().unwrap()[0].map(f64::from);
        let [x, y, z, w] =
            timed.iter_slices::<[f32; 4]>(quaternion).next().unwrap()[0].map(f64::from);
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        pose *= Isometry3::from_parts(Translation3::new(t[0], t[1], t[2]), turn);
        let gap = (pose.translation.vector - expected.translation).norm();
        let turned = (pose.rotation.to_rotation_matrix().matrix() - expected.rotation).norm();
        assert!(gap < 1e-6 && turned < 1e-6, "{entity}: {gap} m, {turned}");
    }
}

#[test]
fn series_that_do_not_fit_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("twin.rrd");
    let mut short = comparison(100);
    short.torque.predicted = JointSeries::zeros(6, 99);
    let message = write_rrd(&short, &path).unwrap_err().to_string();
    assert!(message.contains("predicted torque has 6 joints and 99 samples"), "{message}");
    let mut empty = comparison(1);
    empty.time.clear();
    assert!(matches!(write_rrd(&empty, &path), Err(Error::Empty)));
    assert!(matches!(
        write_rrd(&comparison(10), &folder.path().join("no/folder.rrd")),
        Err(Error::Write { .. })
    ));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_viewer_itself_accepts_the_file() {
    let viewer = std::env::var("ARMTWIN_RERUN").unwrap_or_else(|_| "rerun".into());
    if Command::new(&viewer).arg("--version").output().is_err() {
        eprintln!("skipped: no rerun viewer on PATH or under ARMTWIN_RERUN");
        return;
    }
    let (_folder, path) = written(&comparison(500));
    let out = Command::new(&viewer).args(["rrd", "verify"]).arg(&path).output().unwrap();
    let said = String::from_utf8_lossy(&out.stdout) + String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success() && said.contains("1 file verified without error"), "{said}");
}

/// Half a second of one joint, a stretch of it left out, a reversal and a contact in it.
fn mending() -> Mending {
    let made = comparison(63);
    let joint = JointMending {
        time: vec![0.0, 0.1, 0.2, 0.4, 0.5],
        step: 0.1,
        measured: vec![3.0; 5],
        residual: vec![vec![1.0; 5], vec![0.25; 5]],
        reversal: vec![false, true, true, false, false],
        contact: vec![false, false, false, false, true],
    };
    Mending {
        title: made.title,
        robot: made.robot,
        time: made.time,
        recorded: made.recorded.q,
        simulated: vec![made.simulated.q.clone(), made.simulated.q],
        joints: vec![joint; 6],
        summary: "# Lacks".into(),
    }
}

#[test]
fn a_mending_holds_both_twins_gaps_and_marks() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("twin.rrd");
    write_rrd(&mending(), &path).unwrap();
    let found = chunks(&path);
    let rows = |entity: &str| -> Vec<Vec<f64>> {
        let timed = found[entity].iter().find(|c| !c.is_static()).unwrap();
        let scalars = rerun::Scalars::descriptor_scalars().component;
        timed.iter_slices::<f64>(scalars).map(|row| row.to_vec()).collect()
    };
    let torque = rows("/joint_3/torque");
    assert_eq!((torque.len(), &*torque[0]), (6, &[3.0, 2.0, 2.75][..]));
    assert!(torque[3][0].is_nan(), "a stretch is left out: {torque:?}");
    // Reversal, contact, both residuals.
    let residual = rows("/joint_3/residual");
    assert!(residual[1][0] == 0.0 && residual[1][1].is_nan() && residual[1][2..] == [1.0, 0.25]);
    assert!(residual[5][0].is_nan() && residual[5][1] == 0.0);
    for arm in ["recorded", "twin_as_given", "mended_twin"] {
        assert!(found.contains_key(&format!("/arm/{arm}/flange_path")), "{arm}");
    }
    assert!(found.contains_key("/joint_1/tracking") && found.contains_key("/summary"));
}

#[test]
fn a_twin_that_could_not_be_simulated_is_shown_by_its_torque() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("twin.rrd");
    let mut still = Mending { simulated: Vec::new(), ..mending() };
    write_rrd(&still, &path).unwrap();
    let found = chunks(&path);
    assert!(found.contains_key("/joint_6/residual") && !found.contains_key("/joint_6/tracking"));
    still.joints[0].residual[0].pop();
    assert!(write_rrd(&still, &path).is_err());
}

/// Two stretches with a gap, and a path.
fn figures() -> Vec<Figure> {
    let line = |label: &str| Line {
        label: label.into(),
        drawn: Drawn::Joined,
        points: over_time(&[0.0, 0.5, 2.5, 3.0], &[1.0, 2.0, 3.0, 4.0], 0.5),
        ..Line::default()
    };
    let panel = |title: &str| Panel {
        title: title.into(),
        up: ("N.m", Scale::Linear),
        lines: vec![line("measured"), line("PSO")],
        ..Panel::default()
    };
    let figure = |name: &str, panels, path| Figure {
        name: name.into(),
        caption: name.into(),
        panels,
        columns: 2,
        path,
    };
    vec![
        figure("torque", vec![panel("Joint 1"), panel("Joint 2")], vec![]),
        figure("path", vec![], vec![[0.1, 0.2, 0.3], [0.4, 0.2, 0.3]]),
    ]
}

#[test]
fn an_album_has_every_line_with_its_gaps_and_every_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("figures.rrd");
    let figures = figures();
    write_rrd(&Album { title: "figures", figures: &figures }, &path).unwrap();
    let found = chunks(&path);
    for entity in ["/torque/joint_1/1", "/torque/joint_1/2", "/torque/joint_2/1"] {
        assert_eq!(extent(&found[entity]), (5, 3.0), "{entity}");
        let timed = found[entity].iter().find(|c| !c.is_static()).unwrap();
        let scalars = rerun::Scalars::descriptor_scalars().component;
        let values: Vec<f64> = timed.iter_slices::<f64>(scalars).map(|v| v[0]).collect();
        assert_eq!((values[1], values[3], values[4]), (2.0, 3.0, 4.0));
        assert!(values[2].is_nan(), "{values:?}");
    }
    assert!(found.contains_key("/path/path"));
    let none = write_rrd(&Album { title: "none", figures: &[] }, &path);
    assert!(matches!(none, Err(Error::Empty)));
}
