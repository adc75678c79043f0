//! One target per reader: where it starts from, how inputs are made, what reads them.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use armtwin::motor::scenario::Scenario as MotorScenario;
use armtwin::recording::{self, ColumnMap};
use armtwin::robot::{Chain, urdf};
use armtwin::simulation::Scenario;
use armtwin::studies::sweep::Study;
use armtwin::twin::Twin;
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;

use crate::bytes::{MOST, Random, havoc, text, words_of};
use crate::{make_lerobot, make_mcap, make_parquet, make_sqlite};

pub struct Target {
    pub name: &'static str,
    pub seeds: fn() -> Vec<Vec<u8>>,
    pub make: fn(&mut Random, &Corpus) -> Vec<u8>,
    /// Reads the bytes as files in the folder; what was read, or why not.
    pub read: fn(&Path, &[u8]) -> Result<String, String>,
}

pub fn all() -> Vec<Target> {
    let target = |name, seeds, make, read| Target { name, seeds, make, read };
    vec![
        target("csv", csv_seeds, text_input, |f, b| recorded(f, "a.csv", b)),
        target("csv_gz", csv_gz_seeds, packed_text, |f, b| recorded(f, "a.csv.gz", b)),
        target("mapped_csv", mapped_seeds, text_input, mapped),
        target("log_folder", folder_seeds, text_input, logs),
        target("mcap", mcap_seeds, make_mcap::make, |f, b| recorded(f, "a.mcap", b)),
        target("db3", make_sqlite::seeds, make_sqlite::make, |f, b| recorded(f, "a.db3", b)),
        target("parquet", make_parquet::seeds, make_parquet::make, |f, b| {
            recorded(f, "a.parquet", b)
        }),
        target("bam_json", bam_seeds, text_input, |f, b| recorded(f, "a.json", b)),
        target("sage_folder", sage_seeds, text_input, sage),
        target("lerobot", lerobot_seeds, text_input, lerobot),
        target("columns", columns_seeds, text_input, columns),
        target("urdf", urdf_seeds, text_input, robot),
        target("twin", twin_seeds, text_input, twin),
        target("scenario", scenario_seeds, text_input, scenario),
        target("motor", motor_seeds, text_input, motor),
        target("study", study_seeds, text_input, study),
    ]
}

pub struct Corpus {
    pub seeds: Vec<Vec<u8>>,
    /// What was answered in a way of its own.
    pub kept: Vec<Vec<u8>>,
    /// The words of all seeds.
    pub words: Vec<Vec<u8>>,
}

impl Corpus {
    pub fn new(seeds: Vec<Vec<u8>>) -> Self {
        let words = words_of(&seeds);
        Self { seeds, kept: Vec::new(), words }
    }

    pub fn pick(&self, random: &mut Random) -> Vec<u8> {
        match self.kept.is_empty() || random.one_in(3) {
            true => random.of(&self.seeds).clone(),
            false => random.of(&self.kept).clone(),
        }
    }
}

pub fn memory_folder() -> PathBuf {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { memory.to_path_buf() } else { std::env::temp_dir() }
}

