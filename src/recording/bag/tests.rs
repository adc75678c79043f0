//! Bags of the official Python packages (tests/bags, made by the script there), our own, bad ones.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;

use std::path::{Path, PathBuf};

use super::{RosBag, effort, message};
use crate::recording::bag_map::{BagMap, Effort};
use crate::recording::format::{Format, WriteOptions};
use crate::recording::{self, write};
use crate::recording::{Channel, ColumnMap, Provenance, Recording, RecordingError};
use crate::robot::{Workspace, gravity_torque};

fn made(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bags").join(name)
}

/// Reads with the text of a column map, or without.
fn read_with(path: &Path, map: &str) -> Result<Recording, RecordingError> {
    let map = (!map.is_empty()).then(|| ColumnMap::parse(map, "map.toml").unwrap());
    RosBag.read(path, map.as_ref())
}

#[track_caller]
fn refused(result: Result<Recording, RecordingError>, parts: &[&str]) {
    let message = result.expect_err("should be refused").to_string();
    for part in parts {
        assert!(message.contains(part), "{part:?} not in: {message}");
    }
}

#[test]
fn bags_of_the_python_packages_are_read_whole() {
    let expected = recording::read(&made("expected.csv"), None).unwrap();
    let files = ["lz4.mcap", "zstd.mcap", "plain.mcap", "shuffled.mcap", "rosbags.db3"];
    let packed = ["folder_packed", "folder_packed_sqlite"];
    let folders = ["folder_mcap", "folder_sqlite", "folder_split"];
    for name in files.into_iter().chain(folders).chain(packed) {
        assert!(RosBag.reads(&made(name)), "{name}");
        let map = "[bag]\neffort = 'current'";
        let found = read_with(&made(name), map).unwrap();
        assert_eq!(found.channels, expected.channels, "{name}");
        let off = |(a, b): (&f64, &f64)| (a - b).abs();
        let largest = found.time.iter().zip(&expected.time).map(off).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{name}: {largest}");
        let notes = found.provenance.notes.join("; ");
        assert!(notes.contains("joints 1 to 6: left_shoulder_pan_joint, left_shoulder_lift"));
        assert!(notes.contains("first stamp, 1700000000.123456789 s"), "{notes}");
        assert!(notes.contains("effort taken as motor current, A, as the column map says"));
        let gripper = notes.contains("3 message(s) of other joints (left_gripper");
        assert_eq!(gripper, name.ends_with(".mcap"), "{name}: {notes}");
    }
}

#[test]
fn a_column_map_says_what_effort_and_time_are() {
    let path = made("lz4.mcap");
    let plain = read_with(&path, "[bag]\neffort = 'current'\ntime = 'log'").unwrap();
    let scaled = "[bag]\neffort = 'torque'\neffort_scale = [1, -1, 2, 1, 1, 1]";
    let scaled = read_with(&path, scaled).unwrap();
    let (i, tau) = (plain.channel("actual_current_1"), scaled.channel("joint_torque_1"));
    assert_eq!(i.unwrap()[5], -tau.unwrap()[5]);
    assert!(scaled.channel("actual_current_1").is_none());
    let three = "[bag]\njoints = ['left_elbow_joint', 'left_wrist_1_joint']\neffort = 'current'";
    let three = read_with(&path, three).unwrap();
    assert_eq!(three.joint_count("actual_q"), 2);
    assert_eq!(three.channel("actual_q_1"), plain.channel("actual_q_3"));
    for (map, parts) in [
        ("[bag]\njoints = ['elbow']", &["none of the joints", "left_elbow_joint"][..]),
        (
            "[bag]\njoints = ['left_elbow_joint', 'x']",
            &["message 1 of /joint_states: no joint \"x\""],
        ),
        ("[bag]\ntopic = '/states'", &["no joint states on topic \"/states\"", "/rosout"]),
        ("time = 1\n[channels]\nactual_q = { first = 2, count = 6 }", &["no [bag] table"]),
        ("[bag]\neffort_scale = [1, 2]", &["2 scales for 6"]),
        ("[bag]\nrobot = 'ur6'", &["ur6", "correct robot"]),
        ("[bag]\nrobot = 'ur5'\ntip = 'elbow'", &["no link `elbow` for tip", "correct robot"]),
    ] {
        refused(read_with(&path, map), parts);
    }
    for (map, part) in [
        ("[bag]\neffort = 'volt'", "unknown variant `volt`"),
        ("[bag]\njoints = ['a', 'a']", "\"a\" twice"),
        ("[bag]\njoints = []", "is empty"),
        ("[bag]\neffort_scale = 0", "scale 0"),
        ("[bag]\ntopics = 'a'", "unknown field `topics`"),
    ] {
        let message = ColumnMap::parse(map, "map.toml").unwrap_err().to_string();
        assert!(message.contains(part), "{part} not in {message}");
    }
}

