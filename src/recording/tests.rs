//! Every kind of dirt gets one message with file, row and column, and what to do.

use std::path::{Path, PathBuf};

use super::*;

/// A header with time and two joints, then `rows` rows.
fn csv(rows: usize) -> Vec<String> {
    let mut lines = vec!["timestamp,actual_q_0,actual_q_1".to_string()];
    lines.extend((0..rows).map(|k| format!("{},{},-1.5e-3", 0.008 * k as f64, k)));
    lines
}

fn file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// Reads lines as a file `log.csv`.
fn read_lines(lines: &[String]) -> Result<Recording, RecordingError> {
    read_text(&(lines.join("\n") + "\n"))
}

fn read_text(content: impl AsRef<[u8]>) -> Result<Recording, RecordingError> {
    let folder = tempfile::tempdir().unwrap();
    read(&file(folder.path(), "log.csv", content), None)
}

/// The message of a refusal: names the file, and holds every part of it.
#[track_caller]
fn refused(result: Result<Recording, RecordingError>, parts: &[&str]) {
    let message = result.expect_err("should be refused").to_string();
    for part in parts {
        assert!(message.contains(part), "{part:?} not in: {message}");
    }
}

fn read_mapped(content: &str, map: &str) -> Result<Recording, RecordingError> {
    let folder = tempfile::tempdir().unwrap();
    let map = file(folder.path(), "map.toml", map);
    read(&file(folder.path(), "log.csv", content), Some(&map))
}

#[test]
fn every_delimiter_line_end_and_gzip_reads_the_same() {
    let expected = read_lines(&csv(20)).unwrap();
    assert_eq!(expected.channel("actual_q_0").unwrap()[7], 7.0);
    assert_eq!(expected.time[7], 0.056);
    let text = csv(20).join("\n") + "\n";
    for (variant, delimiter) in [
        (text.replace(',', " "), "blank"),
        (text.replace(',', "\t"), "tab"),
        (text.replace(',', ", "), "comma"),
        (text.replace('\n', "\r\n"), "comma"),
        (text.replace(',', " ").replace('\n', "\r\n\r\n"), "blank"),
        (text.replace('\n', ",\n"), "comma"),
        (format!("\u{feff}{text}"), "comma"),
        (format!("\n\n# {text}\n\n"), "comma"),
    ] {
        let recording = read_text(&variant).unwrap();
        assert_eq!(recording.channels, expected.channels, "{variant:.80}");
        assert_eq!(recording.time, expected.time);
        assert_eq!(recording.provenance.format, format!("RTDE CSV, {delimiter}"));
        assert!(recording.provenance.notes.is_empty());
    }
}

#[test]
fn written_numbers_read_back_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let values = [0.0, -0.0, 0.1, 1.0 / 3.0, 1e-7, -2.5e11, f64::MIN_POSITIVE, 5e-324, 1e12, 123.0];
    let recording = Recording {
        time: (0..values.len()).map(|k| 1e9 + 0.002 * k as f64).collect(),
        channels: vec![Channel { name: "actual_q_0".into(), values: values.to_vec() }],
        provenance: Provenance::default(),
    };
    for name in ["a.csv", "a.csv.gz"] {
        let path = folder.path().join(name);
        write_csv(&recording, &path).unwrap();
        let back = read(&path, None).unwrap();
        let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back.time), bits(&recording.time));
        assert_eq!(bits(&back.channels[0].values), bits(&values));
    }
}

#[test]
fn many_chunks_keep_order_and_line_numbers() {
    let mut lines = csv(40_000);
    let recording = read_lines(&lines).unwrap();
    assert!(
        recording.channel("actual_q_0").unwrap().iter().enumerate().all(|(k, q)| *q == k as f64)
    );
    lines[39_000] = "311.992,oops,0".into();
    refused(read_lines(&lines), &["row 39001, column actual_q_0", "\"oops\" is not a number"]);
}

#[test]
fn a_cell_that_is_no_quantity_is_named() {
    for (cell, what) in [
        ("nan", "the value is NaN"),
        ("inf", "the value inf"),
        ("1e254", "the value 1e254 is beyond"),
        ("", "the cell is empty"),
        ("1.0x", "\"1.0x\" is not a number"),
    ] {
        let mut lines = csv(20);
        for (line, time) in [(10, "0.072"), (15, "0.112")] {
            lines[line] = format!("{time},{cell},0");
        }
        refused(read_lines(&lines), &["log.csv: row 11, column actual_q_0", what, "the row"]);
    }
}

