//! Files that say more than they hold, or hold more than they look like. Each was a hang, gigabytes of
//! memory or a dead process once; what the fuzzer (`examples/fuzz`) finds is added here.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, RecordBatch};
use arrow::datatypes::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;

use super::{Recording, RecordingError, read};

fn bag(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bags").join(name);
    std::fs::read(path).unwrap()
}

fn read_bytes(name: &str, bytes: &[u8]) -> Result<Recording, RecordingError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read(&path, None)
}

/// The message of a refusal: one line that names the file and holds every part.
#[track_caller]
fn refused(result: Result<Recording, RecordingError>, parts: &[&str]) {
    let message = result.expect_err("should be refused").to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} not in: {message}");
    }
}

/// The size that a chunk is said to have once unpacked.
#[test]
fn a_flipped_bit_in_the_size_of_a_chunk_hangs_nothing() {
    for name in ["zstd.mcap", "lz4.mcap"] {
        for byte in 95..=102 {
            let mut bytes = bag(name);
            bytes[byte] ^= 0x40;
            match byte {
                95 if bytes[95] < 0x40 => {
                    // Less than it holds: the checksum tells.
                    refused(read_bytes(name, &bytes), &[name, "the checksum of a chunk is wrong"]);
                }
                95..=97 => {
                    refused(read_bytes(name, &bytes), &[name, "a chunk of", "bytes holds 2375"])
                }
                _ => {
                    refused(read_bytes(name, &bytes), &["more than 268 435 456 bytes in a record"])
                }
            }
        }
    }
}

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

fn record(opcode: u8, length: u64, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &length.to_le_bytes(), body].concat()
}

/// A chunk of `size` zeros.
fn chunk_of_zeros(size: u64) -> Vec<u8> {
    let packed = zstd::encode_all(std::io::Read::take(std::io::repeat(0), size), 1).unwrap();
    let mut body = vec![0; 16];
    body.extend(size.to_le_bytes());
    body.extend([0; 4]);
    body.extend(4u32.to_le_bytes());
    body.extend(b"zstd");
    body.extend((packed.len() as u64).to_le_bytes());
    body.extend(packed);
    record(6, body.len() as u64, &body)
}

#[test]
fn lengths_in_a_bag_reserve_nothing() {
    // A header, an attachment and a chunk that are not there.
    for (opcode, what) in [(1, "cut off"), (9, "cut off"), (6, "cut off"), (5, "cut off")] {
        let bytes = [MAGIC, &record(opcode, 200 << 20, b"short")].concat();
        refused(read_bytes("a.mcap", &bytes), &["a.mcap", what]);
        let endless = [MAGIC, &record(opcode, u64::MAX, b"short")].concat();
        let limit =
            "more than 268 435 456 bytes in a record or chunk of a bag; write the bag again";
        let what = if opcode == 5 || opcode == 6 { limit } else { what };
        refused(read_bytes("a.mcap", &endless), &["a.mcap", what]);
    }
}

#[test]
fn a_small_bag_that_becomes_large_is_refused() {
    let one = [MAGIC, &chunk_of_zeros(200 << 20)].concat();
    assert!(one.len() < 40_000, "{}", one.len());
    refused(read_bytes("a.mcap", &one), &["more than 1 000 times its own size once unpacked"]);
    // Zeros are records of no kind and no length, nine bytes each.
    let chunk = chunk_of_zeros(9 << 21);
    let many = [MAGIC, &chunk.repeat(20)].concat();
    refused(read_bytes("a.mcap", &many), &["more than 1 000 times its own size once unpacked"]);
}

/// Rosbag2 packs messages one by one, too.
#[test]
fn a_message_that_becomes_large_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db3");
    std::fs::write(&path, bag("rosbags.db3")).unwrap();
    let database = rusqlite::Connection::open(&path).unwrap();
    let packed = zstd::encode_all(std::io::Read::take(std::io::repeat(0), 32 << 20), 1).unwrap();
    database.execute("UPDATE messages SET data = ?1", [packed]).unwrap();
    drop(database);
    refused(read(&path, None), &["message 1 of", "more than 1 048 576 bytes in a message"]);
}

fn changed_database(sql: &str) -> Result<Recording, RecordingError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db3");
    std::fs::write(&path, bag("rosbags.db3")).unwrap();
    rusqlite::Connection::open(&path).unwrap().execute_batch(sql).unwrap();
    read(&path, None)
}