pub fn seed_file(path: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// All files of a folder that end so and are no longer than an input may be.
fn seed_files(folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut paths: Vec<_> = entries.flatten().map(|e| e.path()).collect();
    paths.sort();
    let wanted = paths.iter().filter(|p| p.to_string_lossy().ends_with(ending));
    wanted.filter_map(|p| std::fs::read(p).ok()).filter(|b| b.len() <= MOST).collect()
}

fn text_input(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let mut input = corpus.pick(random);
    match random.below(3) {
        0 => text(random, &mut input),
        1 => (0..1 + random.below(4)).for_each(|_| text(random, &mut input)),
        _ => havoc(random, &mut input, &corpus.words, &corpus.seeds),
    }
    input.truncate(MOST);
    input
}

fn csv_seeds() -> Vec<Vec<u8>> {
    let whole = seed_file("tests/bags/expected.csv");
    let spread = |from: u8, to: u8| {
        whole.iter().map(|b| if *b == from { to } else { *b }).collect::<Vec<u8>>()
    };
    let small = b"timestamp,actual_q_0,actual_q_1\n".to_vec();
    let rows = (0..12).map(|k| format!("{},{k},-1e-3\n", 0.008 * f64::from(k)));
    let small: Vec<u8> = small.into_iter().chain(rows.flat_map(String::into_bytes)).collect();
    vec![small, spread(b',', b' '), spread(b',', b'\t'), whole]
}

fn csv_gz_seeds() -> Vec<Vec<u8>> {
    csv_seeds().iter().map(|text| gzip(text)).collect()
}

fn gzip(text: &[u8]) -> Vec<u8> {
    let mut out = GzEncoder::new(Vec::new(), Compression::fast());
    out.write_all(text).expect("packs");
    out.finish().expect("packs")
}

fn packed_text(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let mut input = corpus.pick(random);
    let mut plain = Vec::new();
    let whole = GzDecoder::new(input.as_slice()).take(MOST as u64).read_to_end(&mut plain).is_ok();
    if !whole || random.one_in(3) {
        havoc(random, &mut input, &[], &corpus.seeds);
        return input;
    }
    havoc(random, &mut plain, &[], &[]);
    // Long runs of one line pack well.
    if random.one_in(64) {
        plain = plain.repeat(1 + random.below(500));
    }
    gzip(&plain)
}

/// Between the files of one input.
const NEXT_FILE: &[u8] = b"\n%%%%\n";

fn parts(input: &[u8]) -> Vec<&[u8]> {
    let (mut parts, mut rest) = (Vec::new(), input);
    let width = NEXT_FILE.len();
    while let Some(at) = rest.windows(width).position(|w| w == NEXT_FILE) {
        parts.push(&rest[..at]);
        rest = &rest[at + width..];
    }
    parts.push(rest);
    parts
}

fn mapped_seeds() -> Vec<Vec<u8>> {
    let csv = &csv_seeds()[3];
    let maps: [&[u8]; 3] = [
        b"time = 1\n[channels]\nactual_q = { first = 2, count = 6 }\nactual_qd = { columns = [8, 9], scale = 2 }\n",
        b"time = 'timestamp'\nskip_rows = 0\ndelimiter = 'comma'\ntime_scale = 0.5\nfile_columns = 19\n\
          [channels]\nactual_q = { columns = ['actual_q_0', 'actual_q_0'], scale = [1, -1] }\n",
        b"time = 1\ndelimiter = 'semicolon'\ndecimal = ','\n[channels]\nactual_q = { first = 2, count = 1 }\n",
    ];
    maps.iter().map(|map| [map, NEXT_FILE, csv].concat()).collect()
}

fn mapped(folder: &Path, input: &[u8]) -> Result<String, String> {
    let parts = parts(input);
    let map = folder.join("map.toml");
    write(&map, parts[0]);
    let csv = folder.join("a.csv");
    write(&csv, parts.get(1).unwrap_or(&&b""[..]));
    answer(recording::read(&csv, Some(&map)))
}

fn folder_seeds() -> Vec<Vec<u8>> {
    let log = |shift: f64, rows: u32| -> Vec<u8> {
        let row = |k: u32| format!("{:.4}, {k}, {}\n", 0.008 * f64::from(k) + shift, 2 * k);
        (0..rows).flat_map(|k| row(k).into_bytes()).collect()
    };
    let all = |shift| [log(0.0, 40), log(shift, 30), log(0.001, 35)].join(NEXT_FILE);
    vec![all(1e-5), all(0.004)]
}

fn logs(folder: &Path, input: &[u8]) -> Result<String, String> {
    let folder = folder.join("logs");
    let _ = std::fs::create_dir_all(&folder);
    let names = ["log_q_actual.csv", "log_i_actual.csv", "log_m_target.csv"];
    for (name, part) in names.iter().zip(parts(input)) {
        write(&folder.join(name), part);
    }
    answer(recording::read(&folder, None))
}

fn bam_seeds() -> Vec<Vec<u8>> {
    let entry = |k: u32| {
        let (t, q) = (0.005 * f64::from(k), 0.01 * f64::from(k));
        format!(
            "{{\"timestamp\": {t}, \"goal_position\": {q}, \"position\": {q}, \"speed\": 0.1, \
             \"torque_enable\": true}}"
        )
    };
    let entries: Vec<String> = (0..20).map(entry).collect();
    let entries = entries.join(", ");
    let said = "\"kp\": 400, \"vin\": 7.3, \"mass\": 0.5, \"length\": 0.1, \"motor\": \"xl330\"";
    vec![
        format!("{{{said}, \"entries\": [{entries}]}}").into_bytes(),
        format!("{{\"entries\": [{entries}]}}").into_bytes(),
    ]
}

fn sage_seeds() -> Vec<Vec<u8>> {
    let rows = |kind: &str, every: u32| -> Vec<u8> {
        let row = |k: u32| format!("{kind},{},\"[{}.5, -0.25]\"\n", 20_000 * k, k);
        let head = "type,timestamp,positions\n".to_string();
        (head + &(0..40).step_by(every as usize).map(row).collect::<String>()).into_bytes()
    };
    vec![[rows("CONTROL", 2), rows("STATE_MOTOR", 1)].join(NEXT_FILE)]
}

fn sage(folder: &Path, input: &[u8]) -> Result<String, String> {
    let folder = folder.join("motion");
    let _ = std::fs::create_dir_all(&folder);
    for (name, part) in ["control.csv", "state_motor.csv"].iter().zip(parts(input)) {
        write(&folder.join(name), part);
    }
    answer(recording::read(&folder, None))
}

fn lerobot_seeds() -> Vec<Vec<u8>> {
    make_lerobot::sets().iter().map(|set| set.join(NEXT_FILE)).collect()
}

/// Both layouts' names hold the rows.
fn lerobot(folder: &Path, input: &[u8]) -> Result<String, String> {
    let folder = folder.join("set");
    let (meta, data) = (folder.join("meta"), folder.join("data/chunk-000"));
    [&meta, &data].iter().for_each(|f| drop(std::fs::create_dir_all(f)));
    let parts = parts(input);
    write(&meta.join("info.json"), parts[0]);
    for name in ["episode_000000.parquet", "file-000.parquet"] {
        write(&data.join(name), parts.get(1).unwrap_or(&&b""[..]));
    }
    let map = folder.join("map.toml");
    write(&map, b"[lerobot]\nunit = 'degrees'\n");
    answer(recording::read(&folder, Some(&map)))
}

fn mcap_seeds() -> Vec<Vec<u8>> {
    seed_files("tests/bags", ".mcap")
}

fn columns_seeds() -> Vec<Vec<u8>> {
    seed_files("scenarios/columns", ".toml")
}

fn columns(folder: &Path, input: &[u8]) -> Result<String, String> {
    let path = folder.join("map.toml");
    write(&path, input);
    let map = ColumnMap::load(&path).map_err(|e| e.to_string())?;
    Ok(format!("{:?} {:?}", map.delimiter, map.bag.is_some()))
}

fn urdf_seeds() -> Vec<Vec<u8>> {
    let mut all = seed_files("urdf", ".urdf");
    all.extend(seed_files("scenarios/robots", ".urdf"));
    all.push(
        br#"<?xml version="1.0"?><!-- a --><robot name="r"><link name="a"/><link name="b"><inertial>
        <origin xyz="0 0 .1" rpy="0 0 0"/><mass value="2"/><inertia ixx=".02" ixy="0" ixz="0" iyy=".02"
        iyz="0" izz=".01"/></inertial></link><joint name="j" type="revolute"><origin xyz="0 0 .3"/><parent
        link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="2"
        effort="30"/></joint></robot>"#
            .to_vec(),
    );
    all
}

fn robot(folder: &Path, input: &[u8]) -> Result<String, String> {
    let path = folder.join("arm.urdf");
    write(&path, input);
    let loaded = urdf::read_file(&path, &Chain::default()).map_err(|e| e.to_string())?;
    let again = urdf::read(&urdf::write(&loaded.robot), "again", &Chain::default());
    again.map_err(|e| format!("what was written: {e}"))?;
    Ok(format!("{} {}", loaded.robot.dof(), loaded.notes.join(" ")))
}

fn twin_seeds() -> Vec<Vec<u8>> {
    let mut all = seed_files("scenarios/twins", ".toml");
    all.push(
        b"robot = 'ur5'\n[drive]\nrotor_inertia = 1\ngear_ratio = [101, 101, 101, 101, 101, 101]\n\
          current_limit = 10\n[twin]\neffects = ['coulomb', 'payload', 'link_inertia', 'stribeck']\n\
          [twin.values]\ncoulomb = 5\npayload_mass = 2.5\npayload_moment_x = 0\npayload_moment_y = 0\n\
          payload_moment_z = 0.2\nlink_mass = [0, 0.4, 0, 0, 0, 0.1]\nlink_moment_x = 0.05\n\
          link_moment_y = 0\nlink_moment_z = 0\n"
            .to_vec(),
    );
    all
}

fn twin(folder: &Path, input: &[u8]) -> Result<String, String> {
    let path = folder.join("twin.toml");
    write(&path, input);
    let twin = Twin::load(&path).map_err(|e| e.to_string())?;
    let again =
        Twin::parse(&twin.to_toml(), &path).map_err(|e| format!("what was written: {e}"))?;
    Ok(format!("{} {}", again.effects.join(" "), again.notes.join(" ")))
}

fn scenario_seeds() -> Vec<Vec<u8>> {
    let mut all = seed_files("scenarios/effects", ".toml");
    all.extend(
        ["ur5_clean", "ur5_friction", "ur5_paper"]
            .map(|n| seed_file(&format!("scenarios/{n}.toml"))),
    );
    all
}

fn scenario(folder: &Path, input: &[u8]) -> Result<String, String> {
    let path = folder.join("scenario.toml");
    write(&path, input);
    let scenario = Scenario::load(&path).map_err(|e| e.to_string())?;
    let experiment = scenario.work_out(&path.display().to_string()).map_err(|e| e.to_string())?;
    Ok(format!("{} {}", experiment.setup.effects.len(), experiment.notes.join(" ")))
}

fn motor_seeds() -> Vec<Vec<u8>> {
    [1, 2].map(|k| seed_file(&format!("scenarios/dc_motor_{k}.toml"))).to_vec()
}

fn motor(_: &Path, input: &[u8]) -> Result<String, String> {
    let text = String::from_utf8_lossy(input);
    let scenario = MotorScenario::parse(&text).map_err(|e| e.to_string())?;
    Ok(scenario.warnings().join(" "))
}

fn study_seeds() -> Vec<Vec<u8>> {
    seed_files("scenarios/studies", ".toml")
}

fn study(folder: &Path, input: &[u8]) -> Result<String, String> {
    let path = folder.join("study.toml");
    write(&path, input);
    Study::load(&path).map(|s| format!("{:?}", s.question)).map_err(|e| e.to_string())
}

fn recorded(folder: &Path, name: &str, input: &[u8]) -> Result<String, String> {
    let path = folder.join(name);
    write(&path, input);
    answer(recording::read(&path, None))
}

fn answer(read: Result<recording::Recording, recording::RecordingError>) -> Result<String, String> {
    let recording = read.map_err(|e| e.to_string())?;
    let rows = recording.time.len();
    assert!(recording.channels.iter().all(|c| c.values.len() == rows), "columns of other lengths");
    let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
    assert!(recording.channels.iter().all(|c| finite(&c.values)), "a number that is none");
    assert!(finite(&recording.time), "a time that is none");
    let notes = recording.provenance.notes.join(" ");
    Ok(notes.chars().filter(|c| !c.is_ascii_digit()).take(120).collect())
}

fn write(path: &Path, bytes: &[u8]) {
    std::fs::write(path, bytes).expect("room in the scratch folder");
}
