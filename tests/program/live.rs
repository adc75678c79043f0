//! `--stream` and `--serve`: what a viewer gets that listens, and that nothing waits for one.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use armtwin::viewer::live::{Address, Server};
use re_log_channel::DataSourceMessage;
use rerun::external::{re_grpc_client, re_uri};
use rerun::log::{Chunk, LogMsg};
use tempfile::TempDir;

use super::{Output, armtwin};

const SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/ur5_friction.toml");
/// Of silence, before a viewer's recording counts as whole.
const SILENCE: Duration = Duration::from_secs(2);

/// Rows and their sum by recording and entity, as a viewer has them that joined at an address.
type Seen = BTreeMap<(String, String), (usize, f64)>;

/// Joins as the viewer does, until nothing has come for a while.
fn join(address: &str) -> Seen {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    let handle = re_async::AsyncRuntimeHandle::new_native(runtime.handle().clone());
    let url = Address::new(address).url();
    let re_uri::RedapUri::Proxy(uri) = url.parse().unwrap() else { panic!("{url}") };
    let messages = re_grpc_client::stream(&handle, uri);
    let mut seen = Seen::new();
    while let Ok(message) = messages.recv_timeout(SILENCE) {
        let Some(DataSourceMessage::LogMsg(LogMsg::ArrowMsg(store, arrow))) = message.into_data()
        else {
            continue;
        };
        if store.is_recording() {
            let chunk = Chunk::from_arrow_msg(&arrow).unwrap();
            let entity = chunk.entity_path().to_string();
            let scalars = rerun::Scalars::descriptor_scalars().component;
            let values = chunk.iter_slices::<f64>(scalars).flatten().filter(|v| v.is_finite());
            let of = seen.entry((store.recording_id().to_string(), entity)).or_default();
            of.0 += if chunk.is_static() { 0 } else { chunk.num_rows() };
            of.1 += values.sum::<f64>();
        }
    }
    seen
}

/// (rows, sum of values) of an entity, recording by recording.
fn of(seen: &Seen, entity: &str) -> Vec<(usize, f64)> {
    seen.iter().filter(|((_, e), _)| e == entity).map(|(_, found)| *found).collect()
}

fn simulate(out: &Path, more: &[&str]) -> Output {
    let out = out.to_str().unwrap();
    let arguments = ["simulate", SCENARIO, "--duration", "8", "--out", out];
    armtwin(&[&arguments[..], more].concat())
}

fn files(folder: &Path) -> [Vec<u8>; 3] {
    ["fit.csv", "check.csv", "truth.json"].map(|name| fs::read(folder.join(name)).unwrap())
}

#[test]
fn a_viewer_that_listens_sees_the_arm_move() {
    let folder = TempDir::new().unwrap();
    let [shown, alone] = ["shown", "alone"].map(|name| folder.path().join(name));
    let server = Server::start(&Address::new("127.0.0.1:0")).unwrap();
    let run = simulate(&shown, &[&format!("--stream={}", server.address)]);
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    assert_eq!(simulate(&alone, &[]).code, 0);
    assert!(files(&shown) == files(&alone), "who looks on changes nothing");

    let seen = join(&server.address.to_string());
    // Both recordings, 8 s at 125 Hz; the noise of their positions is 0.02 mrad.
    for joint in 1..=6 {
        for quantity in ["torque", "angle", "tracking"] {
            let found = of(&seen, &format!("/joint_{joint}/{quantity}"));
            let rows: Vec<usize> = found.iter().map(|(rows, _)| *rows).collect();
            assert_eq!(rows, [1001, 1001], "{quantity} of joint {joint}");
        }
    }
    let table = String::from_utf8(files(&alone)[0].clone()).unwrap();
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let sum = |name: &str| -> f64 {
        let at = header.iter().position(|h| *h == name).unwrap();
        let cells = table.lines().skip(1).map(|l| l.split(',').nth(at).unwrap());
        cells.map(|cell| cell.parse::<f64>().unwrap()).sum()
    };
    let both = sum("target_q_2") + sum("actual_q_2");
    let angles = of(&seen, "/joint_3/angle");
    assert!(angles.iter().any(|(_, shown)| (shown - both).abs() < 0.02), "{angles:?}, {both}");
    assert!(of(&seen, "/arm/simulated/shoulder_link").iter().all(|(rows, _)| *rows > 200));
}

