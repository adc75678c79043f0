//! `record`, `serve`, `watch`, `history`: over loopback, against each other and against clients and a server
//! that nobody here wrote. Nothing here depends on how fast the machine is.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::{Output, armtwin};

/// Programs of others, which stay where they are.
const PEERS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/peers/rtde");
/// Python with the package `ur_rtde`.
const SDU: &str = "ARMTWIN_UR_RTDE_PYTHON";

const SCENARIO: &str = "
[motion]
kind = \"random_frequency\"
duration_s = 5
[noise]
snr_db = 34
position_rad = 2e-5
velocity_rad_s = 1.5e-3
[effects.coulomb]
coulomb = [6, 7, 5, 1.5, 1.2, 1.0]
[effects.viscous]
viscous = [9, 11, 7, 1.9, 1.4, 1.1]
";

const TWIN: &str = "
robot = \"ur5\"
[twin]
effects = [\"coulomb\", \"viscous\"]
[twin.values]
coulomb = [6, 7, 5, 1.5, 1.2, 1.0]
viscous = [9, 11, 7, 1.9, 1.4, 1.1]
";

fn peer(name: &str) -> Option<PathBuf> {
    let path = Path::new(PEERS).join(name);
    if !path.exists() {
        eprintln!("skipped: {} is not there", path.display());
        return None;
    }
    Some(path)
}

/// A program that runs until it is dropped.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A served arm and where it listens.
fn serve(folder: &Path, more: &[&str]) -> (Running, String) {
    let scenario = folder.join("scenario.toml");
    fs::write(&scenario, SCENARIO).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_armtwin"))
        .args(["serve", "--scenario", scenario.to_str().unwrap()])
        .args(more)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(child.stdout.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let address = line.split("rtde://").nth(1).unwrap_or_else(|| panic!("{line}"));
    let address = address.split(',').next().unwrap().to_string();
    // What it says later must not fill the pipe.
    std::thread::spawn(move || std::io::copy(&mut said, &mut std::io::sink()));
    (Running(child), address)
}

fn record(address: &str, out: &Path, more: &[&str]) -> Output {
    let from = format!("rtde://{address}");
    let arguments = ["record", "--from", &from, "-o", out.to_str().unwrap()];
    armtwin(&[&arguments[..], more].concat())
}

fn simulated(folder: &Path) -> PathBuf {
    let scenario = folder.join("scenario.toml");
    let out = folder.join("simulated");
    let run = armtwin(&["simulate", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    out.join("fit.csv")
}

#[test]
fn what_is_recorded_is_what_the_scenario_says_to_the_last_bit() {
    let folder = TempDir::new().unwrap();
    let (_arm, address) = serve(folder.path(), &["--port", "0", "--wait"]);
    let out = folder.path().join("run.parquet");
    let run = record(&address, &out, &["--seconds", "5"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(
        run.stdout.contains("626 rows, 5.000 s") && run.stdout.contains("no row was dropped"),
        "{}",
        run.stdout
    );
    assert!(run.stderr.contains("controller 3.15.8"), "{}", run.stderr);
    let read = |path: &Path| armtwin::recording::read(path, None).unwrap();
    let (recorded, expected) = (read(&out), read(&simulated(folder.path())));
    assert_eq!(recorded.time, expected.time);
    for channel in &expected.channels {
        let got = recorded.channel(&channel.name).unwrap();
        let bits = |x: &[f64]| x.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(got), bits(&channel.values), "{}", channel.name);
    }
    assert!(!folder.path().join("run.parquet.part.csv").exists());
}

#[cfg(unix)]
#[test]
fn a_killed_recording_is_whole_up_to_its_last_second() {
    let folder = TempDir::new().unwrap();
    let (_arm, address) = serve(folder.path(), &["--port", "0", "--rate", "500"]);
    let out = folder.path().join("run.parquet");
    let mut child = Command::new(env!("CARGO_BIN_EXE_armtwin"))
        .args(["record", "--from", &format!("rtde://{address}"), "--rate", "500"])
        .args(["-o", out.to_str().unwrap()])
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let journal = folder.path().join("run.parquet.part.csv");
    let begun = Instant::now();
    while fs::metadata(&journal).map_or(0, |m| m.len()) < 800_000 {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing is recorded");
        std::thread::sleep(Duration::from_millis(20));
    }
    let handed_over = fs::read_to_string(&journal).unwrap().lines().count() - 2;
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!out.exists(), "nothing half-written has the final name");
    let read = armtwin::recording::read(&journal, None).unwrap();
    assert!(read.time.len() >= handed_over && read.time.len() > 500);
    let usual = read.time.windows(2).filter(|t| (t[1] - t[0] - 0.002).abs() < 1e-9).count();
    assert_eq!(usual, read.time.len() - 1, "no row is missing before the last one");
    let again = record(&address, &out, &["--seconds", "1"]);
    assert_eq!(again.code, 1);
    assert!(
        again.stderr.contains("run.parquet.part.csv")
            && again.stderr.contains("under another name")
    );
    let made = armtwin(&["convert", journal.to_str().unwrap(), "-o", out.to_str().unwrap()]);
    assert_eq!(made.code, 0, "{}", made.stderr);
}

#[test]
fn recording_from_the_stand_in_server_of_others() {
    let Some(server) = peer("fake-rtde-controller.py") else { return };
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let mut start = Command::new("python3");
    start.arg(server).args(["-p", &port.to_string(), "-c", "100"]).stdout(Stdio::null());
    let Ok(child) = start.stderr(Stdio::null()).spawn() else {
        eprintln!("skipped: there is no python3");
        return;
    };
    let _server = Running(child);
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("run.csv");
    let begun = Instant::now();
    let run = loop {
        let run = record(&format!("127.0.0.1:{port}"), &out, &[]);
        // It answers once it listens, and closes after its hundred rows.
        if !run.stderr.contains("no controller answers")
            || begun.elapsed() > Duration::from_secs(20)
        {
            break run;
        }
    };
    assert_eq!(run.code, 1, "a cut recording is a failure that is told: {}", run.stderr);
    assert!(run.stderr.contains("was closed by the other side"), "{}", run.stderr);
    assert!(
        run.stdout.contains("100 rows, 99.000 s") && run.stdout.contains("99 gaps"),
        "{}",
        run.stdout
    );
    let read = armtwin::recording::read(&out, None).unwrap();
    assert_eq!(read.channel("actual_q_5").unwrap()[99], 99.0);
}

/// What a Python script says with `arguments`; `None` where there is no such Python.
fn python(python: &str, script: &str, arguments: &[&str]) -> Option<String> {
    let run = Command::new(python).arg("-c").arg(script).args(arguments).output().ok()?;
    let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{out}\n{err}");
    Some(out.into_owned())
}

const OFFICIAL: &str = r#"
import csv, struct, sys, time
import xml.etree.ElementTree as xml
client, port, table = sys.argv[1:]
sys.path.insert(0, client)
from rtde.rtde import RTDE
link = RTDE("127.0.0.1", int(port))
link.connect()
assert link.get_controller_version()[0] == 3
recipes = {r.get("key"): r for r in xml.parse(client + "/examples/record_configuration.xml").getroot()}
fields = [(f.get("name"), f.get("type")) for f in recipes["out"]]
assert link.send_output_setup([n for n, _ in fields], [t for _, t in fields], frequency=125)
assert link.send_start()
rows = list(csv.DictReader(open(table)))
names = ["target_q", "target_qd", "target_qdd", "target_current", "target_moment", "actual_q", "actual_qd",
         "actual_current", "joint_temperatures"]
for row in rows:
    state = None
    while state is None:
        state = link.receive_buffered()
        if state is None:
            time.sleep(0.001)
    assert struct.pack("d", state.timestamp) == struct.pack("d", float(row["timestamp"])), row["timestamp"]
    for name in names:
        for joint, got in enumerate(getattr(state, name)):
            assert struct.pack("d", got) == struct.pack("d", float(row["%s_%d" % (name, joint)])), name
assert link.send_pause()
print(len(rows), "rows,", len(fields), "fields")
"#;

#[test]
fn the_manufacturers_client_receives_the_scenario_to_the_last_bit() {
    let Some(client) = peer("official_client") else { return };
    let folder = TempDir::new().unwrap();
    let (_arm, address) = serve(folder.path(), &["--port", "0", "--wait"]);
    let table = simulated(folder.path());
    let port = address.rsplit(':').next().unwrap();
    let arguments = [client.to_str().unwrap(), port, table.to_str().unwrap()];
    match python("python3", OFFICIAL, &arguments) {
        Some(said) => assert_eq!(said.trim(), "626 rows, 32 fields"),
        None => eprintln!("skipped: there is no python3"),
    }
}

const SDU_SCRIPT: &str = r#"
import csv, struct, sys, time
import rtde_receive
arm = rtde_receive.RTDEReceiveInterface(sys.argv[1], 125.0)
rows = {struct.pack("d", float(r["timestamp"])): r for r in csv.DictReader(open(sys.argv[2]))}
found = 0
end = time.time() + 20
while found < 20 and time.time() < end:
    before = struct.pack("d", arm.getTimestamp())
    q, qd, current = arm.getActualQ(), arm.getActualQd(), arm.getActualCurrent()
    # A row that was taken from one package.
    if struct.pack("d", arm.getTimestamp()) != before or before not in rows:
        continue
    row = rows.pop(before)
    for name, values in [("actual_q", q), ("actual_qd", qd), ("actual_current", current)]:
        for joint, got in enumerate(values):
            assert struct.pack("d", got) == struct.pack("d", float(row["%s_%d" % (name, joint)])), name
    found += 1
assert arm.getRobotMode() == 7 and arm.getSafetyMode() == 1
print(found, "rows")
"#;

/// This client knows one port only; another loopback address keeps it apart from whatever is on it.
#[cfg(target_os = "linux")]
#[test]
fn ur_rtde_receives_the_scenario_to_the_last_bit() {
    let Ok(with_package) = std::env::var(SDU) else {
        eprintln!("skipped: {SDU} does not name a Python with ur_rtde");
        return;
    };
    let folder = TempDir::new().unwrap();
    let (_arm, _) = serve(folder.path(), &["--host", "127.0.30.4", "--wait"]);
    let table = simulated(folder.path());
    let arguments = ["127.0.30.4", table.to_str().unwrap()];
    match python(&with_package, SDU_SCRIPT, &arguments) {
        Some(said) => assert_eq!(said.trim(), "20 rows"),
        None => panic!("{with_package} does not start"),
    }
}

#[test]
fn what_cannot_be_done_is_told_before_anything_is_written() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("run.parquet");
    let closed = record("127.0.0.1:1", &out, &[]);
    assert_eq!(closed.code, 1);
    assert!(closed.stderr.contains("no controller answers there"), "{}", closed.stderr);
    let bag = record("127.0.0.1:1", &folder.path().join("run.mcap"), &[]);
    assert!(bag.stderr.contains("`armtwin convert` makes other formats"), "{}", bag.stderr);
    let other = armtwin(&["record", "--from", "http://arm", "-o", out.to_str().unwrap()]);
    assert!(other.stderr.contains("only rtde://HOST[:PORT] and files"), "{}", other.stderr);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);

    let scenario = folder.path().join("scenario.toml");
    fs::write(&scenario, SCENARIO).unwrap();
    let switched = |effect: &str| {
        armtwin(&["serve", "--scenario", scenario.to_str().unwrap(), "--at", "60s", effect]).stderr
    };
    assert!(switched("load_friction.joint2").contains("for example load_friction.joint2=0.1"));
    assert!(switched("payload_mass=3").contains("no such effect"));
    assert!(switched("coulomb.joint1=1e9").contains("out of range"));
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let run = armtwin(&["serve", "--scenario", scenario.to_str().unwrap(), "--port", &port]);
    assert!(run.stderr.contains("cannot listen at 127.0.0.1"), "{}", run.stderr);
    let open = armtwin(&["watch", "--robot", "ur5", "--from", scenario.to_str().unwrap()]);
    assert_eq!(open.code, 1);
}

/// 90 s as the twin has it, then 40 s with another friction at joint 3, as one recording.
fn changed(folder: &Path) -> PathBuf {
    let run = |name: &str, scenario: String, seconds: &str| {
        let path = folder.join(format!("{name}.toml"));
        fs::write(&path, scenario).unwrap();
        let out = folder.join(name);
        let arguments = ["--out", out.to_str().unwrap(), "--duration", seconds];
        let run = armtwin(&[&["simulate", path.to_str().unwrap()][..], &arguments].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        armtwin::recording::read(&out.join("fit.csv"), None).unwrap()
    };
    let mut all = run("before", SCENARIO.into(), "90");
    let after = run("after", SCENARIO.replace("7, 5, 1.5", "7, 6.5, 1.5"), "40");
    let begins = all.time.last().unwrap() + 0.3;
    all.time.extend(after.time.iter().map(|t| begins + t));
    for (channel, more) in all.channels.iter_mut().zip(&after.channels) {
        channel.values.extend(&more.values);
    }
    let path = folder.join("day.csv");
    armtwin::recording::write(&all, &path, &Default::default()).unwrap();
    path
}

#[test]
fn a_change_is_noticed_where_and_when_it_is_and_remembered() {
    let folder = TempDir::new().unwrap();
    let day = changed(folder.path());
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    fs::write(path("twin.toml"), TWIN).unwrap();
    let watch = |more: &[&str]| {
        let (twin, from) = (path("twin.toml"), day.to_str().unwrap());
        let arguments = ["watch", "--twin", &twin, "--from", from, "--fast", "--no-diagnosis"];
        let run = armtwin(&[&arguments[..], more].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        run.stdout
    };
    let said = watch(&["--history", &path("watched"), "--json", &path("seen.jsonl")]);
    assert!(said.contains("one false alarm in 168.0000 h of motion is expected"), "{said}");
    assert!(said.contains("the gap of joint 3 changed") && said.contains("1 change"), "{said}");
    let seen = fs::read_to_string(path("seen.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> =
        seen.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let change = lines.iter().find(|l| l["kind"] == "change").unwrap();
    assert_eq!(change["joint"], 3);
    let (since, noticed) = (change["since"].as_f64().unwrap(), change["noticed"].as_f64().unwrap());
    assert!((since - 90.3).abs() < 6.0 && noticed - 90.3 < 40.0, "{change}");
    let gaps: Vec<_> = lines.iter().filter(|l| l["kind"] == "gap").collect();
    let last = gaps.last().unwrap();
    let along = &last["joints"][2]["now"]["sliding"]["along_nm"];
    assert!((0.4..2.0).contains(&along.as_f64().unwrap()), "{last}");
    assert!(gaps.len() > 50);

    let page = path("watched.html");
    let history = armtwin(&["history", &path("watched"), "-o", &page]);
    assert_eq!(history.code, 0, "{}", history.stderr);
    assert!(
        history.stdout.contains("1 change") && history.stdout.contains("joint 3 changed"),
        "{}",
        history.stdout
    );
    let html = fs::read_to_string(page).unwrap();
    assert!(html.contains("Joint 6") && html.contains("joint 3 changed"));
    // What is quiet stays quiet.
    let quiet = watch(&["--seconds", "90"]);
    assert!(quiet.contains("nothing changed"), "{quiet}");
}
