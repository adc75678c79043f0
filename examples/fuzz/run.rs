//! Runs a target until its limit, alone or in a process of its own.

use std::collections::HashSet;
use std::fs::File;
use std::io::{Seek, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

use crate::bytes::Random;
use crate::targets::{Corpus, Target};
use crate::{kept, memory};

/// What an input may take: processor time where it takes longer on the clock.
const LONGEST: Duration = Duration::from_secs(1);
/// After so long nobody waits any more.
const HOPELESS_S: u64 = 60;
const MOST_MEMORY: usize = 512 << 20;
/// Inputs that are kept because they were answered in a new way.
const MOST_KEPT: usize = 4_000;
/// Findings after which a target is given up.
const ENOUGH: usize = 20;

pub struct Limit {
    pub executions: u64,
    pub seconds: f64,
}

#[derive(Default, serde::Serialize, serde::Deserialize)]
pub struct Result {
    pub target: String,
    pub seed: u64,
    /// The version of armtwin.
    pub version: String,
    /// On which it ended, in UTC.
    pub day: String,
    pub executions: u64,
    pub clock_s: f64,
    /// The time of all threads; on the clock where that is not known.
    pub processor_s: f64,
    /// Inputs that were read without an error.
    pub read: u64,
    /// Different messages.
    pub answers: usize,
    pub slowest_ms: f64,
    pub peak_mb: f64,
    pub resident_mb: f64,
    pub findings: Vec<String>,
}

impl Result {
    pub fn is_sound(&self) -> bool {
        self.findings.is_empty()
    }

    pub fn line(&self) -> String {
        format!(
            "{:<14} {:>10} inputs {:>7.0} s, {:>4.1} % read, {:>5} answers, slowest {:>4.0} ms, {:>4.0} MB \
             asked, {:>4.0} MB resident, {} finding(s)",
            self.target,
            self.executions,
            self.processor_s,
            100.0 * self.read as f64 / self.executions.max(1) as f64,
            self.answers,
            self.slowest_ms,
            self.peak_mb,
            self.resident_mb,
            self.findings.len()
        )
    }
}

/// Runs this program for one target, and keeps the input that killed it.
pub fn in_a_process(target: &Target, limit: &Limit, seed: u64) -> Result {
    let scratch = scratch(std::process::id(), target.name);
    let mut command = Command::new(std::env::current_exe().expect("the path of this program"));
    command.args([target.name, "--alone", "--seed", &seed.to_string()]);
    command.env("FUZZ_SCRATCH", &scratch);
    if limit.executions < u64::MAX {
        command.args(["--executions", &limit.executions.to_string()]);
    }
    if limit.seconds.is_finite() {
        command.args(["--seconds", &limit.seconds.to_string()]);
    }
    let run = command.stdout(Stdio::piped()).output().expect("this program can be run");
    let mut result: Result = String::from_utf8_lossy(&run.stdout)
        .lines()
        .last()
        .and_then(|line| serde_json::from_str(line).ok())
        .unwrap_or_default();
    if !run.status.success() {
        (result.target, result.seed) = (target.name.into(), seed);
        (result.version, result.day) = (env!("CARGO_PKG_VERSION").into(), kept::today());
        let why = String::from_utf8_lossy(&run.stderr);
        let why = why.lines().last().unwrap_or_default();
        let kept = keep(target, &scratch, "died");
        result.findings.push(format!("died ({}, {why}): {}", run.status, kept.display()));
    }
    let _ = std::fs::remove_dir_all(&scratch);
    println!("{}", result.line());
    result.findings.iter().for_each(|f| println!("  {f}"));
    result
}

fn scratch(process: u32, target: &str) -> PathBuf {
    let memory = Path::new("/dev/shm");
    let parent = if memory.is_dir() { memory.to_path_buf() } else { std::env::temp_dir() };
    parent.join(format!("armtwin-fuzz-{process}-{target}"))
}

/// Copies the input that was last written.
fn keep(target: &Target, scratch: &Path, why: &str) -> PathBuf {
    let folder = Path::new("target/fuzz-findings");
    let _ = std::fs::create_dir_all(folder);
    let number = std::fs::read_dir(folder).map_or(0, Iterator::count);
    let to = folder.join(format!("{}-{why}-{number}", target.name));
    let _ = std::fs::copy(scratch.join(INPUT), &to);
    to
}

/// The raw input is kept beside the files it is made into.
const INPUT: &str = "input";

pub fn once(target: &Target, file: &Path) -> ExitCode {
    let scratch = scratch(std::process::id(), target.name);
    std::fs::create_dir_all(&scratch).expect("a scratch folder");
    let bytes = std::fs::read(file).expect("a readable input");
    let (before, start) = (memory::reset(), Instant::now());
    let answer = (target.read)(&scratch, &bytes);
    let asked = memory::peak() - before;
    println!("{answer:?}\n{:?}, {} MB asked for", start.elapsed(), asked >> 20);
    let _ = std::fs::remove_dir_all(&scratch);
    ExitCode::SUCCESS
}

pub fn alone(target: &Target, limit: &Limit, seed: u64) {
    let scratch = std::env::var_os("FUZZ_SCRATCH").map(PathBuf::from);
    let scratch = scratch.unwrap_or_else(|| self::scratch(std::process::id(), target.name));
    std::fs::create_dir_all(&scratch).expect("a scratch folder");
    let mut beside = Beside::new(&scratch);
    on_this_thread();
    watch();
    let mut corpus = Corpus::new((target.seeds)());
    std::panic::set_hook(Box::new(|_| {}));
    let mut random = Random(seed ^ 0x5eed);
    let mut result = Result { target: target.name.into(), seed, ..Result::default() };
    result.version = env!("CARGO_PKG_VERSION").into();
    let (start, mut answers) = (Instant::now(), HashSet::new());
    let mut slowest = Duration::ZERO;
    while result.executions < limit.executions
        && start.elapsed().as_secs_f64() < limit.seconds
        && result.findings.len() < ENOUGH
    {
        BEGUN.store(seconds_since_start(), Relaxed);
        // Seeds first, as they are.
        let input = match corpus.seeds.get(result.executions as usize) {
            Some(seed) => seed.clone(),
            None => (target.make)(&mut random, &corpus),
        };
        beside.write(&input);
        let before = memory::reset();
        let begun = Instant::now();
        let answer = catch_unwind(AssertUnwindSafe(|| (target.read)(&scratch, &input)));
        BEGUN.store(u64::MAX, Relaxed);
        let (mut took, asked) = (begun.elapsed(), memory::peak() - before);
        if took > slowest {
            // Others may have had the machine.
            took = took.min(again(target, &scratch, &input));
            slowest = slowest.max(took);
        }
        result.executions += 1;
        result.peak_mb = result.peak_mb.max(asked as f64 / f64::from(1 << 20));
        let broken = match &answer {
            Err(panic) => Some(("panic", said(panic.as_ref()))),
            Ok(_) if took > LONGEST => Some(("slow", format!("{took:?}"))),
            Ok(_) if asked > MOST_MEMORY => Some(("memory", format!("{} MB", asked >> 20))),
            Ok(_) => None,
        };
        if let Some((why, how)) = broken {
            let kept = keep(target, &scratch, why);
            result.findings.push(format!("{why} ({how}): {}", kept.display()));
        }
        let answer = answer.unwrap_or_else(|_| Err("panic".into()));
        result.read += u64::from(answer.is_ok());
        let shape = answer.unwrap_or_else(|e| shape(&e));
        if answers.len() < MOST_KEPT && answers.insert(shape) {
            corpus.kept.push(input);
        }
    }
    result.day = kept::today();
    result.clock_s = start.elapsed().as_secs_f64();
    result.processor_s = memory::processor_s().unwrap_or(result.clock_s);
    result.slowest_ms = slowest.as_secs_f64() * 1e3;
    result.answers = answers.len();
    result.resident_mb = memory::resident_peak();
    println!("{}", serde_json::to_string(&result).expect("plain numbers"));
}

/// Lets readers work on this thread alone: inputs are small, and to hand them to others took longer than to
/// read them.
fn on_this_thread() {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    alone.build_global().expect("nothing has worked in parallel before");
}

/// What one more time takes on the clock; where that is too long, and where it is known, of processors, as
/// they are counted in hundredths of a second alone.
fn again(target: &Target, scratch: &Path, input: &[u8]) -> Duration {
    let (start, before) = (Instant::now(), memory::processor_s());
    let _ = catch_unwind(AssertUnwindSafe(|| (target.read)(scratch, input)));
    let took = start.elapsed();
    let used = memory::processor_s().zip(before).map(|(after, before)| after - before);
    if took > LONGEST { used.map_or(took, Duration::from_secs_f64) } else { took }
}

/// A file that holds the input of the moment; it stays open, as it is written millions of times.
struct Beside(File);

impl Beside {
    fn new(scratch: &Path) -> Self {
        Self(File::create(scratch.join(INPUT)).expect("a file in the scratch folder"))
    }

    fn write(&mut self, input: &[u8]) {
        let written = self.0.rewind().and_then(|()| self.0.write_all(input));
        let cut = written.and_then(|()| self.0.set_len(input.len() as u64));
        cut.expect("room in the scratch folder");
    }
}

fn said(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    text.or_else(|| panic.downcast_ref::<&str>().map(|t| (*t).into())).unwrap_or_default()
}

/// A message without what it quotes, so that like ones are one.
fn shape(message: &str) -> String {
    let mut shape = String::new();
    let mut quoted = false;
    for c in message.chars() {
        match c {
            '"' | '`' => quoted = !quoted,
            _ if quoted || c.is_ascii_digit() => {}
            _ => shape.push(c),
        }
    }
    shape.chars().take(120).collect()
}

/// When the input was begun, s since the start; none at the moment.
static BEGUN: AtomicU64 = AtomicU64::new(u64::MAX);

fn seconds_since_start() -> u64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs()
}

/// Ends the process if an input takes for ever.
fn watch() {
    seconds_since_start();
    std::thread::spawn(|| {
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let begun = BEGUN.load(Relaxed);
            if begun != u64::MAX && seconds_since_start() > begun + HOPELESS_S {
                eprintln!("an input takes longer than {HOPELESS_S} s");
                std::process::exit(3);
            }
        }
    });
}
