//! `armtwin inspect`, `armtwin convert`, and what they do with dirty input.

use std::path::{Path, PathBuf};

use crate::{Output, armtwin};

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A six-joint recording: joint 1 swings, the others stand.
fn csv(rows: usize) -> String {
    let mut text = String::from("timestamp");
    for signal in ["actual_q", "actual_qd", "actual_current"] {
        (0..6).for_each(|j| text += &format!(",{signal}_{j}"));
    }
    for k in 0..rows {
        let t = 0.008 * k as f64;
        let (q, qd, i) = (t.sin(), t.cos(), 0.5 * t.cos().signum() + 1e-3 * (k % 7) as f64);
        text += &format!("\n{t:.3},{q},0,0,0,0,0,{qd},0,0,0,0,0,{i},1,1,.5,0.1,{}", 1.0 / 3.0);
    }
    text + "\n"
}

fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn files(folder: &Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}

#[test]
fn conversion_there_and_back_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let original = write(folder.path(), "a.csv", csv(50));
    let [packed, blank, tab, back] =
        ["b.csv.gz", "c.csv", "d.csv", "e.csv"].map(|n| folder.path().join(n));
    for (from, to, delimiter) in [
        (&original, &packed, "comma"),
        (&packed, &blank, "blank"),
        (&blank, &tab, "tab"),
        (&tab, &back, "comma"),
    ] {
        let out = armtwin(&["convert", text(from), "-o", text(to), "--delimiter", delimiter]);
        assert_eq!((out.code, out.stderr.as_str()), (0, ""), "{delimiter}");
        assert!(out.stdout.contains("50 samples, 19 columns"), "{}", out.stdout);
    }
    let first =
        |path: &Path| std::fs::read_to_string(path).unwrap().lines().next().unwrap().to_owned();
    assert!(first(&blank).starts_with("timestamp actual_q_0 ") && first(&tab).contains('\t'));
    let numbers = |path: &Path| -> Vec<f64> {
        let text = std::fs::read_to_string(path).unwrap();
        let cells = text.split([',', '\n']).filter(|c| !c.is_empty());
        cells.filter_map(|c| c.parse().ok()).collect()
    };
    assert_eq!(numbers(&original), numbers(&back));
    assert_eq!(numbers(&back).len(), 50 * 19);
}

#[test]
fn inspect_says_what_is_there_and_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let recording = write(folder.path(), "a.csv", csv(2000) + "16,0.1");
    let json = folder.path().join("a.json");
    let out = armtwin(&["inspect", text(&recording), "--json", text(&json)]);
    assert_eq!(out.code, 0, "{}", out.stderr);
    for part in [
        "2000 samples, 15.992 s",
        "125.0 Hz on average",
        "actual_current",
        "dropped the cut last line 2002",
        "joints 2, 3, 4, 5, 6: no motion",
    ] {
        assert!(out.stdout.contains(part), "{part} not in\n{}", out.stdout);
    }
    assert!(out.stdout.lines().all(|l| l.chars().count() <= 100), "{}", out.stdout);
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!(json["schema"], "armtwin.inspection/1");
    assert_eq!(json["samples"], 2000);
    assert_eq!(json["motion"][0]["reversals"], 5);
    assert_eq!(json["version"], env!("CARGO_PKG_VERSION"));
}

#[test]
fn a_column_map_reads_a_headerless_log() {
    let folder = tempfile::tempdir().unwrap();
    let body = csv(50).split_once('\n').unwrap().1.to_string();
    let log = write(folder.path(), "log.txt", body);
    let map = write(
        folder.path(),
        "map.toml",
        "time = 1\n[channels]\nactual_q = { first = 2, count = 6 }\n",
    );
    let out = armtwin(&["inspect", text(&log), "--columns", text(&map)]);
    assert_eq!(out.code, 0, "{}", out.stderr);
    assert!(
        out.stdout.contains("50 samples") && out.stdout.contains("no actual_qd"),
        "{}",
        out.stdout
    );
}

/// One line on standard error, exit code 1, no file more than before.
#[track_caller]
fn refused(folder: &Path, recording: &Path, extra: &[&str], parts: &[&str]) {
    let before = files(folder);
    let (json, converted) = (folder.join("out.json"), folder.join("out.csv"));
    let inspect = ["inspect", text(recording), "--json", text(&json)];
    let convert = ["convert", text(recording), "-o", text(&converted)];
    for arguments in [inspect, convert] {
        let Output { code, stdout, stderr } = armtwin(&[&arguments[..], extra].concat());
        assert_eq!((code, stdout.as_str()), (1, ""), "{stderr}");
        assert!(stderr.starts_with("error: ") && !stderr.contains("panicked"), "{stderr}");
        for part in parts {
            assert!(stderr.contains(part), "{part:?} not in: {stderr}");
        }
    }
    assert_eq!(files(folder), before, "something was written");
}