/// A program that serves, ended when dropped.
struct Serving(Child, String);

impl Serving {
    /// Waits until it has said where, and that its work is done.
    fn start(arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_armtwin"))
            .args(arguments)
            .arg("--serve=127.0.0.1:0")
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
        let mut serving = Self(child, String::new());
        let address = said.next().unwrap();
        let url = address.split("rerun+http://").nth(1).expect(&address);
        serving.1 = url.trim_end_matches("/proxy").to_string();
        let last = said.next().unwrap();
        assert!(last.contains("done; still serving"), "{last}");
        serving
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn viewers_that_join_late_get_the_whole_comparison() {
    let folder = TempDir::new().unwrap();
    assert_eq!(simulate(folder.path(), &[]).code, 0);
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let serving = Serving::start(&["compare", &path("fit.csv"), "-o", &path("fit.rrd")]);
    assert!(folder.path().join("fit.rrd").is_file(), "the files do not wait for Ctrl-C");
    let first = join(&serving.1);
    for quantity in ["torque", "residual", "angle", "tracking", "velocity"] {
        let found = of(&first, &format!("/joint_6/{quantity}"));
        assert_eq!(found.iter().map(|f| f.0).collect::<Vec<_>>(), [1001], "{quantity}");
    }
    let expected = ["/summary", "/arm/simulated/flange_path", "/arm/recorded/flange_path"];
    assert!(expected.iter().all(|e| of(&first, e).len() == 1), "{:?}", first.keys());
    assert_eq!(join(&serving.1), first, "another one gets the same");
}

#[test]
fn nobody_is_waited_for() {
    let folder = TempDir::new().unwrap();
    let [alone, unheard, stalled] = ["alone", "unheard", "stalled"].map(|n| folder.path().join(n));
    assert_eq!(simulate(&alone, &[]).code, 0);
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = free.local_addr().unwrap();
    // Takes the connection and never says a word.
    let mute = simulate_for(&stalled, &format!("--stream={address}"), 40);
    assert!(mute.contains("not all was shown"), "{mute}");
    drop(free);
    let note = simulate_for(&unheard, &format!("--stream={address}"), 20);
    for part in [&*format!("no viewer listens at {address}"), "goes on without", "--serve"] {
        assert!(note.contains(part), "{note}");
    }
    assert_eq!(note.lines().count(), 1, "{note}");
    assert!(files(&alone) == files(&unheard) && files(&alone) == files(&stalled));
}

/// What it says; it must end well within `seconds`.
fn simulate_for(out: &Path, flag: &str, seconds: u64) -> String {
    let begun = Instant::now();
    let run = simulate(out, &[flag]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(begun.elapsed() < Duration::from_secs(seconds), "{:?}", begun.elapsed());
    run.stderr
}

#[test]
fn bad_addresses_are_refused_before_the_work() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    for flag in ["--stream=9876", "--serve=host", "--serve=127.0.0.1:99999"] {
        let run = simulate(&out, &[flag]);
        assert_eq!(run.code, 2, "{flag}: {}", run.stderr);
        assert!(run.stderr.contains("a host and a port, for example 127.0.0.1:9876"));
    }
    assert_eq!(simulate(&out, &["--stream", "--serve"]).code, 2);
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap();
    let run = simulate(&out, &[&format!("--serve={address}")]);
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains(&format!("cannot serve at {address}")), "{}", run.stderr);
    assert!(!out.exists(), "nothing is done");
}
