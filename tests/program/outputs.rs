//! What is written where: never over an input or somebody's file, never half, never before the answer.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use super::{Output, armtwin};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const MINE: &str = "# mine\n";

/// A folder with a recording of 16 s, a twin, a URDF and a scenario.
struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        let desk = Self(TempDir::new().unwrap());
        let scenario = format!("{ROOT}/scenarios/ur5_friction.toml");
        let short = ["--duration", "16", "--out", &desk.at("made")];
        assert_eq!(armtwin(&[&["simulate", &scenario], &short[..]].concat()).code, 0);
        fs::copy(desk.at("made/fit.csv"), desk.at("a.csv")).unwrap();
        fs::copy(desk.at("made/check.csv"), desk.at("b.csv")).unwrap();
        let twins = format!("{ROOT}/scenarios/twins/ur5.toml");
        fs::copy(twins, desk.at("twin.toml")).unwrap();
        assert_eq!(armtwin(&["urdf", "-o", &desk.at("made/arm.urdf")]).code, 0);
        fs::copy(desk.at("made/arm.urdf"), desk.at("arm.urdf")).unwrap();
        fs::copy(scenario, desk.at("scenario.toml")).unwrap();
        fs::write(desk.at("mine.txt"), MINE).unwrap();
        desk
    }

    fn at(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().into()
    }

    /// In the folder, as somebody types it.
    fn run(&self, line: &str) -> Output {
        let program = Command::new(env!("CARGO_BIN_EXE_armtwin"))
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .output()
            .unwrap();
        output(program)
    }

    /// Through a shell, which knows the program as `armtwin`.
    fn shell(&self, line: &str) -> Output {
        let program = Command::new("bash")
            .args([
                "-c",
                &format!("armtwin() {{ {} \"$@\"; }}; {line}", env!("CARGO_BIN_EXE_armtwin")),
            ])
            .current_dir(self.0.path())
            .output()
            .unwrap();
        output(program)
    }

    #[track_caller]
    fn done(&self, line: &str) -> String {
        let run = self.run(line);
        assert_eq!(run.code, 0, "{line}: {}", run.stderr);
        run.stdout
    }

    /// With one message that names `file`, before any work, and all files as they were.
    #[track_caller]
    fn refused(&self, line: &str, file: &str, why: &str) {
        let before = files(self.0.path());
        let run = self.run(line);
        assert_eq!((run.code, run.stdout.as_str()), (1, ""), "{line}: {}", run.stderr);
        assert!(run.stderr.contains(file) && run.stderr.contains(why), "{line}: {}", run.stderr);
        let errors = run.stderr.lines().filter(|l| !l.starts_with("note: "));
        assert_eq!(errors.count(), 1, "{line}: {}", run.stderr);
        assert!(files(self.0.path()) == before, "{line} changed something");
    }
}

fn output(program: std::process::Output) -> Output {
    let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
    let code = program.status.code().unwrap_or(-1);
    Output { code, stdout: text(&program.stdout), stderr: text(&program.stderr) }
}

/// Names and bytes of all files below a folder, in order.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(files(&path)),
            false => found.push((path.display().to_string(), fs::read(&path).unwrap_or_default())),
        }
    }
    found.sort();
    found
}

const READ: &str = "this command reads it";
const FOREIGN: &str = "--overwrite";

#[test]
fn no_flag_of_any_command_writes_over_an_input() {
    let desk = Desk::new();
    let exported = "export --twin twin.toml --format urdf";
    let mut lines = vec![
        ("inspect a.csv --json a.csv", "a.csv"),
        ("convert a.csv -o a.csv", "a.csv"),
        ("convert a.csv -o c.csv --json ./a.csv", "a.csv"),
        ("identify a.csv --save-twin a.csv", "a.csv"),
        ("identify a.csv --check b.csv --report b.csv", "b.csv"),
        ("identify a.csv --with inertia --save-urdf a.csv", "a.csv"),
        ("identify a.csv --twin twin.toml --save-twin twin.toml", "twin.toml"),
        ("contacts a.csv --json a.csv", "a.csv"),
        ("motor scenario.toml --markdown scenario.toml", "scenario.toml"),
        ("simulate scenario.toml --out s --json scenario.toml", "scenario.toml"),
        ("recovery scenario.toml -o scenario.toml", "scenario.toml"),
        ("detect scenario.toml --json scenario.toml", "scenario.toml"),
        ("study scenario.toml --out s --json scenario.toml", "scenario.toml"),
        ("excite --twin twin.toml -o twin.toml", "twin.toml"),
        ("urdf --robot arm.urdf -o arm.urdf", "arm.urdf"),
        ("diagnose --fit a.csv --check b.csv --json b.csv", "b.csv"),
        ("diagnose --fit a.csv --twin twin.toml --out .", "twin.toml"),
        ("trial draw --on a.csv b.csv --twin twin.toml --out t --json twin.toml", "twin.toml"),
    ];
    let over = [" -o twin.toml", " --json twin.toml"].map(|more| format!("{exported}{more}"));
    lines.extend(over.iter().map(|line| (line.as_str(), "twin.toml")));
    #[cfg(feature = "viewer")]
    lines.push(("compare a.csv -o a.csv", "a.csv"));
    for (line, file) in lines {
        desk.refused(line, file, READ);
        desk.refused(&format!("{line} --overwrite"), file, READ);
    }
}

