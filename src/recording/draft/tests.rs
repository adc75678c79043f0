//! Tables whose columns are known are drafted, and read back by the draft as what they are.

use super::*;
use crate::recording::{ColumnMap, Recording, read_by};

const ROWS: usize = 1500;

/// Position, velocity and current of joint `j` at row `k` of a 100 Hz log.
fn state(j: usize, k: usize) -> [f64; 3] {
    let w = std::f64::consts::TAU * (0.2 + 0.07 * j as f64);
    let t = 0.01 * k as f64;
    let (s, c) = (w * t + j as f64).sin_cos();
    let noise = 1e-5 * ((k * k + j) as f64).sin();
    [0.8 * s + noise, 0.8 * w * c, 1.5 * c.signum() + 0.4 * c]
}

/// Rows of time, then six of each quantity, in other units.
fn rows(time: f64, scales: [f64; 3], mark: &str) -> String {
    let row = |k: usize| {
        let mut cells = vec![format!("{}", 0.01 * time * k as f64)];
        for (quantity, scale) in scales.iter().enumerate() {
            cells.extend((0..6).map(|j| format!("{:.7}", scale * state(j, k)[quantity])));
        }
        cells.join(mark) + "\n"
    };
    (0..ROWS).map(row).collect()
}

fn header(names: [&str; 3], mark: &str, from: usize) -> String {
    let mut cells = vec!["time".to_string()];
    for name in names {
        cells.extend((from..from + 6).map(|j| format!("{name}{j}")));
    }
    cells.join(mark) + "\n"
}

#[track_caller]
fn drafted(text: &str) -> (Draft, Recording) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.txt");
    std::fs::write(&path, text).unwrap();
    let draft = draft(&path).unwrap_or_else(|e| panic!("{e}"));
    let map =
        ColumnMap::parse(&draft.map, "draft").unwrap_or_else(|e| panic!("{e}\n{}", draft.map));
    let recording = read_by(&path, Some(&map)).unwrap_or_else(|e| panic!("{e}\n{}", draft.map));
    (draft, recording)
}

#[track_caller]
fn is_what_it_was(recording: &Recording, map: &str) {
    assert_eq!(recording.time.len(), ROWS, "{map}");
    for (quantity, stem) in ["actual_q", "actual_qd", "actual_current"].iter().enumerate() {
        for j in 0..6 {
            let values =
                recording.channel(&format!("{stem}_{j}")).unwrap_or_else(|| panic!("{map}"));
            for k in [10, 700] {
                let off = values[k] - state(j, k)[quantity];
                assert!(off.abs() < 1e-3, "{stem}_{j}, row {k}: off by {off}\n{map}");
            }
        }
    }
    assert!((recording.time[100] - recording.time[0] - 1.0).abs() < 1e-6, "{map}");
}

#[test]
fn names_and_sizes_tell_columns_and_units() {
    let degree = 57.295_779_513;
    for (names, scales, time, mark, from) in [
        (["q_", "qd_", "current_"], [1.0, 1.0, 1.0], 1.0, ",", 0),
        (["joint_pos_", "joint_vel_", "motorCurrent"], [degree, degree, 1000.0], 1000.0, ",", 1),
        (["position", "speed", "I"], [degree, 1.0, 1.0], 1e6, "\t", 1),
        (["theta", "dq", "i"], [1.0, degree, 1.0], 1e9, ";", 1),
    ] {
        let text = header(names, mark, from) + &rows(time, scales, mark);
        let (draft, recording) = drafted(&text);
        is_what_it_was(&recording, &draft.map);
        assert_eq!(draft.joints, 6);
    }
}

#[test]
fn numbers_tell_columns_that_have_no_names() {
    let (draft, recording) = drafted(&rows(1.0, [1.0, 1.0, 1.0], " "));
    is_what_it_was(&recording, &draft.map);
    assert!(draft.map.contains("first = 2, count = 6"), "{}", draft.map);
    assert!(draft.map.contains("current, A, or torque, N.m?"), "{}", draft.map);
}

#[test]
fn decimal_commas_and_a_preamble_are_read_past() {
    let table = header(["q", "qd", "i"], ";", 1) + &rows(1.0, [1.0, 1.0, 1.0], ";");
    let text = format!("Logger 3\nMonday\n{}", table.replace('.', ","));
    let (draft, recording) = drafted(&text);
    is_what_it_was(&recording, &draft.map);
    assert!(draft.map.contains("decimal = \",\"") && draft.map.contains("skip_rows = 2"));
}

#[test]
fn a_table_of_something_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (text, part) in [
        ("a,b\n1,2\n1,3\n0,4\n", "neither names nor numbers"),
        ("a,b\n2,2\n1,2\n0,1\n", "no column of it rises"),
        ("some words\nand others\n", "no rows of numbers"),
    ] {
        let path = folder.path().join("log.txt");
        std::fs::write(&path, text).unwrap();
        let why = draft(&path).unwrap_err().to_string();
        assert!(why.contains(part) && why.contains("log.txt"), "{why}");
    }
}