#[test]
fn one_row_without_a_number_or_with_a_stamp_again_is_left_out_and_said() {
    for cell in ["nan", "", "NA", "1e254"] {
        let mut lines = csv(20);
        lines[10] = format!("0.072,{cell},0");
        let recording = read_lines(&lines).unwrap();
        assert_eq!(recording.time.len(), 19, "{cell}");
        let note = &recording.provenance.notes[0];
        assert!(
            note.contains("dropped 1 row(s), line 11") && note.contains("actual_q_0"),
            "{note}"
        );
    }
    let mut lines = csv(20);
    lines[10] = lines[9].clone();
    let recording = read_lines(&lines).unwrap();
    assert_eq!(recording.time.len(), 19);
    assert!(recording.provenance.notes[0].contains("time stamp of the row before"));
}

#[test]
fn quoted_numbers_comments_and_joints_from_1_are_read() {
    let plain = read_lines(&csv(20)).unwrap();
    let mut lines = csv(20);
    for line in &mut lines {
        *line = line.split(',').map(|c| format!("\"{c}\"")).collect::<Vec<_>>().join(",");
    }
    lines[0] = "timestamp,actual_q_1,actual_q_2".into();
    lines.insert(5, "# a remark, with a comma".into());
    lines.insert(0, "# recorded on Monday".into());
    lines.insert(1, "# by a logger".into());
    let read = read_lines(&lines).unwrap();
    assert_eq!((&read.time, &read.channels), (&plain.time, &plain.channels));
    assert!(read.provenance.notes[0].contains("counted from 1"), "{:?}", read.provenance.notes);
    let mut commented = csv(20);
    commented[0] = format!("# {}", commented[0]);
    commented.insert(0, "# numpy writes names like this".into());
    let read = read_lines(&commented).unwrap();
    assert_eq!((&read.time, &read.channels), (&plain.time, &plain.channels));
}

#[test]
fn leading_garbage_rows_are_dropped_with_a_note() {
    let mut lines = csv(20);
    lines[1] = "3e-310,1e254,0".into();
    lines[2] = "0.008,nan,0".into();
    let recording = read_lines(&lines).unwrap();
    assert_eq!(recording.time[0], 0.016);
    let note = &recording.provenance.notes[0];
    assert!(note.contains("2 leading row(s), lines 2 to 3") && note.contains("1e254"), "{note}");
}

#[test]
fn a_column_that_is_garbage_throughout_is_refused() {
    let mut lines = csv(300);
    for line in &mut lines[1..] {
        *line = line.replace("-1.5e-3", "nan");
    }
    refused(read_lines(&lines), &["row 2, column actual_q_1", "NaN"]);
}

#[test]
fn a_cut_last_line_is_dropped_with_a_note() {
    let mut lines = csv(20);
    lines.push("0.16,2".into());
    for text in [lines.join("\n"), lines.join("\n") + "\n"] {
        let recording = read_text(text).unwrap();
        assert_eq!(recording.time.len(), 20);
        assert_eq!(
            recording.provenance.notes,
            ["dropped the cut last line 22, which has too few columns"]
        );
    }
    let recording = read_text(csv(20).join("\n")).unwrap();
    assert_eq!(recording.time.len(), 19);
    assert!(recording.provenance.notes[0].contains("last line 21"));
}

#[test]
fn ragged_rows_are_named() {
    for (row, found) in [("0.072,1", 2), ("0.072,1,2,3", 4), ("0.072 1 2", 1)] {
        let mut lines = csv(20);
        lines[10] = row.into();
        let parts = format!("has {found} columns where 3 are expected");
        match found {
            1 => refused(read_lines(&lines), &["log.csv: row 11"]),
            _ => refused(read_lines(&lines), &["log.csv: row 11", &parts]),
        }
    }
}

#[test]
fn time_must_rise() {
    for (time, what) in [("0.064", "repeats"), ("0.01", "goes backwards")] {
        let mut lines = csv(20);
        lines[10] = format!("{time},1,1");
        // One alone that repeats is left out.
        lines[15] = lines[14].replace(",13,", ",1,");
        refused(read_lines(&lines), &["row 11, column timestamp", what, "0.064 s, then", "sort"]);
    }
}