/// Every kind of column: whole signals, a wrench, a single number.
fn rich() -> Recording {
    let samples = 50;
    let wave = |seed: usize| (0..samples).map(|k| ((k * seed) as f64).sin() / 3.0).collect();
    let mut channels = Vec::new();
    for (s, stem) in
        ["actual_q", "actual_current", "target_q", "actual_TCP_force"].iter().enumerate()
    {
        let named =
            (0..6).map(|j| Channel { name: format!("{stem}_{j}"), values: wave(7 * s + j) });
        channels.extend(named);
    }
    channels.push(Channel { name: "payload".into(), values: wave(3) });
    let time = (0..samples).map(|k| 0.008 * k as f64).collect();
    Recording { time, channels, provenance: Provenance::default() }
}

#[test]
fn what_is_written_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.mcap", "a.db3"] {
        let path = folder.path().join(name);
        let before = rich();
        write(&before, &path, &WriteOptions::default()).unwrap();
        let after = recording::read(&path, None).unwrap();
        for channel in &before.channels {
            assert_eq!(after.channel(&channel.name), Some(channel.values.as_slice()), "{name}");
        }
        assert_eq!(after.channels.len(), before.channels.len(), "{name}");
        let pairs = after.time.iter().zip(&before.time);
        assert!(pairs.clone().all(|(a, b)| (a - b).abs() <= 0.5e-9), "{name}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "the bag and the list");
        std::fs::remove_file(path).unwrap();
    }
    let path = folder.path().join("b.mcap");
    let mut late = rich();
    late.time.iter_mut().for_each(|t| *t -= 1.0);
    let message = write(&late, &path, &WriteOptions::default()).unwrap_err().to_string();
    assert!(message.contains("time -1 s does not fit") && !path.exists(), "{message}");
    let mut still = rich();
    still.channels.retain(|c| !c.name.starts_with("actual_q"));
    let message = write(&still, &path, &WriteOptions::default()).unwrap_err().to_string();
    assert!(message.contains("no actual_q_0") && !path.exists(), "{message}");
}

/// An MCAP file with messages on `/joint_states`.
fn mcap_of(messages: &[Vec<u8>], encoding: &str) -> Vec<u8> {
    let mut out = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    let schema = out.add_schema(message::JOINT_STATE, "ros2msg", b"").unwrap();
    let channel_id = out.add_channel(schema, "/joint_states", encoding, &BTreeMap::new()).unwrap();
    for (k, data) in messages.iter().enumerate() {
        let log_time = 1_000_000 * k as u64;
        let header =
            MessageHeader { channel_id, sequence: k as u32, log_time, publish_time: log_time };
        out.write_to_known_channel(&header, data).unwrap();
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}

fn read_bytes(name: &str, bytes: &[u8]) -> Result<Recording, RecordingError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_with(&path, "[bag]\neffort = 'current'")
}

fn names(count: usize) -> Vec<String> {
    (1..=count).map(|j| format!("joint_{j}")).collect()
}

/// `change` makes message 12 of 20 bad.
fn one_bad(change: impl Fn(&mut Vec<u8>)) -> Result<Recording, RecordingError> {
    let state = |k: i64| {
        let q = [0.1 * k as f64; 3];
        message::joint_state(1_000_000 * (k + 1), &names(3), [&q, &q, &q])
    };
    let mut messages: Vec<Vec<u8>> = (0..20).map(state).collect();
    change(&mut messages[11]);
    read_bytes("bad.mcap", &mcap_of(&messages, "cdr"))
}

#[test]
fn a_bad_message_is_named() {
    assert_eq!(one_bad(|_| {}).unwrap().time.len(), 20);
    let at = "bad.mcap: message 12 of /joint_states: ";
    refused(one_bad(|m| m.truncate(m.len() - 3)), &[at, "bytes end within effort"]);
    refused(one_bad(|m| m.truncate(30)), &[at, "30 bytes end within name"]);
    refused(one_bad(|m| m.clear()), &[at, "0 bytes end within its header"]);
    refused(one_bad(|m| m.extend([0; 16])), &[at, "bytes where its fields take"]);
    refused(one_bad(|m| m[1] = 7), &[at, "its encoding is 0x00 0x07"]);
    refused(one_bad(|m| m[20] = 0xff), &[at, "end within name"]);
    let packed = [0x28, 0xb5, 0x2f, 0xfd, 1, 2, 3];
    refused(one_bad(|m| *m = packed.to_vec()), &[at, "its compression is damaged"]);
    let state = |signals| message::joint_state(12_000_000, &names(3), signals);
    let (two, three) = (vec![1.0; 2], vec![1.0; 3]);
    let short = state([&two, &three, &three]);
    refused(one_bad(|m| m.clone_from(&short)), &[at, "position has 2 numbers for 3 names"]);
    let none = state([&three, &three, &[]]);
    refused(one_bad(|m| m.clone_from(&none)), &[at, "effort is missing; every message"]);
    let nan = state([&three, &three, &[0.0, f64::NAN, 0.0]]);
    refused(one_bad(|m| m.clone_from(&nan)), &[at, "effort of joint_2 is NaN"]);
    let late = message::joint_state(1, &names(3), [&three, &three, &three]);
    refused(one_bad(|m| m.clone_from(&late)), &["row 12, column stamp: time goes backwards"]);
    let other = message::joint_state(12_000_000, &names(4), [&[0.0; 4], &[0.0; 4], &[0.0; 4]]);
    refused(one_bad(|m| m.clone_from(&other)), &[at, "its joints are joint_1", "before"]);
    let again = message::joint_state(11_000_000, &names(3), [&three, &three, &three]);
    let repeated = one_bad(|m| m.clone_from(&again)).unwrap();
    assert!(repeated.provenance.notes.join(";").contains("1 message(s) with a stamp seen before"));
}