/// A good recording with its line `line` (from 1) replaced.
fn spoilt(line: usize, with: &str) -> String {
    let good = csv(50);
    let mut lines: Vec<&str> = good.lines().collect();
    lines[line - 1] = with;
    lines.join("\n") + "\n"
}

#[test]
fn dirty_recordings_are_refused_with_one_clear_message() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let good = csv(50);
    let lines: Vec<&str> = good.lines().collect();
    let row = |time: &str, q: &str| {
        lines[20].replacen("0.152", time, 1).replacen(lines[20].split(',').nth(1).unwrap(), q, 1)
    };
    let header = lines[0];
    let cases: Vec<(&str, Vec<u8>, &[&str])> = vec![
        ("empty.csv", vec![], &["the file is empty"]),
        ("semicolon.csv", good.replace(',', ";").into(), &["row 1 holds one column", "--columns"]),
        (
            "word.csv",
            spoilt(21, &row("0.152", "off")).into(),
            &["row 21, column actual_q_0", "\"off\""],
        ),
        (
            "back.csv",
            spoilt(21, &row("0.01", "0")).into(),
            &["row 21, column timestamp: time goes back"],
        ),
        ("ragged.csv", spoilt(21, "0.152,1,2").into(), &["row 21 has 3 columns where 19"]),
        ("short.csv", csv(5).into(), &["5 samples, at least 10"]),
        (
            "names.csv",
            spoilt(1, &header.replace("timestamp", "zeit")).into(),
            &["no column timestamp"],
        ),
        (
            "joint.csv",
            spoilt(1, &header.replace("actual_q_3", "other")).into(),
            &["no column actual_q_3", "one joint is missing"],
        ),
        (
            "current.csv",
            spoilt(1, &header.replace("actual_current_5", "other")).into(),
            &["actual_current has 5 joints but actual_q has 6", "actual_current_5"],
        ),
        (
            "double.csv",
            spoilt(1, &header.replace("actual_q_3", "actual_q_2")).into(),
            &["\"actual_q_2\" stands in columns 4 and 5"],
        ),
        ("latin.csv", b"timestamp,\xe4\n0,1\n".to_vec(), &["not UTF-8"]),
        ("packed.csv.gz", vec![0x1f, 0x8b, 8, 0, 1, 2, 3], &["gzip data are damaged"]),
        ("headerless.csv", lines[1..].join("\n").into(), &["row 1 holds 19 numbers", "--columns"]),
    ];
    for (name, content, parts) in cases {
        let path = write(folder, name, content);
        refused(folder, &path, &[], &[&[name], parts].concat());
    }
    refused(folder, &folder.join("none.csv"), &[], &["none.csv: no such file"]);
    refused(folder, folder, &[], &["a folder without log_q_actual.csv"]);
}

#[test]
fn a_bad_column_map_or_output_name_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let log = write(folder, "log.csv", csv(50));
    let map = write(folder, "map.toml", "time = 1\ntyme = 2\n[channels]\n");
    refused(folder, &log, &["--columns", text(&map)], &["map.toml", "tyme"]);
    let none = folder.join("none.toml");
    refused(folder, &log, &["--columns", text(&none)], &["none.toml: no such file"]);
    for (name, part) in
        [("out.xlsx", ".parquet, .csv, .csv.gz"), ("log.csv", "this command reads it")]
    {
        let out = armtwin(&["convert", text(&log), "-o", text(&folder.join(name))]);
        assert_eq!(out.code, 1);
        assert!(out.stderr.contains(name) && out.stderr.contains(part), "{}", out.stderr);
    }
    assert_eq!(files(folder), 2);
    assert_eq!(std::fs::read_to_string(&log).unwrap(), csv(50));
    assert_eq!(armtwin(&["inspect"]).code, 2);
    assert_eq!(armtwin(&["convert", text(&log), "-o", "x.csv", "--delimiter", "pipe"]).code, 2);
}

