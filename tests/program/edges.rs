//! Recordings that are not what they say: told before anything is worked out, and never silently wrong.

use std::path::Path;

use crate::{Output, armtwin};

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A folder with a simulated UR5, `scenario` in front of what is usual.
fn simulated(robot: &str, seconds: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("scenario.toml");
    let drive = "[drive]\ngear_ratio = 101\ntorque_constant = 0.1\n";
    std::fs::write(&scenario, format!("robot = \"{robot}\"\n{drive}")).unwrap();
    let out = text(folder.path());
    let made = armtwin(&["simulate", text(&scenario), "--duration", seconds, "--out", out]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    folder
}

/// Time, position and velocity of `joints` joints, and their torque of no arm; no rapier needed.
fn csv(joints: usize, torque: &str) -> String {
    let mut text = String::from("timestamp");
    for signal in ["actual_q", "actual_qd", torque] {
        (0..joints).for_each(|j| text += &format!(",{signal}_{j}"));
    }
    for k in 0..2000 {
        let t = 0.008 * f64::from(k);
        let w = |j: usize| 1.0 + 0.1 * j as f64;
        text += &format!("\n{t:.3}");
        (0..joints).for_each(|j| text += &format!(",{:.6}", 0.5 * (w(j) * t).sin()));
        (0..joints).for_each(|j| text += &format!(",{:.6}", 0.5 * w(j) * (w(j) * t).cos()));
        (0..joints).for_each(|j| text += &format!(",{:.6}", (w(j) * t).cos().signum()));
    }
    text + "\n"
}

/// The columns of `stem` times `factor`.
fn scaled(csv: &str, stem: &str, factor: f64) -> String {
    let mut lines = csv.lines();
    let header = lines.next().unwrap();
    let ours: Vec<bool> = header.split(',').map(|n| n.starts_with(stem)).collect();
    let cell = |(c, text): (usize, &str)| match ours[c] {
        true => (text.parse::<f64>().unwrap() * factor).to_string(),
        false => text.to_string(),
    };
    let row = |line: &str| line.split(',').enumerate().map(cell).collect::<Vec<_>>().join(",");
    format!("{header}\n{}\n", lines.map(row).collect::<Vec<_>>().join("\n"))
}

/// Every command that works something out of a recording.
fn commands(recording: &str, out: &str) -> Vec<Vec<String>> {
    let mut all = vec![
        vec!["identify", recording, "--method", "nlse"],
        vec!["diagnose", "--fit", recording, "--no-simulation"],
        vec!["contacts", recording],
    ];
    if cfg!(feature = "viewer") {
        all.push(vec!["compare", recording, "-o", out]);
    }
    all.into_iter().map(|c| c.into_iter().map(String::from).collect()).collect()
}

fn run(command: &[String], more: &[&str]) -> Output {
    let all: Vec<&str> = command.iter().map(String::as_str).chain(more.iter().copied()).collect();
    armtwin(&all)
}

#[track_caller]
fn stopped(recording: &Path, more: &[&str], parts: &[&str]) {
    let out = recording.with_extension("rrd");
    for command in commands(text(recording), text(&out)) {
        let Output { code, stdout, stderr } = run(&command, more);
        assert_eq!((code, stdout.as_str()), (1, ""), "{command:?}: {stderr}");
        for part in parts {
            assert!(stderr.contains(part), "{command:?}: {part:?} not in: {stderr}");
        }
        assert!(!out.exists(), "{command:?} wrote something");
    }
}

#[test]
fn seven_joints_are_no_ur5() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("seven.csv");
    std::fs::write(&log, csv(7, "joint_torque")).unwrap();
    stopped(&log, &[], &["seven.csv: it has 7 joints", "ur5", "--robot NAME"]);
    stopped(&log, &["--robot", "ur10e"], &["it has 7 joints, the ur10e has 6"]);
    let seen = armtwin(&["inspect", text(&log)]);
    assert_eq!(seen.code, 0, "{}", seen.stderr);
    assert!(seen.stdout.starts_with("arm: not known (--robot NAME"), "{}", seen.stdout);
    assert!(seen.stdout.contains("it has 7 joints"), "{}", seen.stdout);
}

