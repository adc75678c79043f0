//! Files that are being written, by whatever writes them.

use super::*;
use crate::live::file::columns;
use crate::recording::{self, Channel, ColumnMap, Recording, WriteOptions};

#[test]
fn a_file_is_followed_while_it_grows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, "timestamp actual_q_0\n0.0 1.5\n0.008 1.6\n0.0").unwrap();
    let feed = follow(&path, None).unwrap();
    let mut rows = Vec::new();
    while rows.len() < 4 {
        match feed.next(Duration::from_secs(10)) {
            Some(News::Row(row)) => rows.push(row),
            Some(News::Columns(names)) => {
                assert_eq!(names, ["timestamp", "actual_q_0"]);
                let mut file = std::fs::OpenOptions::new().append(true).open(&path).unwrap();
                file.write_all(b"16 1.7\nbroken\n0.024 1.8\n").unwrap();
            }
            Some(News::Note(note)) => assert!(note.contains("row 5"), "{note}"),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(rows[2..], [[0.016, 1.7], [0.024, 1.8]]);
    feed.stop();
    assert!(drain(&feed).2.is_ok());
}

/// A quarter of a minute of two joints.
fn bag() -> Recording {
    let time: Vec<f64> = (0..12_000).map(|k| k as f64 / 800.0).collect();
    let channel = |name: &str, w: f64| {
        let values = time.iter().map(|t| (w * t).sin()).collect();
        Channel { name: name.into(), values }
    };
    let names = ["actual_q_0", "actual_q_1", "joint_torque_0", "joint_torque_1"];
    let channels = names.into_iter().zip(1..).map(|(name, k)| channel(name, f64::from(k)));
    Recording { channels: channels.collect(), time: time.clone(), provenance: Default::default() }
}

/// What a ROS 2 bag holds up to where its writer is, and then the rest of it; it begins as an empty file.
#[test]
fn a_bag_is_followed_while_it_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, grows] = ["whole.mcap", "grows.mcap"].map(|name| folder.path().join(name));
    recording::write(&bag(), &whole, &WriteOptions::default()).unwrap();
    let expected = recording::read(&whole, None).unwrap();
    let bytes = std::fs::read(&whole).unwrap();
    std::fs::write(&grows, b"").unwrap();
    // What effort is would else be told by gravity, once enough of it was seen.
    let map = folder.path().join("map.toml");
    std::fs::write(&map, "[bag]\neffort = \"torque\"\n").unwrap();
    let feed = follow(&grows, Some(ColumnMap::load(&map).unwrap())).unwrap();
    assert!(feed.next(Duration::from_millis(300)).is_none(), "nothing is in it, and it may come");
    let append = |part: &[u8]| {
        let mut file = std::fs::OpenOptions::new().append(true).open(&grows).unwrap();
        file.write_all(part).unwrap();
    };
    let (early, late) = bytes.split_at(bytes.len() * 3 / 4);
    append(early);
    let (mut rows, mut late) = (Vec::new(), Some(late));
    while rows.len() < expected.time.len() {
        match feed.next(Duration::from_secs(20)) {
            Some(News::Row(row)) => rows.push(row),
            Some(News::Columns(names)) => assert_eq!(names, columns(&expected)),
            other => panic!("after {} rows: {other:?}", rows.len()),
        }
        if feed.waiting() == 0
            && let Some(late) = late.take()
        {
            assert!(rows.len() < expected.time.len(), "a part of it came first");
            append(late);
        }
    }
    let times: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(times, expected.time);
    feed.stop();
    assert!(drain(&feed).2.is_ok());
}

#[test]
fn a_file_that_is_none_and_does_not_grow_is_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, b"this is no bag").unwrap();
    let wrong = drain(&follow(&path, None).unwrap()).2.unwrap_err().to_string();
    assert!(wrong.contains("run.mcap"), "{wrong}");
    let text = folder.path().join("run.csv");
    std::fs::write(&text, "time,q\n0,1\n").unwrap();
    let wrong = drain(&follow(&text, None).unwrap()).2.unwrap_err().to_string();
    assert!(wrong.contains("--columns"), "{wrong}");
}

#[test]
fn a_file_that_begins_anew_is_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, "timestamp,actual_q_0\n0.0,1.5\n0.008,1.6\n").unwrap();
    let feed = follow(&path, None).unwrap();
    while !matches!(feed.next(Duration::from_secs(20)), Some(News::Row(row)) if row[0] > 0.0) {}
    std::fs::write(&path, "timestamp,actual_q_0\n").unwrap();
    let ended = drain(&feed).2.unwrap_err().to_string();
    assert!(ended.contains("it was cut or begun anew"), "{ended}");
}