#[test]
fn no_flag_of_any_command_writes_over_somebodys_file() {
    let desk = Desk::new();
    for name in ["fit.csv", "armtwin.1", "case-studies.md", "summary.md"] {
        fs::write(desk.at(name), MINE).unwrap();
    }
    for (line, file) in [
        ("accuracy -o mine.txt", "mine.txt"),
        ("case-studies --out . --no-motor", "case-studies.md"),
        ("case-studies --out s --rrd mine.txt", "mine.txt"),
        ("contacts a.csv --json mine.txt", "mine.txt"),
        ("convert a.csv -o fit.csv", "fit.csv"),
        ("demo --out .", "fit.csv"),
        ("demo --out s --json mine.txt", "mine.txt"),
        ("detect scenario.toml -o mine.txt", "mine.txt"),
        ("diagnose --fit a.csv --out .", "twin.toml"),
        ("effects --json mine.txt", "mine.txt"),
        ("excite -o s.csv --json mine.txt", "mine.txt"),
        ("export --twin twin.toml --format mjcf -o mine.txt", "mine.txt"),
        ("identify a.csv --save-twin mine.txt", "mine.txt"),
        ("identify a.csv --report mine.txt", "mine.txt"),
        ("inspect a.csv --json mine.txt", "mine.txt"),
        ("man --out .", "armtwin.1"),
        ("motor --json mine.txt", "mine.txt"),
        ("recovery -o mine.txt", "mine.txt"),
        ("robots --json mine.txt", "mine.txt"),
        ("simulate scenario.toml --out .", "fit.csv"),
        ("study scenario.toml --out s --json mine.txt", "mine.txt"),
        ("study report . ", "summary.md"),
        ("trial score a b --out mine.txt", "mine.txt"),
        ("trial criteria s --out s --page mine.txt", "mine.txt"),
        ("trial answer s --out s --json mine.txt", "mine.txt"),
        ("urdf -o mine.txt", "mine.txt"),
    ] {
        if line.contains("--rrd") && cfg!(not(feature = "viewer")) {
            continue;
        }
        if !line.starts_with("study report") {
            desk.refused(line, file, FOREIGN);
        }
    }
    let run = desk.run("inspect a.csv --json mine.txt --overwrite");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(fs::read_to_string(desk.at("mine.txt")).unwrap().contains("armtwin.inspection/1"));
}

#[test]
fn what_armtwin_wrote_is_replaced_until_somebody_changes_it() {
    let desk = Desk::new();
    for line in [
        "convert a.csv -o c.csv --json c.json",
        "simulate scenario.toml --out s --duration 4",
        "identify a.csv --method nlse --save-twin fitted.toml --report r.html",
        "export --twin twin.toml --format mjcf -o arm.xml",
        "man --out man",
    ] {
        desk.done(line);
        desk.done(line);
    }
    // Wherever the folder goes.
    fs::rename(desk.at("s"), desk.at("moved")).unwrap();
    desk.done("simulate scenario.toml --out moved --duration 4 --seed 2");
    // Under another name it is somebody's copy.
    fs::copy(desk.at("fitted.toml"), desk.at("best.toml")).unwrap();
    desk.refused("identify b.csv --save-twin best.toml", "best.toml", FOREIGN);
    let text = fs::read_to_string(desk.at("fitted.toml")).unwrap();
    fs::write(desk.at("fitted.toml"), format!("# tuned by hand\n{text}")).unwrap();
    desk.refused("identify b.csv --save-twin fitted.toml", "fitted.toml", FOREIGN);
    desk.done("identify b.csv --method nlse --save-twin fitted.toml --overwrite");
    desk.done("identify b.csv --method nlse --save-twin fitted.toml");
    // Whoever makes an empty file for the result loses nothing.
    fs::write(desk.at("empty"), "").unwrap();
    desk.done("urdf -o empty");
}