#[test]
fn the_arm_stands_in_the_first_line_and_its_drive_is_asked_for() {
    let folder = simulated("ur3e", "12");
    let fit = folder.path().join("fit.csv");
    stopped(
        &fit,
        &[],
        &["joint 2: the torque is", "a ur5 asks for, which was assumed", "--robot NAME"],
    );
    let needs = ["no torque constants are published for the ur3e", "[drive]", "joint_torque_*"];
    stopped(&fit, &["--robot", "ur3e"], &needs);
    let unknown = armtwin(&["identify", text(&fit), "--robot", "ur3x"]);
    assert_eq!(unknown.code, 1);
    assert!(
        unknown.stderr.contains("ur3x") && unknown.stderr.contains("ur3e"),
        "{}",
        unknown.stderr
    );
    let both = ["identify", text(&fit), "--robot", "ur3e", "--twin", "scenarios/twins/ur5.toml"];
    assert_eq!(armtwin(&both).code, 2);

    let current = std::fs::read_to_string(&fit).unwrap();
    let current = current.replace("target_moment", "asked").replace("target_current", "wanted");
    let torque = scaled(&current, "actual_current", 10.1).replace("actual_current", "joint_torque");
    let log = folder.path().join("torque.csv");
    std::fs::write(&log, torque).unwrap();
    stopped(&log, &[], &["assumed because no arm was named", "ur3e"]);
    for command in commands(text(&log), text(&folder.path().join("torque.rrd"))) {
        let done = run(&command, &["--robot", "ur3e"]);
        assert_eq!(done.code, 0, "{command:?}: {}", done.stderr);
        assert!(done.stdout.starts_with("arm: ur3e (by --robot)\n"), "{}", done.stdout);
    }
    let seen = armtwin(&["inspect", text(&log), "--robot", "ur3e"]);
    assert!(seen.stdout.starts_with("arm: ur3e (by --robot)\n"), "{}", seen.stdout);
    assert!(seen.stdout.contains("recorded torque over the arm's weight"), "{}", seen.stdout);
}

#[test]
fn wrong_units_stop_every_command_and_force_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = ["simulate", "scenarios/ur5_friction.toml", "--duration", "12", "--out"];
    let made = armtwin(&[&scenario[..], &[text(folder.path())]].concat());
    assert_eq!(made.code, 0, "{}", made.stderr);
    let fit = std::fs::read_to_string(folder.path().join("fit.csv")).unwrap();
    let log = folder.path().join("log.csv");
    let write = |text: String| std::fs::write(&log, text).unwrap();
    let degree = 57.295_779_513;
    let degrees = scaled(&scaled(&fit, "actual_q", degree), "target_q", degree);
    for (spoilt, part) in [
        (scaled(&fit, "timestamp", 1000.0), "milliseconds"),
        (degrees, "read in degrees"),
        (scaled(&fit, "actual_current", 1000.0), "in mA"),
        (scaled(&fit, "actual_current", -1.0), "opposite sign at every joint"),
        (scaled(&fit, "actual_qd", -1.0), "goes the other way"),
        (scaled(&fit, "actual_current_1", -1.0), "joint 2: the recorded torque has the opposite"),
        (
            fit.replacen("actual_q_0", "x", 1).replacen("actual_q_2", "actual_q_0", 1).replacen(
                ",x,",
                ",actual_q_2,",
                1,
            ),
            "another order",
        ),
    ] {
        write(spoilt);
        stopped(&log, &[], &["log.csv", part, "--force"]);
        let seen = armtwin(&["inspect", text(&log)]);
        let flat = seen.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(seen.code == 0 && flat.contains(part), "{part}: {}", seen.stdout);
    }
    write(scaled(&fit, "actual_current", -1.0));
    let cases = folder.path().join("cases");
    let twin = "scenarios/twins/ur5.toml";
    let drawn = ["trial", "draw", "--on", text(&log), "--twin", twin, "--out", text(&cases)];
    let refused = armtwin(&drawn);
    assert_eq!(refused.code, 1, "{}", refused.stdout);
    assert!(refused.stderr.contains("opposite sign") && refused.stderr.contains("--force"));
    assert!(!cases.exists());
    let forced = armtwin(&["identify", text(&log), "--method", "nlse", "--force"]);
    assert_eq!(forced.code, 0, "{}", forced.stderr);
    assert!(forced.stderr.contains("warning: ") && forced.stderr.contains("opposite sign"));
    write(fit);
    let good = armtwin(&["identify", text(&log), "--method", "nlse"]);
    assert_eq!((good.code, good.stderr.as_str()), (0, ""));
    let assumed = "arm: ur5 (assumed; --robot NAME or --twin FILE says otherwise)\n";
    assert!(good.stdout.starts_with(assumed), "{}", good.stdout);
}