#[test]
fn bags_that_cannot_be_read_say_why() {
    refused(read_with(&made("two_topics.mcap"), ""), &["on 2 topics: /a/joint", "[bag] topic"]);
    refused(read_with(&made("no_joint_states.mcap"), ""), &["no topic with", "/rosout (std_msgs"]);
    refused(read_bytes("a.mcap", b""), &["the file is empty"]);
    refused(read_bytes("a.db3", b""), &["the file is empty"]);
    refused(read_bytes("a.mcap", b"timestamp,actual_q_0\n1,2\n"), &["does not begin or end as"]);
    refused(read_bytes("a.db3", &[b'x'; 5000]), &["cut off"]);
    let ros1 = mcap_of(&[vec![0; 40]], "ros1");
    refused(read_bytes("a.mcap", &ros1), &["encoded as \"ros1\"", "rosbags-convert"]);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("metadata.yaml"), "a: 1").unwrap();
    refused(read_with(folder.path(), ""), &["without .mcap or .db3 files"]);
    let strangers = message::joint_state(1, &["a".into(), "b".into()], [&[0.0; 2], &[], &[]]);
    refused(read_bytes("a.mcap", &mcap_of(&[strangers], "cdr")), &["known as an arm's: a, b"]);
    let database = folder.path().join("x.db3");
    let open = rusqlite::Connection::open(&database).unwrap();
    open.execute_batch("CREATE TABLE a(b)").unwrap();
    refused(read_with(&database, ""), &["a database, but not a bag"]);
}

/// Wherever a bag is cut off or hit by a wrong byte: a message, or what is intact; never a panic.
#[test]
fn damaged_bags_never_panic() {
    for name in ["lz4.mcap", "zstd.mcap", "rosbags.db3"] {
        let bytes = std::fs::read(made(name)).unwrap();
        let step = bytes.len() / 60;
        for cut in (1..bytes.len() - 8).step_by(step) {
            let result = read_bytes(name, &bytes[..cut]);
            let message = result.expect_err("a cut bag is refused").to_string();
            let plain = ["cut off", "damaged", "does not begin", "not a bag"];
            assert!(plain.iter().any(|p| message.contains(p)), "{name} {cut}: {message}");
        }
        for hit in (8..bytes.len()).step_by(step) {
            let mut bytes = bytes.clone();
            bytes[hit] ^= 0xa5;
            let _ = read_bytes(name, &bytes);
        }
    }
    let bytes = std::fs::read(made("lz4.mcap")).unwrap();
    refused(read_bytes("a.mcap", &bytes[..4000]), &["cut off after", "mcap recover"]);
}

/// Slow sweeps of every built-in arm, with friction: effort in N.m or in A is told apart where its
/// gravity is that of one arm only, and never told wrongly.
#[test]
fn gravity_tells_current_from_torque() {
    let arms = effort::arms(&BagMap::default(), true).unwrap().0;
    for arm in &arms {
        let samples = 2000;
        let q: Vec<Vec<f64>> = (0..6)
            .map(|j| {
                let w = 0.3 + 0.13 * j as f64;
                (0..samples).map(|k| 1.2 * (w * 0.01 * k as f64 + j as f64).sin()).collect()
            })
            .collect();
        let mut torque = vec![vec![0.0; samples]; 6];
        let mut workspace = Workspace::new(arm);
        for k in 0..samples {
            let pose: Vec<f64> = q.iter().map(|c| c[k]).collect();
            let mut g = [0.0; 6];
            gravity_torque(arm, &mut workspace, &pose, &mut g);
            let speed = |j: usize| q[j][(k + 1).min(samples - 1)] - q[j][k.saturating_sub(1)];
            (0..6).for_each(|j| torque[j][k] = g[j] + 5.0 * speed(j).signum());
        }
        let per_ampere = |column: &Vec<f64>| column.iter().map(|t| t / 12.0).collect();
        let current: Vec<Vec<f64>> = torque.iter().map(per_ampere).collect();
        let own = std::slice::from_ref(arm);
        for (effort, is) in [(&torque, Effort::Torque), (&current, Effort::Current)] {
            let told = effort::by_gravity(&q, effort, own);
            assert_eq!(told.effort, Some(is), "{}: {}", arm.name, told.why);
            let guessed = effort::by_gravity(&q, effort, &arms);
            assert!(guessed.effort.is_none_or(|e| e == is), "{}: {}", arm.name, guessed.why);
            if arm.name.starts_with("ur5") {
                assert_eq!(guessed.effort, Some(is), "{}: {}", arm.name, guessed.why);
            }
        }
        let nothing = vec![vec![1.0; samples]; 6];
        assert_eq!(effort::by_gravity(&q, &nothing, own).effort, None);
    }
}