#[cfg(unix)]
#[test]
fn links_are_followed_to_what_they_name() {
    use std::os::unix::fs::symlink;

    let desk = Desk::new();
    symlink("a.csv", desk.at("link.csv")).unwrap();
    symlink("mine.txt", desk.at("link.txt")).unwrap();
    fs::hard_link(desk.at("a.csv"), desk.at("hard.csv")).unwrap();
    desk.refused("convert a.csv -o link.csv --overwrite", "link.csv", READ);
    desk.refused("convert link.csv -o made/../a.csv", "a.csv", READ);
    desk.refused("convert a.csv -o hard.csv", "hard.csv", READ);
    desk.refused("urdf -o link.txt", "link.txt", FOREIGN);
    symlink("made/new.urdf", desk.at("new.urdf")).unwrap();
    desk.done("urdf -o new.urdf");
    desk.done("urdf -o new.urdf");
    assert!(fs::symlink_metadata(desk.at("new.urdf")).unwrap().is_symlink());
    assert!(fs::read_to_string(desk.at("made/new.urdf")).unwrap().contains("<robot"));
}

/// What a twin or a folder names is read as well, also where armtwin made it.
#[test]
fn inputs_of_inputs_are_inputs() {
    let desk = Desk::new();
    let drive = "[drive]\ngear_ratio = 100\ntorque_constant = 0.1\n";
    fs::write(desk.at("own.toml"), format!("robot = \"made/arm.urdf\"\n{drive}")).unwrap();
    let export = "export --twin own.toml --format urdf -o made/arm.urdf";
    desk.refused(export, "made/arm.urdf", READ);
    desk.done("convert a.csv -o made/run.mcap");
    desk.refused("convert made -o made/run.mcap", "made/run.mcap", READ);
}