#[test]
fn a_header_that_does_not_name_every_joint_once_is_refused() {
    let with_header = |header: &str| {
        let mut lines = csv(20);
        lines[0] = header.into();
        read_lines(&lines)
    };
    refused(with_header("t,actual_q_0,actual_q_1"), &["no column timestamp", "t, actual_q_0"]);
    refused(
        with_header("timestamp,actual_q_0,actual_q_0"),
        &["row 1", "\"actual_q_0\" stands in columns 2 and 3", "rename"],
    );
    refused(with_header("timestamp,actual_q_0,actual_q_2"), &["no column actual_q_1", "one joint"]);
    refused(with_header("timestamp,actual_q_1,actual_current_0"), &["no column actual_q_0"]);
    refused(with_header("timestamp,actual_q_2,actual_q_3"), &["no column actual_q_0"]);
    let (header, row) = ("timestamp,actual_q_0,actual_q_1,actual_current_0", "1,1,1,1");
    let text = format!("{header}\n{row}\n").replace(row, &rows(12, 4));
    refused(
        read_text(text),
        &["actual_current has 1 joints but actual_q has 2", "no column actual_current_1"],
    );
}

fn rows(count: usize, columns: usize) -> String {
    let row = |k: usize| vec![k.to_string(); columns].join(",");
    (0..count).map(row).collect::<Vec<_>>().join("\n")
}

#[test]
fn files_that_are_no_csv_say_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let (path, at) = (folder.path(), |name: &str| folder.path().join(name));
    refused(read(&at("none.csv"), None), &["none.csv: no such file"]);
    refused(read(path, None), &["a folder without log_q_actual.csv"]);
    refused(read_text(""), &["log.csv: the file is empty"]);
    refused(read_text("\n  \n"), &["the file is empty"]);
    refused(read_text([0xff, 0xfe, 116, 0, 105, 0]), &["not UTF-8 text (it is UTF-16)"]);
    refused(read_text(b"timestamp,\xe4\n"), &["not UTF-8 text"]);
    refused(read_text("PK\u{3}\u{4}\0\0"), &["it is binary"]);
    refused(
        read_text(csv(20).join("\n").replace(',', ";")),
        &["row 1 holds one column", "timestamp;"],
    );
    refused(read_text(csv(20)[1..].join("\n")), &["row 1 holds 3 numbers", "--columns"]);
    refused(read_lines(&csv(5)), &["5 samples, at least 10"]);
    refused(read_lines(&csv(0)), &["0 samples, at least 10"]);
    let gz = at("log.csv.gz");
    write_csv(&read_lines(&csv(20)).unwrap(), &gz).unwrap();
    let mut bytes = std::fs::read(&gz).unwrap();
    bytes.truncate(bytes.len() / 2);
    refused(
        read(&file(path, "half.csv.gz", &bytes), None),
        &["half.csv.gz: the gzip data are damaged"],
    );
    refused(read(&file(path, "text.csv.gz", "timestamp,a\n"), None), &["gzip data are damaged"]);
}

#[test]
fn a_column_map_reads_headerless_and_foreign_files() {
    let map = "time = 1\ntime_scale = 0.001\ndelimiter = 'semicolon'\ndecimal = ','\nskip_rows = 1\n\
               [channels]\nactual_q = { columns = [3, 2], scale = [2, -1] }\n";
    let body: String = (0..12).map(|k| format!("{};1,5;2,25;text\n", 8 * k)).collect();
    let recording = read_mapped(&format!("made by hand\n{body}"), map).unwrap();
    assert_eq!(recording.channel("actual_q_0").unwrap()[3], 4.5);
    assert_eq!(recording.channel("actual_q_1").unwrap()[3], -1.5);
    assert_eq!(recording.time[3], 0.024);
    let named = "time = 't'\n[channels]\nactual_q = { columns = ['b'] }\n";
    let recording = read_mapped(&format!("t,name,b\n{}\n", rows(12, 3)), named).unwrap();
    assert_eq!(recording.channel("actual_q_0").unwrap()[5], 5.0);
    refused(
        read_mapped(&format!("t,b,b\n{}\n", rows(12, 3)), named),
        &["\"b\" stands in columns 2 and 3"],
    );
    refused(
        read_mapped(&rows(12, 3), named),
        &["no column \"t\" (named in", "correct the column map"],
    );
}