#[test]
fn bags_and_parquet_hold_all_a_csv_does() {
    let folder = tempfile::tempdir().unwrap();
    let original = write(folder.path(), "a.csv", csv(50));
    let files = ["b.mcap", "c.db3", "d.parquet", "e.csv"].map(|n| folder.path().join(n));
    let mut from = original.clone();
    for to in &files {
        let out = armtwin(&["convert", text(&from), "-o", text(to)]);
        assert_eq!(out.code, 0, "{}", out.stderr);
        assert!(out.stdout.contains("50 samples, 19 columns"), "{}", out.stdout);
        from.clone_from(to);
    }
    // Columns may come in another order and numbers be written otherwise.
    let cells = |path: &Path| -> (Vec<String>, Vec<f64>) {
        let all = std::fs::read_to_string(path).unwrap();
        let cells = || all.split([',', '\n']).filter(|cell| !cell.is_empty());
        let mut numbers: Vec<f64> = cells().filter_map(|c| c.parse().ok()).collect();
        let words = cells().filter(|c| c.parse::<f64>().is_err()).map(String::from);
        let mut words: Vec<_> = words.collect();
        words.sort_unstable();
        numbers.sort_unstable_by(f64::total_cmp);
        (words, numbers)
    };
    let [(words, numbers), (again, others)] = [cells(&original), cells(&files[3])];
    assert_eq!(words, again);
    assert_eq!(numbers.len(), others.len());
    assert!(numbers.iter().zip(&others).all(|(a, b)| (a - b).abs() < 1e-9));
}

#[test]
fn inspect_finds_what_effort_is_and_refuses_a_cut_bag() {
    let bags = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bags");
    let out = armtwin(&["inspect", text(&bags.join("folder_mcap"))]);
    assert_eq!(out.code, 0, "{}", out.stderr);
    let words = out.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in ["ROS 2 bag (folder), joint states of /joint_states", "effort", "gravity"] {
        assert!(words.contains(part), "{part} not in\n{}", out.stdout);
    }
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(bags.join("zstd.mcap")).unwrap();
    let cut = write(folder.path(), "cut.mcap", &bytes[..bytes.len() - 2000]);
    refused(folder.path(), &cut, &[], &["cut.mcap", "cut off after", "mcap recover"]);
    let map = write(folder.path(), "map.toml", "[bag]\ntopic = '/arm'\n");
    let whole = bags.join("zstd.mcap");
    refused(folder.path(), &whole, &["--columns", text(&map)], &["topic \"/arm\"", "column map"]);
}

/// The reason is said once, whoever adds to it on the way.
#[test]
fn damaged_gzip_says_why_once() {
    let folder = tempfile::tempdir().unwrap();
    let whole = write(folder.path(), "a.csv", csv(50));
    let packed = folder.path().join("b.csv.gz");
    assert_eq!(armtwin(&["convert", text(&whole), "-o", text(&packed)]).code, 0);
    let bytes = std::fs::read(&packed).unwrap();
    let cut = write(folder.path(), "cut.csv.gz", &bytes[..bytes.len() / 2]);
    let out = armtwin(&["inspect", text(&cut)]);
    assert_eq!(out.code, 1);
    assert_eq!(out.stderr.matches("incomplete deflate stream").count(), 1, "{}", out.stderr);
    let folder_as_twin = text(folder.path());
    let twin = armtwin(&["identify", text(&whole), "--twin", folder_as_twin]);
    assert_eq!(twin.stderr.matches("os error").count(), 1, "{}", twin.stderr);
}

/// Small files that once took gigabytes, in a process that may have 1.5 GB in all, its libraries and
/// threads included: one message, and no more is asked for.
#[cfg(target_os = "linux")]
#[test]
fn small_files_do_not_take_gigabytes() {
    use std::io::Write;
    let folder = tempfile::tempdir().unwrap();
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(b"timestamp,actual_q_0\n").unwrap();
    let block = "1,2\n".repeat(100_000);
    (0..200).for_each(|_| packed.write_all(block.as_bytes()).unwrap());
    let rows = write(folder.path(), "rows.csv.gz", packed.finish().unwrap());
    let magic = b"\x89MCAP0\r\n";
    let announced = [&magic[..], &[6], &(1u64 << 30).to_le_bytes(), b"short"].concat();
    let announced = write(folder.path(), "announced.mcap", announced);
    let zeros = zstd::encode_all(std::io::Read::take(std::io::repeat(0), 250 << 20), 1).unwrap();
    let mut chunk = vec![0; 16];
    chunk.extend((250u64 << 20).to_le_bytes());
    chunk.extend([0; 4]);
    chunk.extend([4, 0, 0, 0]);
    chunk.extend(b"zstd");
    chunk.extend((zeros.len() as u64).to_le_bytes());
    chunk.extend(zeros);
    let bomb = [&magic[..], &[6], &(chunk.len() as u64).to_le_bytes(), &chunk].concat();
    let bomb = write(folder.path(), "bomb.mcap", bomb.repeat(3));
    for file in [&rows, &announced, &bomb] {
        let program = env!("CARGO_BIN_EXE_armtwin");
        let line =
            format!("ulimit -v 1500000; RAYON_NUM_THREADS=2 '{program}' inspect '{}'", text(file));
        let out = std::process::Command::new("sh").args(["-c", &line]).output().unwrap();
        let error = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(1), "{}: {error}", file.display());
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}