#[test]
fn a_stretch_is_read_and_fast_recordings_are_thinned() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    std::fs::write(path("log.csv"), csv(6, "joint_torque")).unwrap();
    let cut = ["convert", &path("log.csv"), "--from", "2", "--to", "6s", "-o", &path("cut.csv")];
    let cut = armtwin(&cut);
    assert!(cut.code == 0 && cut.stdout.contains("501 samples"), "{}{}", cut.stdout, cut.stderr);
    assert!(cut.stderr.contains("501 of 2000 rows"), "{}", cut.stderr);
    let seen = armtwin(&["inspect", &path("log.csv"), "--from", "10"]);
    assert!(seen.stdout.contains("750 samples"), "{}", seen.stdout);
    for wrong in [&["--from", "100"][..], &["--from", "3", "--to", "2"]] {
        let none = armtwin(&[&["inspect", &path("log.csv")], wrong].concat());
        assert!(none.code == 1 && none.stderr.contains("--from"), "{}", none.stderr);
    }
    assert_eq!(armtwin(&["inspect", &path("log.csv"), "--from", "soon"]).code, 2);

    // Eight times as fast: the same rows, eight times nearer.
    let fast = scaled(&csv(6, "joint_torque"), "timestamp", 0.125);
    std::fs::write(path("fast.csv"), scaled(&fast, "actual_qd", 8.0)).unwrap();
    let force = ["--force", "--margin", "0.1"];
    let fast = path("fast.csv");
    let contacts = [&["contacts", fast.as_str()], &force[..]].concat();
    let thinned = armtwin(&contacts);
    assert!(
        thinned.stderr.contains("2000 rows at 1000 Hz are thinned to 250 at 125 Hz"),
        "{}",
        thinned.stderr
    );
    let kept = armtwin(&[&contacts[..], &["--every-row"]].concat());
    assert!(!kept.stderr.contains("thinned"), "{}", kept.stderr);
}

#[test]
fn a_drafted_map_reads_a_log_that_nobody_described() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let degree = 57.295_779_513;
    let spoilt = scaled(&scaled(&csv(6, "motor current"), "actual_q_", degree), "timestamp", 1e3);
    std::fs::write(path("log.txt"), spoilt.replace("timestamp", "clock").replace(',', "\t"))
        .unwrap();
    let shown = armtwin(&["map", &path("log.txt")]);
    assert_eq!((shown.code, shown.stderr.as_str()), (0, ""));
    for part in ["time_scale = 1e-3", "degrees: up to 29", "actual_qd = ", "actual_current = "] {
        assert!(shown.stdout.contains(part), "{part} not in\n{}", shown.stdout);
    }
    let made = armtwin(&["map", &path("log.txt"), "-o", &path("map.toml")]);
    assert!(made.stdout.contains("6 joints"), "{}{}", made.stdout, made.stderr);
    assert_eq!(std::fs::read_to_string(path("map.toml")).unwrap(), shown.stdout);
    let read = armtwin(&["inspect", &path("log.txt"), "--columns", &path("map.toml")]);
    assert!(read.stdout.contains("2000 samples, 15.992 s"), "{}{}", read.stdout, read.stderr);
    let none = armtwin(&["map", "Cargo.toml"]);
    assert!(none.code == 1 && none.stderr.contains("Cargo.toml"), "{}", none.stderr);
}

#[test]
fn a_drafted_twin_is_the_arm_whose_weight_is_carried() {
    let folder = simulated("ur10e", "12");
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let fit = std::fs::read_to_string(path("fit.csv")).unwrap();
    let torque = scaled(&fit, "actual_current", 10.1).replace("actual_current", "tau");
    std::fs::write(path("log.csv"), torque.replace("target_moment", "asked")).unwrap();
    let (map, twin) = (path("map.toml"), path("arm.toml"));
    let made = armtwin(&["map", &path("log.csv"), "-o", &map, "--save-twin", &twin]);
    assert!(made.code == 0 && made.stdout.contains("a ur10"), "{}{}", made.stdout, made.stderr);
    let seen = ["inspect", &path("log.csv"), "--columns", &map, "--twin", &twin];
    let seen = armtwin(&seen);
    assert!(seen.code == 0 && seen.stdout.starts_with("arm: ur10"), "{}", seen.stdout);
}

#[test]
fn rows_without_a_number_are_left_out_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let good = csv(6, "joint_torque");
    let mut lines: Vec<String> = good.lines().map(String::from).collect();
    lines[20] = lines[20].replacen(',', ",nan,", 1).rsplit_once(',').unwrap().0.to_string();
    lines[30] = lines[29].clone();
    lines.insert(3, "# a remark".into());
    std::fs::write(&log, lines.join("\n") + "\n").unwrap();
    let seen = armtwin(&["inspect", text(&log)]);
    assert_eq!(seen.code, 0, "{}", seen.stderr);
    let flat = seen.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in
        ["1998 samples", "dropped 1 row(s), line 22", "the row before, the first in line 32"]
    {
        assert!(flat.contains(part), "{part} not in\n{}", seen.stdout);
    }
}