#[test]
fn two_outputs_are_two_files() {
    let desk = Desk::new();
    desk.refused("convert a.csv -o c.csv --json ./c.csv", "c.csv", "two outputs");
    desk.refused("urdf -o - --json", "standard output", "two outputs");
    desk.refused("urdf -o no/such/arm.urdf", "arm.urdf", "there is no folder no/such");
    desk.refused("urdf -o made", "made", "is a folder");
    desk.refused("simulate scenario.toml --out a.csv", "a.csv", "is a file");
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_written_as_they_are() {
    let desk = Desk::new();
    desk.done("convert a.csv -o c.csv");
    let csv = fs::read_to_string(desk.at("c.csv")).unwrap();
    let urdf = fs::read_to_string(desk.at("arm.urdf")).unwrap();
    assert_eq!(desk.done("convert a.csv -o -"), csv);
    assert_eq!(desk.done("urdf -o /dev/stdout"), urdf);
    assert_eq!(desk.done("urdf -o /dev/null"), "");
    for line in [
        "armtwin urdf -o /dev/stdout | cat",
        "armtwin urdf -o - > u; cat u",
        "armtwin urdf -o /dev/stderr 2> u; cat u",
        "armtwin urdf -o >(cat > u); wait $!; cat u",
        "mkfifo p; armtwin urdf -o p & cat p; rm p",
    ] {
        let run = desk.shell(line);
        assert_eq!((run.code, &run.stdout), (0, &urdf), "{line}: {}", run.stderr);
    }
    let head = desk.shell("set -o pipefail; armtwin convert a.csv -o - | head -1");
    assert!(head.stdout.starts_with("timestamp"), "{} {}", head.stdout, head.stderr);
    assert_eq!((head.code, head.stderr.as_str()), (0, ""));
    let packed = desk.shell("armtwin convert a.csv -o /dev/stdout | armtwin inspect /dev/stdin");
    assert!(packed.stdout.contains("samples") || packed.code == 1, "{}", packed.stderr);
}

/// The answer is there, one message names the file, and nothing is left of it.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_costs_the_file_and_not_the_answer() {
    let desk = Desk::new();
    let quick = "--twin twin.toml --no-simulation";
    for (line, answer) in [
        ("inspect a.csv --json /dev/full", "What is wrong with it"),
        ("urdf --json /dev/full", "</robot>"),
        ("contacts a.csv --twin twin.toml --json /dev/full", "ontact"),
        ("identify a.csv --method nlse --json /dev/full", "nlse"),
        ("robots --json /dev/full", "ur10e"),
        (&format!("diagnose --fit a.csv {quick} --json /dev/full"), "What stays"),
    ] {
        let run = desk.run(line);
        assert_eq!(run.code, 1, "{line}: {}", run.stderr);
        assert!(run.stdout.contains(answer), "{line}: {}", run.stdout);
        assert!(run.stderr.contains("cannot write /dev/full"), "{line}: {}", run.stderr);
    }
    // The limit stands in for a disk that is full in the middle of a file.
    for (line, answer, file) in [
        (format!("diagnose --fit a.csv {quick} --out d"), "What stays", "d/diagnosis.json"),
        ("demo --duration 12 --out e".into(), "What stays", "e/fit.csv"),
        ("identify a.csv --method nlse --save-twin t.toml --json i.json".into(), "nlse", "i.json"),
        ("convert a.csv -o c.csv".into(), "", "c.csv"),
        ("convert a.csv -o c.csv.gz".into(), "", "c.csv.gz"),
        ("convert a.csv -o c.parquet".into(), "", "c.parquet"),
        ("convert a.csv -o c.mcap".into(), "", "c.mcap"),
        ("convert a.csv -o c.db3".into(), "", "c.db3"),
    ] {
        let run = desk.shell(&format!("ulimit -f 2; armtwin {line}"));
        assert_eq!(run.code, 1, "{line}: {}", run.stderr);
        assert!(run.stdout.contains(answer), "{line}: {}", run.stdout);
        let said = run.stderr.contains(file) && run.stderr.lines().count() == 1;
        assert!(said && run.stderr.contains("writ"), "{line}: {}", run.stderr);
        let left = files(desk.0.path()).into_iter().map(|(name, _)| name);
        let is_left = |name: &String| *name == format!("/{file}") || name.contains("/.tmp");
        let left: Vec<_> =
            left.map(|name| name.replace(&desk.at(""), "/")).filter(is_left).collect();
        assert!(left.is_empty(), "{line} left {left:?}");
    }
}

/// Does this process ignore a signal? A shell's background jobs ignore SIGINT, and children inherit that.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok())
        .is_some_and(|m| m >> (signal - 1) & 1 == 1)
}

/// Stopped in the middle of a file, as the temporary one shows; asked until that has come about.
#[cfg(unix)]
#[test]
fn an_interrupted_conversion_leaves_nothing_behind() {
    let folder = TempDir::new().unwrap();
    let [log, out] = ["log.csv", "out"].map(|name| folder.path().join(name));
    let row = |k: usize| format!("{},{}\n", k as f64 * 0.008, (k as f64).sin());
    let rows: String = (0..200_000).map(row).collect();
    fs::write(&log, format!("timestamp,actual_q_0\n{rows}")).unwrap();
    fs::create_dir(&out).unwrap();
    let is_empty = || fs::read_dir(&out).unwrap().next().is_none();
    for (signal, number) in [("-INT", 2), ("-TERM", 15)] {
        if is_ignored(number) {
            eprintln!(
                "skipped: whoever runs the tests ignores {signal}, and so does all they start"
            );
            continue;
        }
        let ended_by = |signal: &str| {
            let mut run = Command::new(env!("CARGO_BIN_EXE_armtwin"))
                .arg("convert")
                .arg(&log)
                .args(["-o", out.join("packed.csv.gz").to_str().unwrap(), "--overwrite"])
                .stdout(Stdio::null())
                .spawn()
                .unwrap();
            while is_empty() && run.try_wait().unwrap().is_none() {
                std::thread::yield_now();
            }
            let id = run.id().to_string();
            Command::new("kill").args([signal, &id]).stderr(Stdio::null()).status().unwrap();
            std::os::unix::process::ExitStatusExt::signal(&run.wait().unwrap())
        };
        let caught = (0..50).any(|_| {
            let by = ended_by(signal);
            if by.is_none() {
                fs::remove_dir_all(&out).unwrap();
                fs::create_dir(&out).unwrap();
            }
            by == Some(number)
        });
        assert!(caught, "{signal} never came in the middle");
        assert!(is_empty(), "{signal} left {:?}", files(&out));
    }
}