#[test]
fn a_column_map_with_a_mistake_is_refused() {
    for (map, part) in [
        (
            "time = 1\nspeed = 2\n[channels]\nactual_q = { first = 2, count = 1 }",
            "unknown field `speed`",
        ),
        ("time = 1\n[channels]\nactual_q = { first = 2, cuont = 1 }", "unknown field `cuont`"),
        ("time = 1\n[channels]\nactual_q = { first = 2 }", "channels.actual_q: give either"),
        ("time = 1\n[channels]\nactual_q = { first = 0, count = 1 }", "columns count from 1"),
        ("time = 1\n[channels]\nactual_q = { first = 2, count = 1, scale = 0 }", "scale 0"),
        (
            "time = 1\n[channels]\nactual_q = { first = 2, count = 2, scale = [1] }",
            "1 scales for 2",
        ),
        (
            "time = 1\ntime_scale = -1\n[channels]\nactual_q = { first = 2, count = 1 }",
            "time_scale is -1",
        ),
        ("time = 1\n[channels]\n", "[channels] is empty"),
        ("[channels]\nactual_q = { first = 2, count = 1 }", "missing field `time`"),
        ("time = 1\n[channels]\nactual_q = { first = 9, count = 1 }", "no column 9 (named in"),
        (
            "time = 1\nfile_columns = 9\n[channels]\nactual_q = { first = 2, count = 1 }",
            "where 9 are",
        ),
        ("time = [", "map.toml"),
    ] {
        refused(read_mapped(&(rows(12, 3) + "\n"), map), &[part]);
    }
}

#[test]
fn a_movement_folder_ends_with_its_shortest_log() {
    let folder = tempfile::tempdir().unwrap();
    let log = |name: &str, rows: usize, shift: f64, end: &str| {
        let row = |k: usize| format!("{:.6}, {k}, {}\n", 0.008 * k as f64 + shift, 2 * k);
        let text: String = (0..rows).map(row).collect();
        file(folder.path(), name, text + end);
    };
    log("log_q_actual.csv", 40, 0.0, "0.32, 4");
    log("log_i_actual.csv", 30, 1e-5, "");
    log("log_force_sensor.csv", 90, 0.003, "");
    let recording = read(folder.path(), None).unwrap();
    assert_eq!(recording.time.len(), 30);
    assert_eq!(recording.channel("actual_current_1").unwrap()[29], 58.0);
    let notes = recording.provenance.notes.join("; ");
    for part in [
        "log_q_actual.csv: dropped the cut last line 41",
        "by up to 10 us",
        "30 of 40",
        "log_force_sensor",
    ] {
        assert!(notes.contains(part), "{part} not in {notes}");
    }
    log("log_i_actual.csv", 40, 0.004, "");
    let recording = read(folder.path(), None).unwrap();
    assert_eq!(recording.time[0], 0.008);
    assert!((recording.channel("actual_current_0").unwrap()[0] - 0.5).abs() < 1e-9);
    assert!(recording.provenance.notes.join(";").contains("interpolated linearly"));
    log("log_m_target.csv", 40, 0.0, "0.1, 1, 1\n");
    refused(read(folder.path(), None), &["log_m_target.csv: row 41, column 1", "goes backwards"]);
}

#[test]
fn required_joints_name_the_missing_column() {
    let recording = read_lines(&csv(20)).unwrap();
    assert_eq!(recording.require_joints("actual_q", 2).unwrap().joints(), 2);
    for (stem, dof, part) in [
        ("actual_q", 6, "no column actual_q_2"),
        ("actual_current", 2, "no column actual_current_0"),
        ("actual_q", 1, "actual_q has 2 joints"),
    ] {
        let message = recording.require_joints(stem, dof).unwrap_err().to_string();
        assert!(message.contains("log.csv") && message.contains(part), "{message}");
    }
}

#[test]
fn an_unknown_extension_is_refused_before_work() {
    let message = writer(Path::new("a.xlsx")).err().unwrap().to_string();
    assert!(message.contains("a.xlsx") && message.contains(".parquet, .csv, .csv.gz"), "{message}");
}