#[test]
fn rows_that_are_made_up_are_refused() {
    let endless = |table: &str, columns: &str| {
        format!(
            "ALTER TABLE {table} RENAME TO t; CREATE VIEW {table} AS WITH RECURSIVE r(n) AS (SELECT 1 \
             UNION ALL SELECT n + 1 FROM r) SELECT n AS id, {columns} FROM r, t"
        )
    };
    let messages = changed_database(&endless("messages", "topic_id, n AS timestamp, data"));
    refused(messages, &["a.db3: messages is a view, no table", "plain bag"]);
    let topics = changed_database(&endless("topics", "name, type, serialization_format"));
    refused(topics, &["topics is a view, no table"]);
    let computed = "ALTER TABLE messages RENAME TO t; CREATE TABLE messages(id INTEGER PRIMARY KEY, \
                    topic_id, timestamp, data AS (zeroblob(200000000)))";
    refused(changed_database(computed), &["column data of messages is computed"]);
}

/// Every inner page of a tree points to the same next one: rows without number from a few pages.
#[test]
fn a_tree_that_leads_in_circles_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db3");
    let database = rusqlite::Connection::open(&path).unwrap();
    database
        .execute_batch(
            "PRAGMA page_size = 512;
             CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format);
             CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data);
             INSERT INTO topics VALUES (1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr');
             WITH RECURSIVE r(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM r WHERE n < 20000)
             INSERT INTO messages SELECT n, 7, n, x'00' FROM r;",
        )
        .unwrap();
    drop(database);
    let mut bytes = std::fs::read(&path).unwrap();
    let pages = bytes.len() / 512;
    // Inner pages of tables begin with 5; all their cells point to the first child.
    for page in 1..pages {
        let at = page * 512;
        if bytes[at] != 5 {
            continue;
        }
        let cells = usize::from(u16::from_be_bytes([bytes[at + 3], bytes[at + 4]]));
        let place = |k: usize| {
            usize::from(u16::from_be_bytes([bytes[at + 12 + 2 * k], bytes[at + 13 + 2 * k]]))
        };
        let places: Vec<usize> = (0..cells).map(place).collect();
        let child = bytes[at + places[0]..at + places[0] + 4].to_vec();
        for place in places {
            bytes[at + place..at + place + 4].copy_from_slice(&child);
        }
    }
    std::fs::write(&path, bytes).unwrap();
    assert!(read(&path, None).is_err());
}

fn gzip(lines: &str, times: usize) -> Vec<u8> {
    let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let block = lines.repeat(1000);
    (0..times / 1000).for_each(|_| out.write_all(block.as_bytes()).unwrap());
    out.finish().unwrap()
}

#[test]
fn text_without_end_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (path, map) = (folder.path().join("a.csv.gz"), folder.path().join("map.toml"));
    let rows = gzip("1,2\n", 6_000_000);
    assert!(rows.len() < 150_000, "{}", rows.len());
    std::fs::write(&path, rows).unwrap();
    std::fs::write(&map, "time = 1\n[channels]\nactual_q = { first = 2, count = 1 }").unwrap();
    refused(read(&path, Some(&map)), &["more than 5 000 000 rows in a recording; cut it"]);
    refused(read_bytes("a.csv.gz", &gzip("\n", 50_000_000)), &["the file is empty"]);
    let line = "1,".repeat(3 << 20);
    refused(read_bytes("a.csv", line.as_bytes()), &["more than 4 194 304 bytes in a line of text"]);
    let wide = "a,".repeat(3_000) + "\n";
    refused(read_bytes("a.csv", wide.as_bytes()), &["more than 2 000 columns in a recording"]);
}

/// Every number of a column is the same: 100 000 of them take some ten bytes.
fn constant_parquet(rows: usize, columns: usize) -> Vec<u8> {
    let names = (0..columns).map(|c| match c {
        0 => "timestamp".to_string(),
        c => format!("actual_q_{}", c - 1),
    });
    let fields: Vec<_> = names.map(|n| Field::new(n, DataType::Float64, false)).collect();
    let schema = Arc::new(Schema::new(fields));
    let column: ArrayRef = Arc::new(Float64Array::from(vec![1.0; rows.min(100_000)]));
    let batch = RecordBatch::try_new(schema.clone(), vec![column; columns]).unwrap();
    let mut bytes = Vec::new();
    let mut out = ArrowWriter::try_new(&mut bytes, schema, None).unwrap();
    (0..rows.div_ceil(100_000)).for_each(|_| out.write(&batch).unwrap());
    out.close().unwrap();
    bytes
}

#[test]
fn columns_that_pack_to_nothing_are_refused() {
    let rows = constant_parquet(5_100_000, 1);
    refused(read_bytes("a.parquet", &rows), &["a.parquet", "more than 5 000 000 rows"]);
    let small = constant_parquet(1_000_000, 12);
    assert!(small.len() < 64_000, "{}", small.len());
    refused(read_bytes("a.parquet", &small), &["more than 1 000 times its own size once unpacked"]);
    // As it is well within the limits, only its time is refused.
    refused(read_bytes("a.parquet", &constant_parquet(100_000, 12)), &["time repeats"]);
}

