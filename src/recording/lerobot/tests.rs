//! Data sets as LeRobot writes them, both layouts, and broken ones.

use std::path::Path;
use std::sync::Arc;

use arrow::array::{ArrayRef, FixedSizeListArray, Float32Array, Int64Array, RecordBatch};
use arrow::datatypes::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;

use super::*;

fn info(version: &str, path: &str) -> String {
    format!(
        "{{\"codebase_version\": \"{version}\", \"robot_type\": \"so101_follower\", \"fps\": 30, \
         \"total_episodes\": 2, \"chunks_size\": 1000, \"data_path\": \"{path}\", \"features\": {{\
         \"action\": {{\"dtype\": \"float32\", \"shape\": [2], \"names\": [\"pan.pos\", \"gripper.pos\"]}}, \
         \"observation.state\": {{\"dtype\": \"float32\", \"shape\": [2], \
         \"names\": [\"pan.pos\", \"gripper.pos\"]}}}}}}"
    )
}

/// Rows of these episodes, 20 each; pan is at 10 deg times the row, the gripper at 50.
fn write(file: &Path, episodes: &[i64]) {
    write_holed(file, episodes, None);
}

/// As above, without a number in one row.
fn write_holed(file: &Path, episodes: &[i64], hole: Option<usize>) {
    let item = Arc::new(Field::new("item", DataType::Float32, true));
    let list = |shift: f32| -> ArrayRef {
        let pan = |k: usize| 10.0 * (k % 20) as f32 + shift;
        let row = |k: usize| [if hole == Some(k) { f32::NAN } else { pan(k) }, 50.0];
        let values = Float32Array::from_iter_values((0..20 * episodes.len()).flat_map(row));
        Arc::new(FixedSizeListArray::new(item.clone(), 2, Arc::new(values), None))
    };
    let each = |of: &dyn Fn(i64, usize) -> i64| -> ArrayRef {
        let rows = episodes.iter().flat_map(|e| (0..20).map(move |k| (*e, k)));
        Arc::new(Int64Array::from_iter_values(rows.map(|(e, k)| of(e, k))))
    };
    let time = (0..20 * episodes.len()).map(|k| (k % 20) as f32 / 30.0);
    let columns: Vec<(&str, ArrayRef)> = vec![
        ("action", list(1.0)),
        ("observation.state", list(0.0)),
        ("timestamp", Arc::new(Float32Array::from_iter_values(time))),
        ("frame_index", each(&|_, k| k as i64)),
        ("episode_index", each(&|e, _| e)),
    ];
    let field = |(name, c): &(&str, ArrayRef)| Field::new(*name, c.data_type().clone(), true);
    let schema = Arc::new(Schema::new(columns.iter().map(field).collect::<Vec<_>>()));
    let batch = RecordBatch::try_new(schema.clone(), columns.into_iter().map(|(_, c)| c).collect())
        .unwrap();
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    let mut out = ArrowWriter::try_new(std::fs::File::create(file).unwrap(), schema, None).unwrap();
    out.write(&batch).unwrap();
    out.close().unwrap();
}

fn set(version: &str) -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    let path = match version {
        "v3.0" => "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        _ => "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
    };
    std::fs::create_dir_all(root.path().join("meta")).unwrap();
    std::fs::write(root.path().join(INFO), info(version, path)).unwrap();
    let data = root.path().join("data/chunk-000");
    match version {
        "v3.0" => write(&data.join("file-000.parquet"), &[0, 1]),
        _ => (0..2).for_each(|e| write(&data.join(format!("episode_{e:06}.parquet")), &[e])),
    }
    root
}

fn read_as(path: &Path, map: &str) -> Result<Recording, RecordingError> {
    let map = ColumnMap::parse(map, "map.toml").unwrap();
    super::super::read_by(path, Some(&map))
}

const MAP: &str = "[lerobot]\nepisode = 1\nunit = \"degrees\"\nends.gripper = [0.0, 1.0]";

#[test]
fn both_layouts_read_alike() {
    for version in ["v2.1", "v3.0"] {
        let root = set(version);
        let read = read_as(root.path(), MAP).unwrap();
        assert_eq!(read.time.len(), 20, "{version}");
        let near = |name: &str, row: usize, wanted: f64| {
            assert!((read.channel(name).unwrap()[row] - wanted).abs() < 1e-6, "{version} {name}");
        };
        near("actual_q_0", 9, 90f64.to_radians());
        near("target_q_0", 0, 1f64.to_radians());
        near("actual_q_1", 3, 0.5);
        assert!(read.provenance.notes[0].contains("so101_follower"));
    }
}

/// Found by the fuzzer.
#[test]
fn a_row_without_a_number_is_dropped_and_said() {
    let root = set("v2.1");
    let file = root.path().join("data/chunk-000/episode_000001.parquet");
    assert!(file.exists());
    write_holed(&file, &[1], Some(7));
    let read = read_as(root.path(), MAP).unwrap();
    assert_eq!((read.time.len(), read.channel("actual_q_0").unwrap().len()), (19, 19));
    assert!(read.provenance.notes.iter().any(|n| n.contains("1 row(s)") && n.contains("row 8")));
}

#[test]
fn a_file_of_an_episode_is_read_by_itself() {
    let root = set("v2.1");
    let file = root.path().join("data/chunk-000/episode_000001.parquet");
    let read = read_as(&file, "[lerobot]\nunit = \"radians\"\njoints = [\"pan\"]").unwrap();
    assert_eq!((read.joint_count("actual_q"), read.channel("actual_q_0").unwrap()[2]), (1, 20.0));
}

#[test]
fn what_cannot_be_read_is_said_in_one_line() {
    let root = set("v3.0");
    let message = |map: Option<&str>| {
        let read = match map {
            Some(map) => read_as(root.path(), map),
            None => super::super::read(root.path(), None),
        };
        let message = read.unwrap_err().to_string();
        assert_eq!(message.lines().count(), 1, "{message}");
        message
    };
    assert!(message(None).contains("unit = \"degrees\""));
    assert!(message(Some(&MAP.replace("episode = 1", "episode = 7"))).contains("no episode 7"));
    assert!(message(Some("[lerobot]\nunit = \"radians\"\njoints = [\"tilt\"]")).contains("tilt"));
    let file = root.path().join("data/chunk-000/file-000.parquet");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    assert!(message(Some(MAP)).contains("file-000.parquet"));
    std::fs::write(root.path().join(INFO), "{}").unwrap();
    assert!(message(Some(MAP)).contains("info.json"));
}