#[test]
fn parquet_keeps_every_bit_and_the_source() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.parquet");
    let before = read_lines(&csv(40)).unwrap();
    write(&before, &path, &WriteOptions::default()).unwrap();
    let after = read(&path, None).unwrap();
    assert_eq!((&after.time, &after.channels), (&before.time, &before.channels));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "the file and the list");
    let map = "time = 'timestamp'\ntime_scale = 0.5\n[channels]\n\
               actual_q = { columns = ['actual_q_1', 2], scale = -2 }\n";
    let map = file(folder.path(), "map.toml", map);
    let mapped = read(&path, Some(&map)).unwrap();
    assert_eq!(mapped.channel("actual_q_0").unwrap()[3], 3e-3);
    assert_eq!(mapped.channel("actual_q_1").unwrap()[3], -6.0);
    assert_eq!(mapped.time[5], 0.02);
    let unknown = "time = 'when'\n[channels]\nactual_q = { first = 2, count = 1 }\n";
    let unknown = file(folder.path(), "unknown.toml", unknown);
    refused(
        read(&path, Some(&unknown)),
        &["no column \"when\" (named in", "timestamp, actual_q_0"],
    );
}

#[test]
fn parquet_of_other_programs_is_read() {
    let bags = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bags");
    let expected = read(&bags.join("expected.csv"), None).unwrap();
    let found = read(&bags.join("pyarrow.parquet"), None).unwrap();
    assert_eq!(found.channels[..18], expected.channels[..]);
    let off = found.time.iter().zip(&expected.time).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-9);
    assert_eq!(found.channel("joint_temperatures_0").unwrap()[7], 37.0);
    assert_eq!(found.channel("joint_temperatures_5").unwrap()[7], 25.5);
    assert_eq!(found.provenance.notes, ["left out columns that hold no numbers: note"]);
}

#[test]
fn damaged_parquet_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let whole = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bags/pyarrow.parquet");
    let bytes = std::fs::read(whole).unwrap();
    let at = |bytes: &[u8]| read(&file(folder.path(), "a.parquet", bytes), None);
    refused(at(b""), &["the file is empty"]);
    refused(at(b"timestamp,a\n"), &["not a Parquet file", "copy it again"]);
    for cut in (1..bytes.len()).step_by(bytes.len() / 40) {
        refused(at(&bytes[..cut]), &["a.parquet", "not a Parquet file"]);
    }
    // Some damage is not to be seen, none panics.
    for byte in (0..bytes.len()).rev().take(4000).step_by(5) {
        let mut broken = bytes.clone();
        broken[byte] ^= 0x15;
        if let Err(error) = at(&broken) {
            assert!(error.to_string().contains("a.parquet"), "byte {byte}: {error}");
        }
    }
}

/// Recordings of every size and shape, with numbers of every size, through every format: the same
/// bits come back, the time of bags within half a nanosecond.
#[test]
fn whatever_is_written_comes_back() {
    use rand::{RngExt, SeedableRng};
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let folder = tempfile::tempdir().unwrap();
    let singles = ["payload", "speed_scaling"];
    for _ in 0..30 {
        let (samples, joints) = (random.random_range(10..80), random.random_range(1..8));
        let step: f64 = random.random_range(1e-4..0.2);
        let stems: Vec<&str> =
            JOINT_SIGNALS[1..].iter().copied().filter(|_| random.random_bool(0.5)).collect();
        let mut names: Vec<String> = std::iter::once("actual_q")
            .chain(stems)
            .flat_map(|stem| (0..joints).map(move |j| format!("{stem}_{j}")))
            .collect();
        names.extend(singles.iter().filter(|_| random.random_bool(0.5)).map(|s| (*s).to_string()));
        let mut value = || {
            let size: f64 = random.random_range(-30.0..11.0);
            random.random_range(-1.0..1.0) * 10f64.powf(size)
        };
        let channels = names
            .into_iter()
            .map(|name| Channel { name, values: (0..samples).map(|_| value()).collect() });
        let before = Recording {
            channels: channels.collect(),
            time: (0..samples).map(|k| step * k as f64).collect(),
            provenance: Provenance::default(),
        };
        for name in ["a.csv", "a.csv.gz", "a.parquet", "a.mcap", "a.db3"] {
            let path = folder.path().join(name);
            write(&before, &path, &WriteOptions::default()).unwrap();
            let after = read(&path, None).unwrap();
            assert_eq!(after.channels.len(), before.channels.len(), "{name}");
            for channel in &before.channels {
                let back = after.channel(&channel.name).unwrap();
                assert!(back.iter().zip(&channel.values).all(|(a, b)| a.to_bits() == b.to_bits()));
            }
            let late = after.time.iter().zip(&before.time).map(|(a, b)| (a - b).abs());
            let tolerance = if name.ends_with("3") || name.contains("mcap") { 0.5e-9 } else { 0.0 };
            assert!(late.fold(0.0, f64::max) <= tolerance, "{name}");
        }
    }
}