/// Lists, dictionaries and pages that are announced only.
#[test]
fn lengths_in_a_parquet_file_reserve_nothing() {
    let sound = bag("pyarrow.parquet");
    let end = sound.len() - 8;
    let footer = end - u32::from_le_bytes(sound[end..end + 4].try_into().unwrap()) as usize;
    // The schema: field 2, a list. Its length becomes 2^31 - 1.
    let at = footer + sound[footer..end].iter().position(|b| *b == 0x19).unwrap();
    let mut long = sound[..at + 1].to_vec();
    long.extend([0xfc, 0xff, 0xff, 0xff, 0xff, 0x07]);
    long.extend(&sound[at + 2..end]);
    let length = (long.len() - footer) as u32;
    long.extend(length.to_le_bytes());
    long.extend(b"PAR1");
    refused(read_bytes("a.parquet", &long), &["not a Parquet file", "2147483647 elements in"]);
    let mut other = sound.clone();
    other[at] = 0x18;
    refused(read_bytes("a.parquet", &other), &["its metadata are damaged"]);
}

/// A group that says it has 2^30 children made the decoder ask for 16 GB.
#[test]
fn children_of_a_schema_that_do_not_follow_reserve_nothing() {
    let mut footer = vec![0x15, 2, 0x19, 0x1c];
    // Name "a", and 2^30 in zigzag.
    footer.extend([0x48, 1, b'a', 0x15, 0x80, 0x80, 0x80, 0x80, 0x08, 0]);
    footer.extend([0x16, 0, 0x19, 0x0c, 0]);
    let mut file = b"PAR1".to_vec();
    file.extend(&footer);
    file.extend((footer.len() as u32).to_le_bytes());
    file.extend(b"PAR1");
    let missing = "1073741824 columns of its schema do not follow";
    refused(read_bytes("a.parquet", &file), &["not a Parquet file", missing]);
}

/// A schema of groups in groups made the decoder call itself until the stack ended.
#[test]
fn groups_in_groups_end() {
    let mut footer = vec![0x15, 2, 0x19, 0xfc];
    let mut count = 50_001u32;
    while count >= 0x80 {
        footer.push(count as u8 | 0x80);
        count >>= 7;
    }
    footer.push(count as u8);
    // Name "a" and one child each; the last one has none.
    (0..50_000).for_each(|_| footer.extend([0x48, 1, b'a', 0x15, 2, 0]));
    footer.extend([0x15, 10, 0x38, 1, b'a', 0]);
    footer.extend([0x16, 0, 0x19, 0x0c, 0]);
    let length = footer.len() as u32;
    let bytes = [b"PAR1", &footer[..], &length.to_le_bytes(), b"PAR1"].concat();
    refused(read_bytes("a.parquet", &bytes), &["more than"]);
}

#[test]
fn messages_of_too_many_joints_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<String> = (0..300).map(|j| format!("joint_{}", j + 1)).collect();
    let recording = Recording {
        time: (0..12).map(f64::from).collect(),
        channels: names
            .iter()
            .enumerate()
            .map(|(j, _)| super::Channel { name: format!("actual_q_{j}"), values: vec![0.0; 12] })
            .collect(),
        provenance: super::Provenance::default(),
    };
    let path: PathBuf = folder.path().join("a.mcap");
    super::write(&recording, &path, &super::WriteOptions::default()).unwrap();
    refused(
        read(&path, None),
        &["message 1 of /joint_states", "more than 256 joints in a message"],
    );
}

/// Logs of different stretches of time, and one of a single row.
#[test]
fn logs_that_do_not_overlap_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let log = |name: &str, from: usize, rows: usize| {
        let row = |k: usize| format!("{}, {k}, {k}\n", 0.01 * (from + k) as f64 + 0.003);
        std::fs::write(folder.path().join(name), (0..rows).map(row).collect::<String>()).unwrap();
    };
    log("log_q_actual.csv", 0, 40);
    log("log_i_actual.csv", 30, 40);
    log("log_m_target.csv", 0, 20);
    std::fs::write(folder.path().join("log_qd_actual.csv"), "0.1, 1, 1\n0.2, 1, 1\n0.3, 1, 1\n")
        .unwrap();
    refused(read(folder.path(), None), &["0 samples, at least 10 are needed"]);
    std::fs::write(folder.path().join("log_qd_actual.csv"), "0.103, 1, 1\n").unwrap();
    refused(read(folder.path(), None), &["log_qd_actual.csv: 1 samples"]);
}
